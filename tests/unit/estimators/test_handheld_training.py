"""Training data from a target in the hand, against the rig and the poses that made the dots."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.estimators.handheld_training import handheld_training
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]
LENS = "brown5"


def centroids(exact: Detections, pair: Cameras, grid: DotGrid, poses: Poses) -> Detections:
    """Put the centroids of the dots' images in the places of the images of their centres."""
    position = exact.position.copy()
    radii = 0.5 * grid.outer_diameters_mm()
    for view, T in poses.items():
        for name, camera in pair.items():
            rows = np.flatnonzero((exact.view == view) & (exact.camera == name))
            number = exact.index[rows, 1] * grid.cols + exact.index[rows, 0]
            position[rows] = dot_images(camera, T, grid.points(), radii).centroid[number]
    return replace(exact, position=position)


def test_dots_are_where_they_were_and_pixels_are_those_of_centres(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    exact = see(pair, grid, poses)
    dots = centroids(exact, pair, grid, poses)
    assert np.abs(dots.position - exact.position).max() > 0.01
    training = handheld_training(calibrate_handheld(dots, grid, LENS), dots, grid)
    data = training.data
    assert data.cameras == ("left", "right")
    assert len(data.X) == len(poses) * grid.count
    true = {
        (view, *index): place
        for view, T in poses.items()
        for index, place in zip(
            grid.indices().tolist(), (grid.points() @ T[:3, :3].T + T[:3, 3]).tolist(), strict=True
        )
    }
    expected = [true[view, *index] for view, index in zip(data.view, data.index.tolist(), strict=True)]
    # The world is the left camera, as it is in the fixture.
    np.testing.assert_allclose(data.Y, expected, atol=0.02)
    seen = [camera.project(np.array(expected)).q for camera in pair.values()]
    np.testing.assert_allclose(data.X, np.hstack(seen), atol=2e-3)
    assert training.cameras is not None
    assert training.eccentricity is not None
    assert training.eccentricity.max > 0.01


def test_dots_that_were_freed_are_where_they_were_found(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    dots = see(pair, grid, poses)
    found = calibrate_handheld(dots, grid, LENS, HandheldSettings(dot_places="freed", eccentricity_rounds=0))
    assert found.freed is not None
    moved = found.freed.place.copy()
    moved[4, 0] += 1.0
    elsewhere = replace(found, freed=replace(found.freed, place=moved))
    before, after = (handheld_training(one, dots, grid).data for one in (found, elsewhere))
    col, row = grid.indices()[4]
    off = np.linalg.norm(after.Y - before.Y, axis=1)
    np.testing.assert_allclose(off, (before.index == [col, row]).all(axis=1).astype(float), atol=1e-9)


def test_one_camera_is_not_enough(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    dots = see({"left": pair["left"]}, grid, poses)
    with pytest.raises(InputError, match="two cameras or more"):
        handheld_training(calibrate_handheld(dots, grid, LENS), dots, grid)
