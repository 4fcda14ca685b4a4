"""Points of methods that were fitted to a target held in the hand: the adjustment's errors are in them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.estimators.bundle import Bundle
from labcal.estimators.fitting import fit_method
from labcal.estimators.handheld_training import handheld_training
from labcal.estimators.model import Model
from labcal.evaluate.aligned_budget import PointOrigin, aligned_covariance
from labcal.geometry.poses import rigid_alignment, transform
from labcal.reconstruct.reconstruction import reconstruct_centres
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]
NOISE_PX, DRAWS = 0.05, 8


def noisy(dots: Detections, seed: int) -> Detections:
    noise = NOISE_PX * np.random.default_rng(seed).standard_normal(dots.position.shape)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(dots.position), 1, 1))
    return replace(dots, position=dots.position + noise, covariance=covariance)


def fitted(dots: Detections, grid: DotGrid) -> Model:
    """Fit to dots whose pixels are those of centres: without diameters there is no eccentricity."""
    flat = grid.model_copy(update={"dot_diameter_mm": 1e-3, "ring_outer_diameter_mm": 2e-3, "rings": None})
    found = calibrate_handheld(dots, flat, "brown5", HandheldSettings(eccentricity_rounds=0))
    training = handheld_training(found, dots, flat)
    model = fit_method(training.data, Bundle("brown5", training.data.image_sizes), training.cameras)
    return replace(model, calibration=training.calibration, covariance=training.covariance)


@pytest.mark.slow
def test_ellipsoids_hold_the_truth_only_with_the_adjustments_share(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses, tmp_path: Path
) -> None:
    exact, whole, alone, aligned = see(pair, grid, poses), [], [], []
    matches = match(exact, ("left", "right"))
    dots = matches.index[:, 1] * grid.cols + matches.index[:, 0]
    places = {view: transform(T, grid.points()) for view, T in poses.items()}
    true = np.array([places[view][dot] for view, dot in zip(matches.view, dots, strict=True)])
    for seed in range(DRAWS):
        model = fitted(noisy(exact, seed), grid)
        model.save(tmp_path / f"{seed}.safetensors")
        assert Model.load(tmp_path / f"{seed}.safetensors") == model
        seen = noisy(exact, DRAWS + seed)
        points = reconstruct_centres(model, seen, None).points
        whole.append(squares(points.point - true, points.covariance))
        without = reconstruct_centres(replace(model, covariance=None), seen, None).points
        alone.append(squares(points.point - true, without.covariance))
        assert model.placed_by is not None
        left = aligned_covariance(points, PointOrigin(model.placed_by, triangulated=False), seen)
        assert left is not None
        T = rigid_alignment(true, points.point)
        aligned.append(squares(transform(T, points.point) - true, T[:3, :3] @ left @ T[:3, :3].T))
    # Points of one draw share the errors of its adjustment: of each draw one point counts.
    for found in (whole, aligned):
        of_first = np.array(found)[:, 0].sum()
        assert 0.001 < chi2.cdf(of_first, 3 * DRAWS) < 0.999
    assert np.median(alone) > 100.0


def squares(error: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return squared errors in units of their covariance, three degrees of freedom each."""
    return np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[..., None])[..., 0])


def test_points_of_an_older_model_stay_as_they_are(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    dots = noisy(see(pair, grid, poses), 1)
    model = fitted(dots, grid)
    older = reconstruct_centres(replace(model, covariance=None), dots, None).points
    assert model.placed_by is not None
    assert aligned_covariance(older, PointOrigin(model.placed_by, triangulated=False), dots) is None
