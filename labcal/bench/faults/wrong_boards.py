"""Boards and stages that are not what the methods are told: other places of the dots, exact cameras."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from labcal.bench.faults.planned_planes import PlannedPlanes
from labcal.geometry.poses import pose
from labcal.rng import generator
from labcal.scene.board import Bend
from labcal.scene.surface import Surface

_STREAM = "bench faults"
ExactPixels = Float64[np.ndarray, "n 2 2"]


def other_pitch(planes: PlannedPlanes, excess: float) -> ExactPixels:
    """Return the pixels of dots that are further apart than declared; dot (0, 0) is in its place.

    All distances on the board are ``1 + excess`` times the declared ones, those between the planes are as
    declared: they are the stage's. The laboratory's mistake `wrong-pitch` of the size 1 is an excess of 0.03.
    """
    return planes.images((1.0 + excess) * planes.dots, planes.takes)


def bent(planes: PlannedPlanes, sag_mm: float) -> ExactPixels:
    """Return the pixels of a board that is a shallow cylinder about y, tangent to the plane in its middle.

    The outermost columns of dots stand `sag_mm` nearer to the viewer than the middle. The formula is the
    laboratory's (`labcal.scene.board.Bend`), which lifts dots straight up.
    """
    surface = Surface(planes.middle, planes.half, Bend(along_x_mm=sag_mm))
    return planes.images(surface.points(planes.dots[:, :2]), planes.takes)


def misprinted(planes: PlannedPlanes, sigma_mm: float) -> ExactPixels:
    """Return the pixels of dots that are off by normal errors along x and y, the same on every plane."""
    draws = generator(planes.seed, "misplaced dots").standard_normal((len(planes.dots), 2))
    dots = planes.dots.copy()
    dots[:, :2] += sigma_mm * draws
    return planes.images(dots, planes.takes)


def misread(planes: PlannedPlanes, sigma_mm: float) -> ExactPixels:
    """Return the pixels of a board that stands off the stage's reading, by normal errors along x, y and z.

    Both cameras see it at the same place, which differs from view to view.
    """
    takes = []
    for take in planes.takes:
        off = sigma_mm * generator(planes.seed, _STREAM, "stage", take.view).standard_normal(3)
        moved = pose(np.eye(3), off) @ take.track.T_world_target
        track = replace(take.track, T_world_target=moved, middle=take.track.middle + off)
        takes.append(replace(take, track=track))
    return planes.images(planes.dots, takes)
