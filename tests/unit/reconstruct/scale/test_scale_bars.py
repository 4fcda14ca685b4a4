"""Scale bars against cameras, a scale, pixels and lengths that are drawn anew each time."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import labcal
from labcal import Camera, InputError, NamedPixels, NamedReconstruction, Rig, examples, pipeline
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.rig_covariance import RigCovariance
from labcal.errors import UnknownNameError
from labcal.pipeline import MeasureSettings
from labcal.reconstruct.scale.scale_bar import ScaleBar

NOISE_PX, SCALE, LENGTH_MM = 0.03, 4e-4, 0.01
SIGMA = np.array([*[0.1] * 4, 1e-3, 2e-3] * 2 + [5e-5] * 3 + [0.02] * 3)  # px, 1, rad, mm
NAMES = ("a", "b", "c", "d")
TRUE = np.array([[-90, -20, 620], [80, 30, 580], [20, -60, 600], [-30, 50, 640]], dtype=np.float64)
MOVED = TRUE + np.array([15.0, -10.0, 30.0])
DRAWS = 32
BARS = (("a", "b"), ("c", "d"))


def cameras(scale: float = 0.0) -> tuple[Camera, ...]:
    """Return two cameras; all lengths that they measure are longer by a share."""
    K = [[900.0, 0.0, 320.0], [0.0, 905.0, 240.0], [0.0, 0.0, 1.0]]
    turned = np.eye(4)
    turned[:3, :3] = [[np.cos(0.3), 0, np.sin(0.3)], [0, 1, 0], [-np.sin(0.3), 0, np.cos(0.3)]]
    turned[:3, 3] = (1.0 + scale) * np.array([-180.0, 3.0, 25.0])
    return tuple(Camera(K, "brown-k1k2", [-0.1, 0.05, 0, 0, 0], T, (640, 480)) for T in (np.eye(4), turned))


def covariance() -> np.ndarray:
    n = len(SIGMA)
    mix = np.eye(n) + 0.2 * np.random.default_rng(1).standard_normal((n, n))
    return np.outer(SIGMA, SIGMA) * (mix @ mix.T)


def rig(step: np.ndarray | None = None, scale: float = 0.0) -> Rig:
    found = cameras(scale)
    if step is not None:
        state = RigState(found, np.eye(4)[None], np.zeros((1, 3)))
        layout = Layout(state, Freedom(Lenses.FREE, np.zeros((3, 0))))
        found = layout.stepped(step, np.zeros((1, 6))).cameras
    plain = Rig.of(dict(zip(("left", "right"), found, strict=True)))
    return plain.model_copy(update={"covariance": RigCovariance.of(plain.cameras, covariance())})


def pixels(rng: np.random.Generator | None = None) -> NamedPixels:
    """Return pixels of the points in two views."""
    columns: list[tuple[str, str, str]] = []
    q = []
    for view, places in (("first", TRUE), ("second", MOVED)):
        for name, camera in zip(("left", "right"), cameras(), strict=True):
            columns += [(view, name, point) for point in NAMES]
            q.append(camera.project(places).q)
    position = np.concatenate(q)
    if rng is not None:
        position = position + NOISE_PX * rng.standard_normal(position.shape)
    known = np.tile(NOISE_PX**2 * np.eye(2), (len(position), 1, 1))
    return NamedPixels(*map(list, zip(*columns, strict=True)), position, known)


def bars(rng: np.random.Generator | None = None) -> list[ScaleBar]:
    """Return bars with lengths that err as they state, alike in both views."""
    found = []
    for one, other in BARS:
        length = float(np.linalg.norm(TRUE[NAMES.index(one)] - TRUE[NAMES.index(other)]))
        off = 0.0 if rng is None else LENGTH_MM * float(rng.standard_normal())
        found.append(ScaleBar(one, other, length + off, LENGTH_MM))
    return found


def drawn(ppm: float | None, frame: str | None = None) -> Iterator[NamedReconstruction]:
    rng, root = np.random.default_rng(7 if frame is None else 11), np.linalg.cholesky(covariance())
    for _ in range(DRAWS):
        scale = float(rng.standard_normal()) * SCALE
        of = rig(root @ rng.standard_normal(len(root)), scale)
        view = None if frame is None else "first"
        settings = MeasureSettings(scale_bars=bars(rng), scale_sigma_ppm=ppm, frame=frame, frame_view=view)
        yield pipeline.measure(of, pixels(rng), settings=settings)


def agree(errors: np.ndarray, stated: np.ndarray) -> bool:
    """Tell whether errors, (draws, k), are as large as stated: a two-sided chi-square test at 0.1%."""
    square = float(np.einsum("di,ij,dj->", errors, np.linalg.inv(stated), errors))
    low, high = stats.chi2.ppf([5e-4, 0.9995], errors.size)
    return bool(low < square < high)


@pytest.mark.parametrize("ppm", [pytest.param(None, marks=pytest.mark.slow), 1e6 * SCALE])
def test_points_scatter_as_stated_after_the_bars(ppm: float | None) -> None:
    """Ends of bars and others, alone and together, with and without knowledge of the scale."""
    exact = pipeline.measure(
        rig(), pixels(), settings=MeasureSettings(scale_bars=bars(), scale_sigma_ppm=ppm)
    )
    true = np.concatenate([TRUE, MOVED])
    np.testing.assert_allclose(exact.points.point, true, atol=1e-6)
    found = list(drawn(ppm))
    errors = np.array([one.points.point - true for one in found])
    for row in range(len(true)):
        assert agree(errors[:, row], exact.points.covariance[row]), row
    free = [0, 1, 2, 3, 4, 6]  # with the other ends both lengths of a bar are one, and the joint is singular
    assert agree(errors[:, free].reshape(DRAWS, -1), exact.budget.errors(free).joint)
    for one, other in ((0, 1), (0, 2), (4, 6)):
        lengths = np.array([labcal.distance(of, one, other).value for of in found])
        length = labcal.distance(exact, one, other)
        assert agree((lengths - length.value)[:, None], np.array([[length.sigma**2]]))
        assert length.stated_sigma > 0.0
    freedom = exact.scale.freedom
    assert freedom == (4 if ppm else 3)
    low, high = stats.chi2.ppf([5e-4, 0.9995], freedom * DRAWS)
    assert low < sum(of.scale.chi_square for of in found) < high


def test_the_scale_is_found_however_far_off() -> None:
    """A rig that is too large, by 2,000 ppm or by a print that was fitted to the page."""
    for scale in (2e-3, -0.06):
        of, every = rig(scale=scale), pixels()
        plain = pipeline.measure(of, every)
        scaled = pipeline.measure(of, every, settings=MeasureSettings(scale_bars=bars()))
        true = np.linalg.norm(TRUE[0] - TRUE[2])
        assert labcal.distance(plain, 0, 2).value == pytest.approx((1 + scale) * true)
        np.testing.assert_allclose(scaled.points.point, np.concatenate([TRUE, MOVED]), atol=1e-5)
        assert scaled.scale.error_ppm == pytest.approx(1e6 * scale, abs=1.0)
        ends = labcal.distance(scaled, 0, 1)
        assert ends.sigma < 1.05 * LENGTH_MM < labcal.distance(plain, 0, 1).sigma


def test_a_length_that_is_hardly_known_changes_nothing() -> None:
    """In one view; in two views the same bar says that both lengths are one."""
    vague = [ScaleBar("a", "b", 10.0 + bars()[0].length_mm, 1e4)]
    of_view = pixels().where(pixels().view == "first")
    settings = MeasureSettings(scale_bars=vague, scale_sigma_ppm=0.0)
    plain, same = pipeline.measure(rig(), of_view), pipeline.measure(rig(), of_view, settings=settings)
    np.testing.assert_allclose(same.points.point, plain.points.point, atol=1e-5)
    np.testing.assert_allclose(same.points.covariance, plain.points.covariance, rtol=1e-6, atol=1e-12)
    both = pipeline.measure(rig(), pixels(), settings=settings)
    assert np.trace(both.points.covariance[0]) < np.trace(same.points.covariance[0])


def test_a_wrong_length_is_said() -> None:
    wrong = [bars()[0], ScaleBar("c", "d", bars()[1].length_mm + 0.5, LENGTH_MM)]
    found = pipeline.measure(rig(), pixels(), settings=MeasureSettings(scale_bars=wrong))
    assert any("4 measurements of scale bars lie" in warning for warning in found.warnings)
    right = pipeline.measure(rig(), pixels(), settings=MeasureSettings(scale_bars=bars()))
    assert right.warnings == ()
    one = pipeline.measure(rig(), pixels().where(pixels().view == "first"), settings=MeasureSettings(
        scale_bars=["a,b,190,0.01"]
    ))  # fmt: skip
    assert one.scale.sigma0 is None  # one bar gives the scale, and nothing is left to judge it by
    assert labcal.distance(one, "a", "b").value == pytest.approx(190.0)


def test_bars_that_are_none_are_refused() -> None:
    for words in ("a,b", "a,b,x,1", "a,a,1,1", "a,b,-1,1", "a,b,1,0", "a,b,nan,1", "a,b,1,inf", ",b,1,1"):
        with pytest.raises(InputError, match="scale bar"):
            MeasureSettings(scale_bars=[words])
    with pytest.raises(UnknownNameError, match="no point named 'aa'"):
        pipeline.measure(rig(), pixels(), settings=MeasureSettings(scale_bars=["aa,b,1,1"]))
    apart = pixels()
    apart = apart.where(~((apart.view == "first") & (apart.point == "a")))
    apart = apart.where(~((apart.view == "second") & (apart.point == "b")))
    with pytest.raises(InputError, match="No view has places for both ends"):
        pipeline.measure(rig(), apart, settings=MeasureSettings(scale_bars=["a,b,1,1"]))
    with pytest.raises(InputError, match="`scale_sigma_ppm` goes with scale bars"):
        MeasureSettings(scale_sigma_ppm=10.0)
    with pytest.raises(InputError, match="from 0 to"):
        MeasureSettings(scale_bars=["a,b,1,1"], scale_sigma_ppm=-1.0)
    with pytest.raises(InputError, match="a board's dots were measured without them"):
        MeasureSettings(scale_bars=["a,b,1,1"], frame="board:dots.csv")


@pytest.mark.parametrize("kind", ["points", "rigid", "similarity"])
def test_points_scatter_as_stated_in_a_frame_after_the_bars(kind: str, tmp_path: Path) -> None:
    """Of a frame by ends of bars and by another point: their errors move all points of the frame."""
    table = tmp_path / "known.csv"
    known = dict(zip(NAMES, TRUE, strict=True))
    lines = [f"{name},{','.join(map(repr, known[name].tolist()))},0.0" for name in "abc"]
    table.write_text("\n".join(["point,X_mm,Y_mm,Z_mm,sigma_mm", *lines]) + "\n")
    frame = "points:a,b,c" if kind == "points" else f"{kind}:{table}"
    settings = MeasureSettings(
        scale_bars=bars(), scale_sigma_ppm=1e6 * SCALE, frame=frame, frame_view="first"
    )
    exact = pipeline.measure(rig(), pixels(), settings=settings)
    between = labcal.distance(exact, 0, 1).value
    assert between == pytest.approx(float(np.linalg.norm(TRUE[0] - TRUE[1])))
    np.testing.assert_allclose(
        exact.points.covariance, exact.budget.noise + exact.budget.calibration, atol=1e-15
    )
    found = list(drawn(1e6 * SCALE, frame))
    errors = np.array([one.points.point - exact.points.point for one in found])
    for row in (3, 4, 5, 6, 7):
        assert agree(errors[:, row], exact.points.covariance[row]), row
    free = [3, 4, 6]
    assert agree(errors[:, free].reshape(DRAWS, -1), exact.budget.errors(free).joint)
    place = exact.points.covariance[:3]
    if kind == "points":  # the origin is exact by decree, and the point on the axis but for its x
        assert not errors[:, 0].any()
        assert not place[0].any()
        assert agree(errors[:, 1, :1], place[1, :1, :1])


def test_a_rig_without_covariance_is_scaled_too() -> None:
    found = pipeline.measure(
        examples.rig(), examples.pixels(), settings=MeasureSettings(scale_bars=["origin,tip,75.6,0.01"])
    )
    assert found.budget.kind.value == "noise"
    assert labcal.distance(found, "origin", "tip").value == pytest.approx(75.6)
