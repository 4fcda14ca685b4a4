"""A print that one set of views measured, used again in another set: points, sigmas, refusals."""

from pathlib import Path

import numpy as np
import pytest

from labcal import InputError, examples
from labcal.bench.solve.budget_rigs import KINDS
from labcal.calibrate.adjustment.observations import observations_of
from labcal.calibrate.adjustment.rounds import adjust_in_rounds
from labcal.calibrate.adjustment.state import Freedom, Lenses, RigState
from labcal.calibrate.budget.entered import Entered
from labcal.calibrate.budget.print_share import PrintShare
from labcal.calibrate.calibrated import calibrated
from labcal.calibrate.calibration import Calibration
from labcal.calibrate.handheld import HandheldSettings
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.distributions import chi2_quantile
from labcal.reconstruct.point_budget import PointBudget
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid, Rings
from labcal.targets.places import DotPlaces, read_places

KIND = KINDS["webcam"]
NOISE_PX, PRINT_MM = 0.01, 0.1
"""The print is what limits a calibration: on the pictures its dots are off by 0.13 px."""
TARGET = DotGrid(
    name="held", cols=9, rows=7, pitch_x_mm=20.0, pitch_y_mm=20.0, dot_diameter_mm=6.0,
    ring_outer_diameter_mm=12.0, ring_inner_diameter_mm=5.0, rings=Rings(origin=(2, 1), x=(6, 1), y=(2, 4)),
    margin_mm=15.0,
)  # fmt: skip
FREE = HandheldSettings(eccentricity_rounds=0, dot_places="freed")


def detections(printed: np.ndarray, views: int, rng: np.random.Generator) -> Detections:
    """Return images of a print in some views, with noise."""
    places = [printed @ T[:3, :3].T + T[:3, 3] for T in KIND.poses(views, rng)]
    q = np.concatenate([camera.project(p).q for camera in KIND.cameras() for p in places])
    n = len(q)
    return Detections(
        view=np.tile(np.repeat([f"view-{number:02d}" for number in range(views)], len(printed)), 2),
        camera=np.repeat(("left", "right"), n // 2),
        image=np.full(n, "none.png"),
        size=np.tile(KIND.size, (n, 1)),
        index=np.tile(TARGET.indices(), (2 * views, 1)),
        has_id=np.ones(n, dtype=bool),
        position=q + NOISE_PX * rng.standard_normal(q.shape),
        covariance=np.tile(NOISE_PX**2 * np.eye(2), (n, 1, 1)),
        flag=np.full(n, "ok"),
    )


def printed(rng: np.random.Generator) -> np.ndarray:
    dots = TARGET.points()
    dots[:, :2] += PRINT_MM * rng.standard_normal((len(dots), 2))
    return dots


def errors(made: Calibration, rng: np.random.Generator) -> tuple[float, float, float]:
    """Return RMS error of points in the frame of the rig, its stated value, and the 95% ellipsoids' share."""
    true = KIND.points(100, rng)
    q = np.stack([camera.project(true).q for camera in KIND.cameras()], axis=1)
    q += NOISE_PX * rng.standard_normal(q.shape)
    pixels = np.tile(NOISE_PX**2 * np.eye(2), (len(q), 2, 1, 1))
    point = triangulate([made.rig.camera(name) for name in made.rig.cameras], q, pixels).point
    budget = PointBudget.of(made.rig, point, pixels, None)
    covariance = budget.noise + budget.calibration
    off = point - true
    square = np.einsum("ni,nij,nj->n", off, np.linalg.inv(covariance), off)
    return (
        float(np.sqrt((off**2).sum(axis=1).mean())),
        float(np.sqrt(np.trace(covariance, axis1=1, axis2=2).mean())),
        float((square < chi2_quantile(0.95, 3)).mean()),
    )


def places_kept(places: DotPlaces | Path) -> HandheldSettings:
    return HandheldSettings(eccentricity_rounds=0, dots=places)


@pytest.fixture(scope="module")
def print_() -> np.ndarray:
    return printed(np.random.default_rng(5))


@pytest.fixture(scope="module")
def first(print_: np.ndarray) -> Calibration:
    return calibrated(detections(print_, 12, np.random.default_rng(1)), TARGET, "brown5", FREE)


@pytest.fixture(scope="module")
def small(print_: np.ndarray) -> Detections:
    return detections(print_, 5, np.random.default_rng(2))


@pytest.fixture(scope="module")
def again(first: Calibration, small: Detections) -> Calibration:
    assert first.places is not None
    return calibrated(small, TARGET, "brown5", places_kept(first.places))


def test_points_are_nearer_to_the_truth_and_within_what_is_stated(
    again: Calibration, small: Detections
) -> None:
    flat = HandheldSettings(eccentricity_rounds=0, dot_places="declared")
    declared = calibrated(small, TARGET, "brown5", flat)
    off, stated, _ = errors(again, np.random.default_rng(3))
    off_declared, stated_declared, _ = errors(declared, np.random.default_rng(3))
    assert off < 0.5 * off_declared
    assert stated < 0.5 * stated_declared
    assert off < 2.5 * stated
    depth, measured = declared.expected_errors().depth, again.expected_errors().depth
    assert 0.9 * depth.calibration_mm < depth.print_mm < depth.calibration_mm
    assert measured.print_mm < 0.2 * depth.print_mm
    assert any("uneven print" in warning for warning in declared.warnings)
    assert not any("scatter by" in warning for warning in again.warnings)


@pytest.mark.slow
def test_95_percent_ellipsoids_hold_over_many_prints() -> None:
    held, square, stated = [], [], []
    for number in range(8):
        rng = np.random.default_rng([9, number])
        dots = printed(rng)
        places = calibrated(detections(dots, 12, rng), TARGET, "brown5", FREE).places
        assert places is not None
        off, sigma, share = errors(
            calibrated(detections(dots, 5, rng), TARGET, "brown5", places_kept(places)), rng
        )
        held.append(share)
        square.append(off**2)
        stated.append(sigma**2)
    assert np.mean(held) > 0.85  # all points of a set share its errors: a mean over sets is good to some 0.05
    assert 0.3 < np.mean(square) / np.mean(stated) < 2.0


def test_the_errors_of_the_measurement_are_in_the_covariance(again: Calibration, first: Calibration) -> None:
    share = again.found.sources.print_share
    assert share is not None
    assert first.places is not None
    assert share.sigma_mm < 0.3 * PRINT_MM  # what residuals show beyond them
    sigma = np.sqrt(np.diagonal(first.places.covariances(), axis1=1, axis2=2)[:, :2].mean())
    assert share.measured_sigma_mm > sigma  # with the mean scale, which is off as dots are in the mean
    assert np.trace(share.measured) > 0.0
    assert again.rig.covariance is not None
    assert again.rig.covariance.print_sigma_mm >= share.measured_sigma_mm
    assert np.array_equal(again.found.dots, first.places.points())


def test_what_is_written_of_the_joint_covariance_does_to_cameras_what_all_of_it_does(
    first: Calibration, again: Calibration, small: Detections
) -> None:
    dots, places = first.found.freed, first.places
    assert dots is not None
    assert places is not None
    joint = dots.covariance.reshape(dots.place.size, -1)
    rig, found = again.rig, again.found
    seen = observations_of(small, TARGET, tuple(rig.cameras), found.views)
    cameras = tuple(rig.camera(name) for name in rig.cameras)
    state = RigState(cameras, found.T_world_target, found.dots)
    kept = Freedom(Lenses.FREE, np.zeros((found.dots.size, 0)))
    adjusted = adjust_in_rounds(state, seen, kept, 0.5 * TARGET.outer_diameters_mm(), 0)
    entered = Entered.of(adjusted, seen)
    free = entered.cameras
    every = entered.linearised(np.eye(dots.place.size))
    assert every.reduced is not None
    information = every.reduced.matrix * np.outer(every.reduced.scale, every.reduced.scale)
    effect = entered.with_fixed_dots().shared_spread() @ information[:free, free:]
    exact = effect @ joint @ effect.T
    without_datum = places.model_copy(update={"datum": ()})
    stated = PrintShare.of_declared(entered, without_datum).measured
    ratio = np.sqrt(np.diagonal(stated) / np.diagonal(exact))
    assert ratio == pytest.approx(np.ones(free), rel=0.15)
    none_in_common = places.model_copy(update={"datum": (), "shared": ()})
    assert np.diagonal(PrintShare.of_declared(entered, none_in_common).measured)[0] < 0.8 * exact[0, 0]


def test_the_file_holds_what_the_object_does(first: Calibration, tmp_path: Path) -> None:
    assert first.places is not None
    first.places.save(tmp_path / "rig-dots.json")
    assert read_places(tmp_path / "rig-dots.json") == first.places
    assert places_kept(tmp_path / "rig-dots.json").places == first.places
    assert len(first.places.datum) == 1  # the mean scale; what moves the whole is the pose's
    assert first.places.shared


def test_the_views_of_the_print_are_views_of_the_calibration(again: Calibration) -> None:
    assert len(again.calibrated_on) == 12  # of both sets; names of the five are among the twelve


def test_places_of_another_target_are_refused_by_name(first: Calibration) -> None:
    assert first.places is not None
    with pytest.raises(InputError, match="those of the target 'held', but the dots are of 'plain-11x8'"):
        calibrated(
            examples.detections(), load_target(examples.TARGET), None, HandheldSettings(dots=first.places)
        )


def test_dots_are_kept_or_freed(first: Calibration) -> None:
    with pytest.raises(InputError, match="`dots` keeps the dots where they were measured"):
        HandheldSettings(dot_places="freed", dots=first.places)


def test_another_copy_of_the_target_is_noticed(first: Calibration) -> None:
    assert first.places is not None
    other = detections(printed(np.random.default_rng(6)), 5, np.random.default_rng(2))
    made = calibrated(other, TARGET, "brown5", places_kept(first.places))
    assert any("another copy of the target" in warning for warning in made.warnings)
