"""Views that a shoot could have had instead: the same, but tilted, or spread over the pictures."""

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose
from labcal.geometry.poses import pose
from labcal.guide.diagnosis.support.expected_error import SupportedRig

TILT = np.radians(30.0)
_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))
"""Angle by which directions follow each other so that any number of them is spread evenly."""
_SEEN = 0.9
"""Share of the dots that every camera must see."""
_TRIED = 40
"""Places for each view."""


def tilted_views(poses: list[Pose], middle: np.ndarray) -> list[Pose]:
    """Return views in which the target is where it was, tilted by 30 degrees, each to another side.

    Parameters
    ----------
    poses : list of ndarray, shape (4, 4)
        ``T_world_target``, mm.
    middle : ndarray, shape (3,)
        Of the target's dots in its frame, mm.
    """
    mean = Rotation.from_matrix([T[:3, :3] for T in poses]).mean()
    found = []
    for number, T in enumerate(poses):
        angle = number * _GOLDEN
        tilt = Rotation.from_rotvec(TILT * np.array([np.cos(angle), np.sin(angle), 0.0]))
        roll = Rotation.from_rotvec([0.0, 0.0, 0.5 * np.pi * (number % 2)])
        found.append(_placed((mean * tilt * roll).as_matrix(), T[:3, :3] @ middle + T[:3, 3], middle))
    return found


def spread_views(rig: SupportedRig, poses: list[Pose]) -> list[Pose]:
    """Return views in which the target is turned and as far away as it was, but goes over the whole pictures.

    A view for which no place shows the target to all cameras stays where it is.

    Parameters
    ----------
    rig : SupportedRig
    poses : list of ndarray, shape (4, 4)
        ``T_world_target``, mm.
    """
    middle, first = rig.dots.mean(axis=0), rig.cameras[0]
    found, tried = [], 0
    for T in poses:
        kept = T
        depth = float((first.T_cam_world @ T)[2] @ [*middle, 1.0])
        for _ in range(_TRIED):
            tried += 1
            q = np.array([[_halton(tried, 2), _halton(tried, 3)]]) * first.size
            ray = first.rays(q)
            along = float(ray.direction[0] @ first.T_cam_world[2, :3])
            moved = _placed(T[:3, :3], ray.origin[0] + ray.direction[0] * depth / along, middle)
            if np.isfinite(moved).all() and rig.seen_share(moved) >= _SEEN:
                kept = moved
                break
        found.append(kept)
    return found


def _placed(R: np.ndarray, centre: np.ndarray, middle: np.ndarray) -> Pose:
    return pose(R, centre - R @ middle)


def _halton(number: int, base: int) -> float:
    """Return an element of van der Corput's sequence (Halton 1960), between 0 and 1."""
    share, value = 1.0, 0.0
    while number:
        share /= base
        value += share * (number % base)
        number //= base
    return value
