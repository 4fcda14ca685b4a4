"""Mistakes of the rendered laboratory on exact pixels: what each changes, and what it leaves."""

import numpy as np
import pytest

from labcal.bench.families.registry import family_by_name
from labcal.bench.families.volume import TABLE
from labcal.bench.faults.planned_planes import PlannedPlanes
from labcal.bench.faults.registry import FAULT_KINDS, fault_named
from labcal.errors import InputError
from labcal.scene.mistakes import DRIFT_MM, KNOCK_DEG, Mistake

PAIR = family_by_name("brown").pair(0.6, 0)
PLANES = PlannedPlanes.of(TABLE.planes(5, 4), PAIR, 0)
RIGHT = PLANES.images(PLANES.dots, PLANES.takes).reshape(4, 20, 2, 2)
FIRST, SECOND = 0, 1


def taken(name: str) -> np.ndarray:
    """Return pixels by view, dot and camera."""
    fault = fault_named(name)
    return fault.kind.images(PLANES, fault.size).reshape(RIGHT.shape)


def test_every_mistake_of_the_laboratory_is_a_fault() -> None:
    assert set(Mistake) <= set(FAULT_KINDS)


@pytest.mark.parametrize(("name", "first"), [("swapped-cameras", 2), ("swapped-cameras-0.5", 3)])
def test_swapped_cameras_exchange_the_pictures_of_the_later_views(name: str, first: int) -> None:
    q = taken(name)
    assert np.array_equal(q[:first], RIGHT[:first])
    assert np.array_equal(q[first:], RIGHT[first:, :, ::-1])


def test_a_turned_board_shows_the_dots_of_one_view_in_reverse() -> None:
    q = taken("board-turned")
    assert np.abs(q[2] - RIGHT[2, ::-1]).max() < 1e-9
    assert np.array_equal(q[[0, 1, 3]], RIGHT[[0, 1, 3]])


def test_a_knocked_camera_is_the_second_one_later() -> None:
    q = taken("camera-knocked")
    assert np.array_equal(q[:, :, FIRST], RIGHT[:, :, FIRST])
    assert np.array_equal(q[:2], RIGHT[:2])
    shift_px = np.linalg.norm(q[2:, :, SECOND] - RIGHT[2:, :, SECOND], axis=-1)
    assert 0.1 * np.radians(KNOCK_DEG) * 1000.0 < shift_px.mean() < 2.0 * np.radians(KNOCK_DEG) * 1000.0


def test_pictures_that_are_not_synchronised_are_off_in_the_second_camera_by_the_drift() -> None:
    q = taken("unsynchronised-0.1")
    assert np.array_equal(q[:, :, FIRST], RIGHT[:, :, FIRST])
    shift_px = np.linalg.norm(q[:, :, SECOND] - RIGHT[:, :, SECOND], axis=-1)
    assert (shift_px.max(axis=1) > 0.0).all()
    most_mm = 0.1 * DRIFT_MM + np.radians(0.04) * np.linalg.norm(PLANES.half)
    assert shift_px.max() < 1000.0 * most_mm / 1400.0


def test_what_acts_on_pictures_only_is_refused_on_points() -> None:
    with pytest.raises(InputError, match="'out-of-focus' acts on pictures only"):
        taken("out-of-focus")
