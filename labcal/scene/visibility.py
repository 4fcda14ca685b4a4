"""Visibility of dots: straight lines against solid bodies, without a renderer."""

import numpy as np

from labcal.arrays import Mask, Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import DotImages
from labcal.geometry.poses import inverse, transform
from labcal.scene.furniture import blocks, obstacles
from labcal.scene.lighting import lamp_body
from labcal.scene.model import Scene
from labcal.scene.print import TruePrint
from labcal.scene.solids import Solid

SHARES = (1.0, 0.875, 0.75, 0.625, 0.5, 0.375, 0.25, 0.125, 0.0)
"""Each dot is sampled on its outline and on smaller ones, at these shares of its radius."""


def bodies_between(scene: Scene, T_world_target: Pose) -> tuple[Solid, ...]:
    """Return every solid body that could be between a camera and the front of the target."""
    table, _, _ = blocks(scene, T_world_target)  # plate and support are behind the print
    lamps = (lamp_body(f"lamps.{number}", lamp) for number, lamp in enumerate(scene.lamps))
    return (table, *obstacles(scene, T_world_target), *(body for body in lamps if body is not None))


def turned_away(made: TruePrint, T_world_target: Pose, eyes: Vectors3) -> Mask:
    """Return a mask of dots whose back is visible, or that the bent board itself hides, shape (dots,).

    Parameters
    ----------
    made : TruePrint
    T_world_target : ndarray, shape (4, 4)
        True pose of the target, mm.
    eyes : ndarray, shape (dots, 3)
        Where the paths to the dots begin, world, mm.
    """
    start = transform(inverse(T_world_target), eyes)[:, None, :]
    away = np.zeros(len(eyes), dtype=bool)
    for share in SHARES[:1] if made.surface.bend.is_flat else SHARES:
        away |= made.surface.hides(start, made.flat_outlines(share)).any(axis=-1)
    return away


def hidden_by(solid: Solid, made: TruePrint, T_world_target: Pose, eyes: Vectors3) -> Mask:
    """Return a mask of dots of which a solid body hides any part, shape (dots,).

    The path to every sample of a dot is exact; what is narrower than a tenth of a dot's radius may lie
    between two samples.
    """
    # No path to a dot is farther from the one to its centre than the dot reaches.
    centres = transform(T_world_target, made.centres)
    near = solid.grown(made.reach_mm).meets(eyes, centres).nonzero()[0]
    hidden = np.zeros(len(eyes), dtype=bool)
    for share in SHARES if len(near) else ():
        outlines = made.surface.points(made.flat_outlines(share)[near])
        hidden[near] |= solid.meets(eyes[near][:, None, :], transform(T_world_target, outlines)).any(axis=-1)
    return hidden


def unseen(scene: Scene, made: TruePrint, T_world_target: Pose, eyes: Vectors3) -> Mask:
    """Return a mask of dots that are hidden in part or turned away, shape (dots,)."""
    hidden = turned_away(made, T_world_target, eyes)
    for solid in bodies_between(scene, T_world_target):
        hidden |= hidden_by(solid, made, T_world_target, eyes)
    return hidden


def what_hides(scene: Scene, made: TruePrint, T_world_target: Pose, eye: Vectors3, number: int) -> str | None:
    """Return the name of the body that hides one dot from a viewpoint, or None if nothing does."""
    eyes = np.broadcast_to(eye, (made.target.count, 3))
    for solid in bodies_between(scene, T_world_target):
        if hidden_by(solid, made, T_world_target, eyes)[number]:
            return solid.name
    return "the bend of the board" if turned_away(made, T_world_target, eyes)[number] else None


def viewpoints(camera: Camera, images: DotImages) -> Vectors3:
    """Return the beginning of the line to each dot: the origin of its ray, or the centre of the camera."""
    eyes = np.tile(camera.centre, (len(images.centre), 1))
    rays = camera.rays(images.centroid[images.ok])
    eyes[images.ok] = np.where(rays.ok[:, None], rays.origin, camera.centre)
    return eyes
