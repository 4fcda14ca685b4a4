"""Points of named pixels: places and covariances against the truth, and every kind of bad input."""

import cv2
import numpy as np
import pytest
from scipy import stats

from labcal import Camera, InputError, NamedPixels, Rig, examples, pipeline
from labcal.calibrate.agreement.exchange.decision import ExchangedPicturesError
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.correspond.matching import match
from labcal.errors import UnknownNameError
from labcal.estimators.affine import Affine
from labcal.estimators.model import Model, TrainingBox
from labcal.geometry.poses import look_at
from labcal.pipeline import MeasureSettings

SIGMA = 0.05


def trio() -> Rig:
    """Return three pinhole cameras that look at a place 600 mm ahead, well calibrated by their own word."""
    K = [[800.0, 0.0, 320.0], [0.0, 800.0, 240.0], [0.0, 0.0, 1.0]]
    eyes = {"left": (-120.0, 0.0, 0.0), "middle": (0.0, 60.0, -40.0), "right": (120.0, 0.0, 0.0)}
    cameras = {
        name: Camera(
            K, "pinhole", [0] * 5, look_at(np.array(eye), np.array([0, 0, 600.0]), np.array([0, -1.0, 0])),
            (640, 480),
        )
        for name, eye in eyes.items()
    }  # fmt: skip
    record = CalibrationRecord(triangulation_rms_px=0.03, scatter_px=0.01)
    return Rig.of(cameras).model_copy(update={"calibration": record})


def pixels_of(rig: Rig, p: np.ndarray, noise: float, seed: int = 0) -> NamedPixels:
    rng, n = np.random.default_rng(seed), len(p)
    q = np.concatenate([rig.camera(name).project(p).q for name in rig.cameras])
    return NamedPixels(
        np.full(len(q), "v"),
        np.repeat(list(rig.cameras), n),
        np.tile([f"p{i}" for i in range(n)], len(rig.cameras)),
        q + noise * rng.normal(size=q.shape),
        np.tile(SIGMA**2 * np.eye(2), (len(q), 1, 1)),
    )


def moved(pixels: NamedPixels, position: np.ndarray) -> NamedPixels:
    return NamedPixels(pixels.view, pixels.camera, pixels.point, position, pixels.covariance)


def places(n: int) -> np.ndarray:
    return np.random.default_rng(5).uniform([-90, -60, 540], [90, 60, 660], (n, 3))


def test_points_are_those_of_opencv() -> None:
    rig, p = trio(), places(30)
    pixels = pixels_of(rig, p, 0.0)
    found = pipeline.measure(rig, pixels.where(pixels.camera != "middle"))
    K = np.array(rig.camera("left").K)
    P = [K @ rig.camera(name).T_cam_world[:3] for name in ("left", "right")]
    q = [pixels.position[pixels.camera == name].T for name in ("left", "right")]
    homogeneous = cv2.triangulatePoints(*P, *q)
    np.testing.assert_allclose(found.points.point, (homogeneous[:3] / homogeneous[3]).T, atol=1e-6)
    np.testing.assert_allclose(found.points.point, p, atol=1e-6)
    assert found.points.name.tolist() == [f"p{i}" for i in range(30)]


def test_covariances_hold_the_errors_whichever_cameras_see_a_point() -> None:
    """Normalised errors follow chi-square with three degrees of freedom, for pairs and for all three."""
    rig, p = trio(), places(3000)
    pixels = pixels_of(rig, p, SIGMA, seed=3)
    number = np.tile(np.arange(3000), 3)
    lost = ((number % 4 == 0) & (pixels.camera == "left")) | ((number % 4 == 1) & (pixels.camera == "right"))
    points = pipeline.measure(rig, pixels.where(~lost)).points
    row = np.array([int(name[1:]) for name in points.name.tolist()])
    error = points.point - p[row]
    normalised = np.einsum("ni,nij,nj->n", error, np.linalg.inv(points.covariance), error)
    for rest in (row % 4 == 0, row % 4 == 1, row % 4 > 1):
        assert stats.kstest(normalised[rest], stats.chi2(3).cdf).pvalue > 1e-3
    assert np.median(points.sigma_mm[row % 4 == 0]) > 1.3 * np.median(points.sigma_mm[row % 4 > 1])
    assert (points.flag == "ok").all()


def test_points_do_not_depend_on_how_many_are_solved_together(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = trio()
    pixels = pixels_of(rig, places(50), SIGMA)
    whole = pipeline.measure(rig, pixels).points
    monkeypatch.setattr("labcal.reconstruct.named_points._TOGETHER", 7)
    parts = pipeline.measure(rig, pixels).points
    np.testing.assert_allclose(parts.point, whole.point, atol=1e-8)


def test_a_point_that_one_camera_measured_has_no_place_and_is_said_to() -> None:
    rig = trio()
    pixels = pixels_of(rig, places(5), SIGMA)
    kept = pixels.where((pixels.point != "p2") | (pixels.camera == "left"))
    found = pipeline.measure(rig, kept)
    assert found.points.flag.tolist() == ["ok", "ok", "too-few-cameras", "ok", "ok"]
    assert np.isnan(found.points.point[2]).all()
    assert np.isnan(found.points.covariance[2]).all()
    (warning,) = found.warnings
    assert "1 point without a place" in warning
    assert "direction alone" in warning
    assert "p2" in warning


def test_pixels_of_one_camera_only_are_refused_with_what_they_allow() -> None:
    pixels = pixels_of(trio(), places(5), SIGMA)
    with pytest.raises(InputError, match=r"by two cameras or more .*direction of a point .*not its place"):
        pipeline.measure(trio(), pixels.where(pixels.camera == "left"))


def test_pixels_without_a_position_are_said_to_have_none() -> None:
    pixels = pixels_of(trio(), places(5), SIGMA)
    none = moved(pixels, np.full_like(pixels.position, np.nan))
    for settings in (None, MeasureSettings(pixel_sigma=0.1)):
        with pytest.raises(InputError, match="None of the 15 pixels has a position"):
            pipeline.measure(trio(), none, settings=settings)


def test_a_table_without_lines_is_one_without_points() -> None:
    none = pixels_of(trio(), places(1), SIGMA).where([])
    for settings in (None, MeasureSettings(pixel_sigma=0.1)):
        with pytest.raises(InputError, match="the pixels are those of none"):
            pipeline.measure(trio(), none, settings=settings)


def test_a_camera_that_the_rig_does_not_have_is_refused() -> None:
    pixels = pixels_of(trio(), places(5), SIGMA)
    rig = Rig.of({name: trio().camera(name) for name in ("left", "right")})
    with pytest.raises(UnknownNameError, match="no camera in the rig named 'middle'"):
        pipeline.measure(rig, pixels)


def test_a_pixel_outside_of_its_picture_is_not_used_and_its_point_is_flagged() -> None:
    rig, p = trio(), places(4)
    pixels = pixels_of(rig, p, 0.0)
    position = pixels.position.copy()
    position[(pixels.point == "p0") & (pixels.camera == "left")] = [639.6, 100.0]
    position[(pixels.point == "p1") & (pixels.camera != "right")] = [-0.6, 100.0]
    found = pipeline.measure(rig, moved(pixels, position))
    assert found.points.flag.tolist() == ["outside-picture", "outside-picture", "ok", "ok"]
    np.testing.assert_allclose(found.points.point[0], p[0], atol=1e-6)  # by the two others
    assert np.isnan(found.points.point[1]).all()
    assert "'left' 640 x 480" in found.warnings[0]


def test_one_wrong_pixel_among_few_is_found_by_the_calibrations_noise() -> None:
    """Three points are too few for what is usual among them to tell; the calibration's residuals do."""
    rig = trio()
    pixels = pixels_of(rig, places(3), SIGMA, seed=1)
    position = pixels.position.copy()
    position[(pixels.point == "p1") & (pixels.camera == "right"), 1] += 1.0
    found = pipeline.measure(rig, moved(pixels, position))
    assert found.points.flag.tolist() == ["ok", "model-misfit", "ok"]


def test_pixels_from_another_corner_do_not_pass() -> None:
    """Half a pixel along and across in one camera: far above what the calibration left."""
    rig = trio()
    pixels = pixels_of(rig, places(40), SIGMA)
    position = pixels.position + np.where(pixels.camera == "right", 0.5, 0.0)[:, None]
    found = pipeline.measure(rig, moved(pixels, position))
    assert found.check is not None
    assert found.check.inconsistent
    assert set(found.points.flag.tolist()) == {"model-misfit"}
    assert "count from another corner" in found.warnings[0]


def test_exchanged_pictures_are_refused() -> None:
    rig = trio()
    pixels = pixels_of(rig, places(40), 0.0)
    other = {"left": "right", "right": "left", "middle": "middle"}
    exchanged = [other[name] for name in pixels.camera.tolist()]
    with pytest.raises(ExchangedPicturesError):
        pipeline.measure(
            rig, NamedPixels(pixels.view, exchanged, pixels.point, pixels.position, pixels.covariance)
        )


def test_noise_is_stated_once() -> None:
    rig = trio()
    known = pixels_of(rig, places(5), 0.0)
    unknown = NamedPixels(known.view, known.camera, known.point, known.position)
    with pytest.raises(InputError, match=r"15 of 15 pixels have no covariance .*`pixel_sigma=0.1`"):
        pipeline.measure(rig, unknown)
    with pytest.raises(InputError, match="`pixel_sigma` would be dropped"):
        pipeline.measure(rig, known, settings=MeasureSettings(pixel_sigma=0.1))
    stated = pipeline.measure(rig, unknown, settings=MeasureSettings(pixel_sigma=SIGMA))
    assert stated.points == pipeline.measure(rig, known).points
    half = replace_covariance(known, np.arange(15) % 2 == 0)
    assert pipeline.measure(rig, half, settings=MeasureSettings(pixel_sigma=SIGMA)).points == stated.points


def replace_covariance(pixels: NamedPixels, forgotten: np.ndarray) -> NamedPixels:
    covariance = np.where(forgotten[:, None, None], np.nan, pixels.covariance)
    return NamedPixels(pixels.view, pixels.camera, pixels.point, pixels.position, covariance)


@pytest.mark.parametrize("sigma", [0.0, -1.0, np.nan, np.inf])
def test_a_sigma_that_is_none_is_refused(sigma: float) -> None:
    with pytest.raises(InputError, match="`pixel_sigma`"):
        MeasureSettings(pixel_sigma=sigma)


def test_a_fitted_method_takes_all_of_its_cameras() -> None:
    """The dots of a board, given as named pixels, are the same points as dots."""
    dots = examples.detections()
    matches, Y = match(dots, ("left", "right")), examples.points().point
    box = TrainingBox.of(matches.X, Y)
    model = Model(Affine().fit(matches.X, Y), ("left", "right"), ((640, 480), (640, 480)), box)
    names = [f"{col}-{row}" for col, row in dots.index.tolist()]
    pixels = NamedPixels(dots.view, dots.camera, names, dots.position, dots.covariance)
    found = pipeline.measure(model, pixels.where(np.arange(len(pixels)) > 0))
    assert found.points.flag.tolist().count("too-few-cameras") == 1
    assert "takes the pixels of all of its cameras" in found.warnings[0]
    of_dots = pipeline.reconstruct(model, dots).points
    by_name = {
        (v, n): p for v, n, p in zip(found.points.view, found.points.name, found.points.point, strict=True)
    }
    expected = {
        (v, f"{col}-{row}"): p
        for v, (col, row), p in zip(of_dots.view, of_dots.index, of_dots.point, strict=True)
    }
    for key in list(expected)[1:]:
        np.testing.assert_array_equal(by_name[key], expected[key])
    with pytest.raises(InputError, match="A fitted method takes all of its cameras"):
        pipeline.measure(model, pixels.where(pixels.camera == "left"))


def test_reconstruct_of_pixels_is_measure() -> None:
    rig = trio()
    pixels = pixels_of(rig, places(5), SIGMA)
    assert pipeline.reconstruct(rig, pixels) == pipeline.measure(rig, pixels)
    with pytest.raises(InputError, match="`settings` go with named pixels"):
        pipeline.reconstruct(examples.rig(), examples.detections(), settings=MeasureSettings())


def test_a_contradictory_calibration_makes_points_doubtful() -> None:
    record = CalibrationRecord(triangulation_rms_px=0.03, scatter_px=0.01, inconsistent=("camera-moved",))
    rig = trio().model_copy(update={"calibration": record})
    found = pipeline.measure(rig, pixels_of(rig, places(5), SIGMA))
    assert set(found.points.flag.tolist()) == {"model-misfit"}
    assert "camera-moved" in found.warnings[0]
