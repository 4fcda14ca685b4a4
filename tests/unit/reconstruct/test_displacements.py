"""Displacements of named points between views, against cameras and pixels that are drawn anew each time."""

import csv
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import labcal
from labcal import (
    Camera,
    Displacements,
    InputError,
    NamedPixels,
    NamedReconstruction,
    Rig,
    examples,
    pipeline,
)
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.rig_covariance import RigCovariance
from labcal.errors import UnknownNameError
from labcal.geometry.poses import from_rotation_vector, transform
from labcal.pipeline import MeasureSettings
from labcal.reconstruct.displacements import displacement_warnings

NOISE_PX = 0.03
SIGMA = np.array([*[0.1] * 4, 5e-4, 1e-3] * 2 + [5e-5] * 3 + [0.03] * 3)  # px, 1, rad, mm
NAMES = ("a", "b", "c", "d", "e")
START = np.array(
    [[-90, -20, 620], [80, 30, 580], [20, -60, 600], [-30, 50, 640], [0, 0, 610]], dtype=np.float64
)
MOTION = from_rotation_vector(np.array([0.0, 0.0, 0.01]), np.array([1.5, -1.0, 2.0]))
VIEWS = {"load-0": START, "load-1": transform(MOTION, START)}
DRAWS = 32


def cameras() -> tuple[Camera, ...]:
    K = [[900.0, 0.0, 320.0], [0.0, 905.0, 240.0], [0.0, 0.0, 1.0]]
    turned = np.eye(4)
    turned[:3, :3] = [[np.cos(0.3), 0, np.sin(0.3)], [0, 1, 0], [-np.sin(0.3), 0, np.cos(0.3)]]
    turned[:3, 3] = [-180.0, 3.0, 25.0]
    return tuple(Camera(K, "brown-k1k2", [-0.1, 0.05, 0, 0, 0], T, (640, 480)) for T in (np.eye(4), turned))


def rig(step: np.ndarray | None = None) -> Rig:
    found = cameras()
    if step is not None:
        state = RigState(found, np.eye(4)[None], np.zeros((1, 3)))
        layout = Layout(state, Freedom(Lenses.FREE, np.zeros((3, 0))))
        found = layout.stepped(step, np.zeros((1, 6))).cameras
    plain = Rig.of(dict(zip(("left", "right"), found, strict=True)))
    record = RigCovariance.of(plain.cameras, np.diag(SIGMA**2))
    return plain.model_copy(update={"covariance": record})


def pixels(rng: np.random.Generator | None = None) -> NamedPixels:
    columns: list[tuple[str, str, str]] = []
    q = []
    for view, places in VIEWS.items():
        for name, camera in zip(("left", "right"), cameras(), strict=True):
            columns += [(view, name, point) for point in NAMES]
            q.append(camera.project(places).q)
    position = np.concatenate(q)
    if rng is not None:
        position = position + NOISE_PX * rng.standard_normal(position.shape)
    known = np.tile(NOISE_PX**2 * np.eye(2), (len(position), 1, 1))
    return NamedPixels(*map(list, zip(*columns, strict=True)), position, known)


def measured(drop: tuple[str, str] = ("", "")) -> NamedReconstruction:
    every = pixels()
    return pipeline.measure(rig(), every.where(~((every.view == drop[0]) & (every.point == drop[1]))))


def agree(errors: np.ndarray, stated: np.ndarray) -> bool:
    """Tell whether errors, (draws, k), are as large as stated: a two-sided chi-square test at 0.1%."""
    square = float(np.einsum("di,ij,dj->", errors, np.linalg.inv(stated), errors))
    low, high = stats.chi2.ppf([5e-4, 0.9995], errors.size)
    return bool(low < square < high)


@pytest.mark.parametrize("frame", [None, pytest.param("points:a,b,c", marks=pytest.mark.slow)])
def test_displacements_and_motions_scatter_as_stated(frame: str | None) -> None:
    """The calibration cancels but for little; without that, covariances would be far too large."""
    settings = MeasureSettings(frame=frame, frame_view=frame and "load-0")
    exact = labcal.displacements(pipeline.measure(rig(), pixels(), settings=settings))
    if frame is None:
        np.testing.assert_allclose(exact.displacement, VIEWS["load-1"] - START, atol=1e-6)
    rng = np.random.default_rng(3)
    found = []
    for _ in range(DRAWS):
        of = rig(SIGMA * rng.standard_normal(len(SIGMA)))
        found.append(labcal.displacements(pipeline.measure(of, pixels(rng), settings=settings)))
    errors = np.array([one.displacement - exact.displacement for one in found])
    for row in range(len(NAMES)):
        assert agree(errors[:, row], exact.covariance[row])
    motion = exact.motions["load-1"]
    off = np.array([one.motions["load-1"].displacement_mm - motion.displacement_mm for one in found])
    assert agree(off, motion.shares.total[:3, :3])


def test_a_displacement_is_known_better_than_its_ends() -> None:
    found = measured()
    moved = labcal.displacements(found)
    ends = np.trace(found.points.covariance[:5], axis1=1, axis2=2)
    assert (np.trace(moved.covariance, axis1=1, axis2=2) < 0.2 * ends).all()
    np.testing.assert_allclose(moved.motions["load-1"].rotation_rad, [0.0, 0.0, 0.01], atol=1e-8)
    assert moved.motions["load-1"].rms_mm < 1e-7


def test_the_reference_may_be_any_view() -> None:
    forth, back = labcal.displacements(measured()), labcal.displacements(measured(), "load-1")
    np.testing.assert_allclose(back.displacement, -forth.displacement, atol=1e-12)
    np.testing.assert_allclose(back.covariance, forth.covariance, rtol=1e-6, atol=1e-12)
    assert back.view.tolist() == ["load-0"] * 5


def test_what_has_no_reference_is_said_and_what_has_no_place_is_nan() -> None:
    new = labcal.displacements(measured(("load-0", "b")))
    assert "b" not in new.name
    assert new.without_reference == ("b",)
    assert "does not have the points b" in displacement_warnings(new)[0]
    assert displacement_warnings(labcal.displacements(measured())) == ()
    one = pixels()
    lost = one.where(~((one.view == "load-1") & (one.point == "d") & (one.camera == "left")))
    found = labcal.displacements(pipeline.measure(rig(), lost))
    row = found.name.tolist().index("d")
    assert found.flag[row] == "too-few-cameras"
    assert np.isnan(found.displacement[row]).all()
    assert np.isnan(found.covariance[row]).all()
    assert found.flag.tolist().count("ok") == 4
    assert found.motions["load-1"].rms_mm < 1e-7  # of the others


def test_the_table_is_written_and_drawn(tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    moved = labcal.displacements(labcal.measure(examples.rig(), examples.moved_pixels()))
    moved.save(tmp_path / "moved.csv")
    with (tmp_path / "moved.csv").open() as file:
        lines = list(csv.DictReader(file))
    assert [line["point"] for line in lines] == moved.name.tolist()
    assert [float(line["dZ_mm"]) for line in lines] == moved.displacement[:, 2].tolist()
    assert [float(line["cov_xz"]) for line in lines] == moved.covariance[:, 0, 2].tolist()
    assert moved.to_pandas().columns.tolist() == list(lines[0])
    axes = moved.plot().axes
    assert [panel.get_ylabel() for panel in axes] == ["dX (mm)", "dY (mm)", "dZ (mm)"]
    assert moved == labcal.displacements(labcal.measure(examples.rig(), examples.moved_pixels()))
    assert "rigid displacement" in moved._repr_html_()


def test_what_is_no_series_is_refused() -> None:
    found = measured()
    with pytest.raises(UnknownNameError, match="no view in the points named 'load-2'"):
        labcal.displacements(found, "load-2")
    one = pixels()
    with pytest.raises(InputError, match="All points are of one view, 'load-0'"):
        labcal.displacements(pipeline.measure(rig(), one.where(one.view == "load-0")))
    names = [f"{view}-{point}" for view, point in zip(one.view, one.point, strict=True)]
    other = NamedPixels(one.view, one.camera, names, one.position, one.covariance)
    with pytest.raises(InputError, match="was measured in another view"):
        labcal.displacements(pipeline.measure(rig(), other))


def test_three_points_on_a_line_have_displacements_and_no_motion() -> None:
    line = np.array([[0.0, 0, 600], [20.0, 10, 600], [40.0, 20, 600]])
    q = np.concatenate([camera.project(line + move).q for move in (0.0, 1.0) for camera in cameras()])
    table = NamedPixels(
        np.repeat(["x", "y"], 6), np.tile(np.repeat(["left", "right"], 3), 2), np.tile(["a", "b", "c"], 4), q,
        np.tile(NOISE_PX**2 * np.eye(2), (12, 1, 1)),
    )  # fmt: skip
    found: Displacements = labcal.displacements(pipeline.measure(rig(), table))
    assert found.motions == {}
    np.testing.assert_allclose(found.displacement, 1.0, atol=1e-6)
