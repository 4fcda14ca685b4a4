"""Eccentricity of dots by the tilt that their own outlines show, on exact projections of discs with noise."""

import numpy as np
import pytest

from labcal import NamedPixels, examples
from labcal.cameras.dot_image import SAMPLES, outlined_images
from labcal.correspond.mark_measurement import MarkPixels
from labcal.distributions import chi2_quantile
from labcal.reconstruct.mark_eccentricity import centred_marks

SIGMA = 0.03
CAMERAS = {name: examples.rig().camera(name) for name in examples.rig().cameras}
ANGLE = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES


def seen(n: int, seed: int) -> tuple[MarkPixels, np.ndarray, np.ndarray]:
    """Return pixels of discs tilted up to 60 degrees, the images of their centres, and their diameters."""
    rng = np.random.default_rng(seed)
    p = rng.uniform([-60, -40, 420], [100, 40, 520], (n, 3))
    tilt, azimuth, radius = rng.uniform(0, np.pi / 3, n), rng.uniform(0, 2 * np.pi, n), rng.uniform(4, 14, n)
    normal = np.stack([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), -np.cos(tilt)], axis=1)
    across = np.cross(normal, [0.0, 1.0, 0.1])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    up = np.cross(normal, across)
    circle = np.cos(ANGLE)[:, None] * across[:, None] + np.sin(ANGLE)[:, None] * up[:, None]
    rims = p[:, None] + radius[:, None, None] * circle
    images = [outlined_images(camera.project, p, rims) for camera in CAMERAS.values()]
    outline = np.concatenate([_noisy(one.outline, rng) for one in images])
    noise = SIGMA * rng.normal(size=(2 * n, 2))
    pixels = NamedPixels(
        np.full(2 * n, "v"),
        np.repeat(list(CAMERAS), n),
        [f"ring-23-{k}" for k in range(n)] * 2,
        np.concatenate([one.centroid for one in images]) + noise,
        np.tile(SIGMA**2 * np.eye(2), (2 * n, 1, 1)),
    )
    marks = MarkPixels(pixels, outline, np.full(2 * n, np.nan), np.zeros(2 * n, dtype=bool))
    return marks, np.concatenate([one.centre for one in images]), np.tile(2.0 * radius, 2)


def _noisy(outline: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return matrices of outlines whose edge points have independent errors."""
    off = outline - outline.mean(axis=1, keepdims=True)
    a, b = (2.0 / SAMPLES * (off * wave(ANGLE)[:, None]).sum(axis=1) for wave in (np.cos, np.sin))
    S = a[:, :, None] * a[:, None] + b[:, :, None] * b[:, None]
    L = np.linalg.cholesky(S)
    mean, first, second = rng.normal(size=(3, len(S))) * SIGMA / np.linalg.det(S) ** 0.25
    mean /= np.sqrt(2.0)
    E = np.array([[1.0 + 2.0 * (mean + first), 2.0 * second], [2.0 * second, 1.0 + 2.0 * (mean - first)]])
    return np.asarray(L @ E.transpose(2, 0, 1) @ L.swapaxes(1, 2))


def squares(error: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    return np.asarray((error * np.linalg.solve(covariance, error[..., None])[..., 0]).sum(axis=1))


def test_corrected_pixels_are_those_of_centres_within_their_covariances() -> None:
    marks, centre, diameter = seen(400, 0)
    found = centred_marks(CAMERAS, marks)
    assert found.corrected.all()
    before = squares(marks.pixels.position - centre, marks.pixels.covariance)
    after = squares(found.pixels.position - centre, found.pixels.covariance)
    limit = chi2_quantile(0.95, 2)
    assert (before < limit).mean() < 0.5
    assert (after < limit).mean() == pytest.approx(0.95, abs=3.3 * np.sqrt(0.95 * 0.05 / 800))
    assert abs(after.sum() - 1600) < 3.3 * np.sqrt(2.0 * 1600)
    off = marks.pixels.position - found.pixels.position
    assert found.size.rms == pytest.approx(np.sqrt((off**2).sum(axis=1).mean()))
    assert np.median(np.abs(found.diameter_mm / diameter - 1.0)) < 0.003


def test_outlines_of_no_flat_round_dot_correct_nothing_and_the_covariance_holds_the_size() -> None:
    marks, centre, _ = seen(100, 1)
    stretched = marks.outline.copy()
    stretched[100:, 0, 0] *= 1.5  # in the right picture alone, so that no tilt explains both
    stretched[100:, 0, 1] *= np.sqrt(1.5)
    stretched[100:, 1, 0] *= np.sqrt(1.5)
    found = centred_marks(CAMERAS, MarkPixels(marks.pixels, stretched, marks.diameter_mm, marks.is_plain))
    lines = found.uncorrected
    assert lines.mean() > 0.9
    assert (found.pixels.position[lines] == marks.pixels.position[lines]).all()
    grown = found.pixels.covariance[lines] - marks.pixels.covariance[lines]
    assert np.median(np.trace(grown, axis1=1, axis2=2)) > SIGMA**2
    error = found.pixels.position[lines] - centre[lines]
    stated = squares(error, found.pixels.covariance[lines])
    assert np.median(stated) < 0.3 * np.median(squares(error, marks.pixels.covariance[lines]))


def test_corners_and_dots_of_one_camera_stay_as_they_are() -> None:
    marks, _, _ = seen(4, 2)
    outline = marks.outline.copy()
    outline[[0, 4]] = np.nan  # the first point is a corner in both pictures
    names = marks.pixels.point.copy()
    names[5] = "ring-23-99"  # the second one is seen by one camera
    pixels = NamedPixels(
        marks.pixels.view, marks.pixels.camera, names, marks.pixels.position, marks.pixels.covariance
    )
    found = centred_marks(CAMERAS, MarkPixels(pixels, outline, marks.diameter_mm, marks.is_plain))
    assert found.corrected.tolist() == [False, False, True, True, False, False, True, True]
    assert found.uncorrected.tolist() == [False, True, False, False, False, True, False, False]
    assert (found.pixels.position[[0, 1, 4, 5]] == pixels.position[[0, 1, 4, 5]]).all()
