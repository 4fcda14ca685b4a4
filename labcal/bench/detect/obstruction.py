"""Bodies in front of a board that hide about the designed share of its dots."""

import numpy as np

from labcal.arrays import Mask, Pose
from labcal.bench.detect.design import PictureDesign
from labcal.cameras.camera import Camera
from labcal.geometry.poses import transform
from labcal.scene.furniture import solid_body
from labcal.scene.occluders import Box, Frame, Occluder
from labcal.targets.grid import DotGrid

CANDIDATES = 300
FINGERS = 0.3
"""Share of candidates that reach across the board, as a finger or a cable; the rest are hands and books."""
RINGS_COST = 1.0
"""A hidden ring is as bad as all dots hidden that should not be."""
HEIGHT_OVER_RADIUS = (0.5, 2.0)
REFLECTANCE = (0.03, 0.9)


def obstruction(
    design: PictureDesign, target: DotGrid, staging: tuple[Camera, Pose], random: np.random.Generator
) -> tuple[Occluder, ...]:
    """Return one or two bodies that hide about ``design.hidden`` of the dots.

    Of many drawn bodies, those that come nearest are chosen.

    Parameters
    ----------
    design : PictureDesign
    target : DotGrid
    staging : (Camera, Pose)
        Who looks, and ``T_world_target``.
    random : numpy.random.Generator
    """
    rings = np.zeros(target.count, dtype=bool)
    for col, row in target.ring_indices:
        rings[row * target.cols + col] = True
    best: tuple[Occluder, ...] = ()
    least = np.inf
    for _ in range(CANDIDATES):
        bodies = tuple(_body(target, random) for _ in range(random.integers(1, 3)))
        hidden = _hidden(bodies, staging, target)
        cost = abs(float(hidden.mean()) - design.hidden)
        cost += RINGS_COST * (design.rings_in_sight == bool((hidden & rings).any()))
        if cost < least:
            best, least = bodies, cost
    return best


def _hidden(bodies: tuple[Occluder, ...], staging: tuple[Camera, Pose], target: DotGrid) -> Mask:
    """Return an approximate mask of dots of which a body hides any part."""
    camera, T_world_target = staging
    points = transform(T_world_target, target.points())
    eyes = np.broadcast_to(camera.centre, points.shape)
    hidden = np.zeros(len(points), dtype=bool)
    for body in bodies:
        grown = solid_body("body", body, T_world_target).grown(0.5 * target.dot_diameter_mm)
        hidden |= grown.meets(eyes, points)
    return hidden


def _body(target: DotGrid, random: np.random.Generator) -> Box:
    """Draw a box on the board or close before it.

    Bodies with round sides take the renderer ten times as long.
    """
    x_min, y_min, x_max, y_max = target.extent_mm
    width, height = x_max - x_min, y_max - y_min
    radius = 0.5 * target.dot_diameter_mm
    x, y = random.uniform(x_min, x_max), random.uniform(y_min, y_max)
    above = radius * random.uniform(*HEIGHT_OVER_RADIUS)
    sides = np.sqrt(width * height) * random.uniform(0.05, 1.0, 2)
    if random.uniform() < FINGERS:
        sides = np.array([2.0 * np.hypot(width, height), radius * random.uniform(0.6, 4.0)])
    return Box(
        kind="box",
        frame=Frame.TARGET,
        centre_mm=(x, y, above),
        size_mm=(float(sides[0]), float(sides[1]), radius),
        turn_deg=(0.0, 0.0, float(random.uniform(-90.0, 90.0))),
        reflectance=(float(random.uniform(*REFLECTANCE)),) * 3,
    )
