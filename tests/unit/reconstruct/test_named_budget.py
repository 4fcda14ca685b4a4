"""The full budget of named points, against cameras and pixels that are drawn anew each time."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import labcal
from labcal import Camera, InputError, NamedPixels, NamedReconstruction, Rig, examples, pipeline
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.rig_covariance import RigCovariance
from labcal.correspond.matching import match
from labcal.correspond.named_points_csv import named_points_csv
from labcal.errors import UnknownNameError
from labcal.estimators.affine import Affine
from labcal.estimators.model import Model, TrainingBox
from labcal.geometry.poses import look_at
from labcal.pipeline import MeasureSettings
from labcal.reconstruct.chosen_lines import line_of

NOISE_PX, SCATTER_PX = 0.04, 0.03
NAMES = ("left", "middle", "right")
EYES = ((-120.0, 0.0, 0.0), (0.0, 60.0, -40.0), (120.0, 0.0, 0.0))
SIGMA = np.array(
    [*[0.2] * 4, 1e-3, 2e-3] + [*[0.2] * 4, 1e-3, 2e-3, *[2e-4] * 3, *[0.05] * 3] * 2
)  # px, 1, rad, mm
POINTS = np.array(
    [
        [0, 0, 600], [90, 10, 590], [10, 70, 610], [-60, -50, 640], [50, -60, 560], [-80, 40, 620],
        [60, 60, 650],
    ],
    dtype=np.float64,
)  # fmt: skip
POINT_NAMES = ("o", "x", "xy", "a", "b", "c", "d")
UNSEEN = {("a", "left"), ("b", "middle"), ("c", "right")}
DRAWS = 24


def covariance() -> np.ndarray:
    n = len(SIGMA)
    mix = np.eye(n) + 0.2 * np.random.default_rng(1).standard_normal((n, n))
    return np.outer(SIGMA, SIGMA) * (mix @ mix.T)


def world_of_the_first(place: np.ndarray) -> np.ndarray:
    """Return places in the frame of the first camera, which is the world of a rig with a covariance."""
    T = look_at(np.array(EYES[0]), np.array([0, 0, 600.0]), np.array([0, -1.0, 0]))
    return place @ T[:3, :3].T + T[:3, 3]


def cameras() -> tuple[Camera, ...]:
    K = [[800.0, 0.0, 320.0], [0.0, 805.0, 240.0], [0.0, 0.0, 1.0]]
    T = [look_at(np.array(eye), np.array([0, 0, 600.0]), np.array([0, -1.0, 0])) for eye in EYES]
    return tuple(
        Camera(K, "brown-k1k2", [-0.1, 0.05, 0, 0, 0], T_cam @ np.linalg.inv(T[0]), (640, 480)) for T_cam in T
    )


TRUE = world_of_the_first(POINTS)
TRUTH = cameras()


def rig(step: np.ndarray | None = None) -> Rig:
    """Return the rig, with other parameters; the true one without."""
    state = RigState(TRUTH, np.eye(4)[None], np.zeros((1, 3)))
    layout = Layout(state, Freedom(Lenses.FREE, np.zeros((3, 0))))
    found = TRUTH if step is None else layout.stepped(step, np.zeros((1, 6))).cameras
    plain = Rig.of(dict(zip(NAMES, found, strict=True)))
    return plain.model_copy(
        update={
            "covariance": RigCovariance.of(plain.cameras, covariance()),
            "calibration": CalibrationRecord(scatter_px=SCATTER_PX),
        }
    )


def pixels(rng: np.random.Generator | None = None, places: np.ndarray = TRUE, view: str = "v") -> NamedPixels:
    """Return pixels of the points, with noise of their own and what the calibration left."""
    lines = [
        (camera, point, number)
        for camera in range(3)
        for number, point in enumerate(POINT_NAMES)
        if (point, NAMES[camera]) not in UNSEEN
    ]
    q = np.array([TRUTH[camera].project(places[number]).q for camera, _, number in lines])
    if rng is not None:
        q += np.hypot(NOISE_PX, SCATTER_PX) * rng.standard_normal(q.shape)
    of = [NAMES[camera] for camera, _, _ in lines]
    known = np.tile(NOISE_PX**2 * np.eye(2), (len(q), 1, 1))
    return NamedPixels([view] * len(q), of, [point for _, point, _ in lines], q, known)


def drawn(seed: int, frame: str | None = None) -> Iterator[NamedReconstruction]:
    """Yield measurements of the points with rigs that err as they state."""
    rng, root = np.random.default_rng(seed), np.linalg.cholesky(covariance())
    for _ in range(DRAWS):
        of = rig(root @ rng.standard_normal(len(root)))
        yield pipeline.measure(of, pixels(rng), settings=MeasureSettings(frame=frame))


def agree(errors: np.ndarray, stated: np.ndarray) -> bool:
    """Tell whether errors, (draws, k), are as large as stated: a two-sided chi-square test at 0.1%."""
    square = float(np.einsum("di,ij,dj->", errors, np.linalg.inv(stated), errors))
    low, high = stats.chi2.ppf([5e-4, 0.9995], errors.size)
    return bool(low < square < high)


def rows(found: NamedReconstruction) -> list[int]:
    """Return the line of each point, in the order of the names."""
    return [found.points.name.tolist().index(name) for name in POINT_NAMES]


def in_frame(found: NamedReconstruction, place: np.ndarray) -> np.ndarray:
    """Return the true places in the frame of the true points of a measurement without noise."""
    assert found.frame is not None
    return np.asarray(found.frame.scale * place @ found.frame.R_ba.T + found.frame.t_ba)


def test_points_of_any_cameras_scatter_as_stated() -> None:
    """Each point by itself, and all of them together, whichever cameras see them."""
    exact = pipeline.measure(rig(), pixels())
    order = rows(exact)
    errors = np.array([(found.points.point[order] - TRUE) for found in drawn(2)])
    for number, row in enumerate(order):
        assert agree(errors[:, number], exact.points.covariance[row]), POINT_NAMES[number]
    joint = exact.budget.errors(order).joint
    assert agree(errors.reshape(DRAWS, -1), joint)
    alone = pipeline.measure(rig(), pixels(), budget="noise")
    assert not agree(errors[:, 0], alone.points.covariance[order[0]])


def test_a_camera_that_does_not_see_a_point_does_not_move_it() -> None:
    """Parameters of the right camera do not appear in a point that the other two measured."""
    found = pipeline.measure(rig(), pixels())
    errors = found.budget.errors([found.points.name.tolist().index("c")])
    assert not errors.by_cameras[:, :, -12:].any()
    assert errors.by_cameras[:, :, :18].all()


@pytest.mark.parametrize("kind", ["points", "rigid", pytest.param("similarity", marks=pytest.mark.slow)])
def test_points_in_a_frame_scatter_as_stated(kind: str, tmp_path: Path) -> None:
    """The calibration moves a point and its frame alike, which the covariances in the frame know."""
    known = tmp_path / "known.csv"
    lines = [f"{name},{x},{y},{z},0" for name, (x, y, z) in zip(POINT_NAMES[:5], POINTS, strict=False)]
    known.write_text("\n".join(["point,X_mm,Y_mm,Z_mm,sigma_mm", *lines]) + "\n")
    frame = "points:o,x,xy" if kind == "points" else f"{kind}:{known}"
    exact = pipeline.measure(rig(), pixels(), settings=MeasureSettings(frame=frame))
    order, place = rows(exact), in_frame(exact, TRUE)
    measured = list(drawn(3, frame))
    errors = np.array([found.points.point[order] - place for found in measured])
    for number, free in ((1, [0]), (2, [0, 1])) if kind == "points" else ((1, [0, 1, 2]), (2, [0, 1, 2])):
        stated = exact.points.covariance[order[number]][np.ix_(free, free)]
        assert agree(errors[:, number][:, free], stated)
    for number in (3, 4, 5, 6):
        assert agree(errors[:, number], exact.points.covariance[order[number]])
    joint = exact.budget.errors(order[5:]).joint
    assert agree(errors[:, 5:].reshape(DRAWS, -1), joint)
    if kind != "points":  # residuals are judged by the joint covariance, too
        freedom = 15 - exact.frame.slopes.shape[1]
        low, high = stats.chi2.ppf([5e-4, 0.9995], freedom * DRAWS)
        assert low < freedom * sum(found.frame.sigma0**2 for found in measured) < high


def test_coordinates_by_decree_stay_exact_with_the_calibration() -> None:
    found = pipeline.measure(rig(), pixels(), settings=MeasureSettings(frame="points:o,x,xy"))
    order = rows(found)
    assert not found.points.covariance[order[0]].any()
    assert np.count_nonzero(found.points.covariance[order[1]]) == 1
    assert not found.points.covariance[order[2], 2].any()


def test_values_are_those_of_the_world_whatever_the_frame() -> None:
    """Distances, angles and their sigmas do not depend on where the frame lies."""
    world = pipeline.measure(rig(), pixels())
    frame = pipeline.measure(rig(), pixels(), settings=MeasureSettings(frame="points:o,x,xy"))
    for one, other in (("o", "x"), ("x", "d"), ("c", "d")):
        a, b = labcal.distance(world, one, other), labcal.distance(frame, one, other)
        for name in ("value", "sigma", "noise_sigma", "calibration_sigma", "stated_sigma"):
            assert getattr(a, name) == pytest.approx(getattr(b, name), rel=1e-6, abs=1e-12)
    a, b = labcal.angle(world, "a", "b", "xy"), labcal.angle(frame, "a", "b", "xy")
    assert (a.value, a.sigma) == pytest.approx((b.value, b.sigma), rel=1e-6)


def test_known_coordinates_have_a_share_of_their_own(tmp_path: Path) -> None:
    known = tmp_path / "known.csv"
    lines = [f"{name},{x},{y},{z},0.3" for name, (x, y, z) in zip(POINT_NAMES[:4], POINTS, strict=False)]
    known.write_text("\n".join(["point,X_mm,Y_mm,Z_mm,sigma_mm", *lines]) + "\n")
    lengths = {}
    for kind in ("rigid", "similarity"):
        found = pipeline.measure(rig(), pixels(), settings=MeasureSettings(frame=f"{kind}:{known}"))
        length = lengths[kind] = labcal.distance(found, "c", "d")
        squares = [length.noise_sigma**2, length.calibration_sigma**2, length.stated_sigma**2]
        assert length.sigma**2 == pytest.approx(sum(squares))
    assert lengths["rigid"].stated_sigma < 1e-9  # which moves all points alike
    assert lengths["similarity"].stated_sigma > 0.05


def test_names_choose_points() -> None:
    one, other = pixels(view="before"), pixels(places=TRUE + np.array([0.5, 0.2, -0.1]), view="after")
    both = NamedPixels(*(np.concatenate([getattr(one, column), getattr(other, column)]) for column in (
        "view", "camera", "point", "position", "covariance"
    )))  # fmt: skip
    found = pipeline.measure(rig(), both)
    moved = labcal.distance(found, ("before", "a"), ("after", "a"))
    assert moved.value == pytest.approx(np.linalg.norm([0.5, 0.2, -0.1]), abs=1e-6)
    names = ["a", "b", "c", "d"]
    motion = labcal.rigid_motion(found, [("before", n) for n in names], [("after", n) for n in names])
    np.testing.assert_allclose(motion.displacement_mm, [0.5, 0.2, -0.1], atol=1e-6)
    assert (
        labcal.distance(found, 0, 1).value == labcal.distance(found, ("before", "o"), ("before", "x")).value
    )
    with pytest.raises(InputError, match=r"'a' is in 2 views \(before, after\).*\('VIEW', 'a'\)"):
        labcal.distance(found, "a", ("after", "b"))
    with pytest.raises(UnknownNameError, match="no point named 'aa'"):
        labcal.distance(found, ("before", "aa"), ("after", "b"))
    with pytest.raises(UnknownNameError, match="no view in the points named 'later'"):
        labcal.distance(found, ("later", "a"), ("after", "b"))
    with pytest.raises(InputError, match="twice"):
        labcal.plane(found, [("before", "a"), ("before", "b"), ("before", "a")])
    dots = pipeline.reconstruct(examples.rig(), examples.detections(), examples.TARGET)
    with pytest.raises(InputError, match="dots have no names"):
        labcal.distance(dots, "a", "b")
    with pytest.raises(TypeError, match="number of a line, a name"):
        line_of(found.points, 1.5, "one")


def test_a_rig_without_covariance_gives_the_noise_alone() -> None:
    plain = rig().model_copy(update={"covariance": None})
    found = pipeline.measure(plain, pixels())
    alone = pipeline.measure(rig(), pixels(), budget="noise")
    assert found.budget.kind.value == "noise"
    assert found.points == alone.points
    assert labcal.distance(found, "a", "b").calibration_sigma == 0.0
    with pytest.raises(InputError, match=r"states no covariance.*`budget`"):
        pipeline.measure(plain, pixels(), budget="full")
    with pytest.raises(UnknownNameError, match="budget"):
        pipeline.measure(plain, pixels(), budget="half")


def test_a_method_takes_no_budget() -> None:
    """It states the covariance of its points itself."""
    dots = examples.detections()
    matches, Y = match(dots, ("left", "right")), examples.points().point
    model = Model(
        Affine().fit(matches.X, Y), ("left", "right"), ((640, 480),) * 2, TrainingBox.of(matches.X, Y)
    )
    two = pixels()
    two = two.where(two.camera != "middle")
    assert pipeline.measure(model, two).budget is None
    with pytest.raises(InputError, match="a fitted method states the covariance"):
        pipeline.measure(model, two, budget="full")


@pytest.mark.slow
def test_time_grows_with_the_points(tmp_path: Path) -> None:
    """Tables, matching, triangulation and the full budget; the time of the processor, the least of two."""
    rng, times = np.random.default_rng(9), []
    of = rig()
    for count in (20_000, 80_000):
        p = world_of_the_first(rng.uniform([-60, -50, 560], [60, 50, 640], (count, 3)))
        q = np.concatenate([camera.project(p).q for camera in TRUTH[::2]])
        names = [f"p{number}" for number in range(count)]
        table = tmp_path / f"{count}.csv"
        NamedPixels(["v"] * len(q), np.repeat(["left", "right"], count), names * 2, q).save(table)
        spent = []
        for _ in range(2):
            start = time.process_time()
            found = pipeline.measure(of, table, settings=MeasureSettings(pixel_sigma=NOISE_PX))
            named_points_csv(found.points)
            spent.append(time.process_time() - start)
        times.append(min(spent))
        assert found.budget.kind.value == "full"
    assert times[1] < 6.0 * times[0]
