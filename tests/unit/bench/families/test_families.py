"""Families of camera pairs: a pinhole without strength, and the cameras that other figures rest on."""

import numpy as np
import pytest

from labcal.bench.families.registry import FAMILIES, Family, family_by_name
from labcal.bench.families.volume import ROOM, TABLE, Volume
from labcal.bench.solve.families import FAMILIES as OF_SOLVE
from labcal.cameras.camera import Camera
from labcal.errors import InputError

STRENGTHS = (0.0, 0.1, 0.3, 0.6, 1.0)
EACH = pytest.mark.parametrize("family", FAMILIES.values(), ids=lambda family: family.name)


def pinhole_pixels(camera: Camera, p: np.ndarray) -> np.ndarray:
    """Project by the textbook's formula and nothing else."""
    homogeneous = p @ camera.T_cam_world[:3, :3].T + camera.T_cam_world[:3, 3]
    image = homogeneous @ np.array([[1000.0, 0.0, 640.3], [0.0, 1000.0, 478.2], [0.0, 0.0, 1.0]]).T
    return np.asarray(image[:, :2] / image[:, 2:])


@EACH
def test_without_strength_every_family_is_a_pinhole(family: Family) -> None:
    p = family.volume(0.0).planes()
    for camera in family.pair(0.0, seed=3):
        assert np.abs(camera.project(p).q - pinhole_pixels(camera, p)).max() < 1e-9


@EACH
def test_a_family_departs_from_the_pinhole_the_more_the_stronger(family: Family) -> None:
    p = TABLE.planes()
    focal_lengths = [family.pair(strength, seed=3)[0].K[0, 0] / 1000.0 for strength in STRENGTHS]
    middle = np.array([640.3, 478.2])
    departures = []
    for strength, share in zip(STRENGTHS, focal_lengths, strict=True):
        camera = family.pair(strength, seed=3)[0]
        q = (camera.project(p).q - middle) / share + middle
        departures.append(float(np.linalg.norm(q - pinhole_pixels(camera, p), axis=1).max()))
    assert departures == sorted(departures)
    assert departures[-1] > 2.0


@EACH
@pytest.mark.parametrize("strength", STRENGTHS)
def test_the_cameras_see_their_volume(family: Family, strength: float) -> None:
    p = family.volume(strength).planes()
    for camera in family.pair(strength, seed=0):
        assert camera.in_picture(camera.project(p).q).mean() > 0.9


def test_strengths_are_known_by_figures_that_people_know() -> None:
    said = {name: family.known_as(1.0) for name, family in FAMILIES.items()}
    assert said["brown"] == "k1 -0.5"
    assert said["fisheye"] == "150 degrees"
    assert said["double-sphere"] == "170 degrees"
    assert said["water"] == "index 1.333, tilt 30 deg"
    widest = family_by_name("double-sphere").pair(1.0, 0)[0]
    ends = widest.rays([[0.3, 478.2], [1280.3, 478.2]]).direction @ widest.T_cam_world[2, :3]
    assert np.degrees(np.arccos(ends)) == pytest.approx([85.0, 85.0])


def test_the_cameras_of_bench_solve_stay_the_same() -> None:
    by_name = {family.name: family.pair(0)[0] for family in OF_SOLVE}
    assert by_name["brown"].dist.tolist() == [-0.3, 0.09, 0.0006, -0.0004, 0.0]
    assert by_name["rational"].dist.tolist() == [-0.35, 0.12, 0.0006, -0.0004, 0.02, 0.3, 0.1, 0.02]
    assert by_name["fisheye"].dist.tolist() == [0.02, -0.004, 0.001, 0.0, 0.0]
    assert by_name["fisheye"].K[0, 0] == 640.0 / np.radians(75.0)
    assert {family.name: family.volume for family in OF_SOLVE}["fisheye"] == ROOM
    window = by_name["water"].window
    assert (window.tilt_x_deg, window.thickness_mm, window.behind_index) == (30.0, 10.0, 1.333)


def test_a_volume_between_two_ends_in_them() -> None:
    assert TABLE.towards(ROOM, 0.0) == TABLE
    assert TABLE.towards(ROOM, 1.0) == ROOM
    assert Volume((0.0, 0.0, 0.0), (4.0, 8.0, 2.0)).enlarged(0.25) == Volume(
        (-1.0, -2.0, -0.5), (5.0, 10.0, 2.5)
    )


def test_an_unknown_family_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(InputError, match="Did you mean 'fisheye'"):
        family_by_name("fish-eye")
