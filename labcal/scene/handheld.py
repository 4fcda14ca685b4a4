"""Poses of a hand-held target: random ones, of which those that cover pictures and angles are chosen."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64
from scipy.spatial.transform import Rotation

from labcal.arrays import Mask, Pixels, Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import flat_outlines
from labcal.errors import InputError
from labcal.geometry.poses import pose, transform
from labcal.rng import generator
from labcal.scene.model import Scene
from labcal.scene.placement import Handheld
from labcal.scene.printed import key_indices
from labcal.targets.target import PrintableTarget

TRIES_PER_VIEW = 100
CANDIDATES_PER_VIEW = 6
"""Poses that every camera sees well enough, of which the one that adds most is chosen."""
CELLS = (8, 6)
"""A picture's width and height in cells."""
DIRECTIONS = 8
"""Sectors of the direction into which the target is tilted."""
SIZES = 2
"""Classes of how far it is tilted, equally likely to be drawn."""
SLANTS = DIRECTIONS * SIZES
EVERY = 4
"""Of the points of an outline, one in so many is looked at."""


@dataclass(frozen=True)
class Candidate:
    """A pose at which every camera sees enough of the target, and the cells that it covers."""

    T_world_target: Pose
    covers: tuple[np.ndarray, ...]
    """By camera, which cells of its picture show a dot; last, the class of the tilt. Boolean."""


@dataclass(frozen=True)
class Shape:
    """Points of a target, mm."""

    centres: Vectors3
    """(n, 3), of all dots."""
    dots: Float64[np.ndarray, "n few 3"]
    """On the outlines of all dots."""
    key: Float64[np.ndarray, "key many 3"]
    """On the outlines of the rings, of which nothing may be missed; of all dots of a grid without rings;
    of the corners that number a chessboard."""

    @classmethod
    def of(cls, target: PrintableTarget) -> "Shape":
        """Return the shape of a target."""
        outlines = flat_outlines(target.points(), 0.5 * target.outer_diameters_mm())
        key = np.array([row * target.cols + col for col, row in key_indices(target)], dtype=np.int64)
        return cls(target.points(), outlines[:, ::EVERY], outlines[key])


def handheld_poses(scene: Scene, seed: int) -> list[Pose]:
    """Return ``T_world_target`` (mm) of every view of a scene with a hand-held target.

    Candidates are drawn with places spread evenly over the scene's box and tilts over the disc of allowed
    ones. Those that every camera sees well enough are taken in the order in which they add most to what is
    covered: cells of each camera's picture, and directions and sizes of tilts. Views to test on cover
    everything once more.

    Raises
    ------
    InputError
        The scene's target is not hand-held, or too few poses pass.
    """
    placement = scene.placement
    if not isinstance(placement, Handheld):
        raise InputError(f"The target of the scene '{scene.name}' is not hand-held.")
    candidates = _candidates(scene, placement, seed)
    wanted = placement.train + placement.test
    if len(candidates) < wanted:
        raise InputError(
            f"Only {len(candidates)} of {wanted} hand-held poses of the scene '{scene.name}' show enough of "
            "the target to all cameras. Move placement.centre_mm away from the cameras, or lessen spread_mm, "
            "tilt_max_deg or visible_share; with all_rings: false the rings, or all of a plain grid or "
            "chessboard, need not be seen."
        )
    chosen = []
    for count in (placement.train, placement.test):
        best = _most_covering(candidates, count)
        chosen += [candidates[number].T_world_target for number in best]
        candidates = [candidate for number, candidate in enumerate(candidates) if number not in best]
    return chosen


def _candidates(scene: Scene, placement: Handheld, seed: int) -> list[Candidate]:
    """Draw poses until every camera sees enough poses well, or the number of tries is reached."""
    cameras = list(scene.true_cameras().values())
    eyes = np.mean([camera.centre for camera in cameras], axis=0)
    right = cameras[0].T_cam_world[0, :3].copy()
    shape = Shape.of(scene.target)
    random = generator(seed, "hand-held poses")
    wanted = placement.train + placement.test
    found: list[Candidate] = []
    for _ in range(TRIES_PER_VIEW * wanted):
        if len(found) == CANDIDATES_PER_VIEW * wanted:
            break
        T_world_target, slant = _draw(placement, shape, (eyes, right), random)
        covers = []
        for camera in cameras:
            centres = _seen(camera, T_world_target, shape, placement)
            if centres is None:
                break
            covers.append(_cells(camera, centres))
        else:
            found.append(Candidate(T_world_target, (*covers, slant)))
    return found


def _draw(
    placement: Handheld,
    shape: Shape,
    viewer: tuple[np.ndarray, np.ndarray],
    random: np.random.Generator,
) -> tuple[Pose, Bool[np.ndarray, "slants"]]:
    """Draw one pose about the line to the cameras, and return it with the class of its tilt.

    `viewer` is the middle of the cameras and the direction to the right of the pictures.
    """
    eyes, right = viewer
    middle = np.array(placement.centre_mm) + np.array(placement.spread_mm) * random.uniform(-1.0, 1.0, 3)
    towards = (eyes - middle) / np.linalg.norm(eyes - middle)
    x = right - (right @ towards) * towards
    x /= np.linalg.norm(x)
    facing = np.stack([x, np.cross(towards, x), towards], axis=1)
    share = random.uniform()  # of the disc of tilts, within this tilt
    tilt = np.radians(placement.tilt_max_deg) * np.sqrt(share)
    azimuth = random.uniform()
    roll = np.radians(placement.roll_max_deg) * random.uniform(-1.0, 1.0)
    axis = np.array([np.cos(2.0 * np.pi * azimuth), np.sin(2.0 * np.pi * azimuth), 0.0])
    tilted = Rotation.from_rotvec(tilt * axis)
    R_world_target = facing @ tilted.as_matrix() @ Rotation.from_rotvec([0.0, 0.0, roll]).as_matrix()
    slant = int(azimuth * DIRECTIONS) * SIZES + int(share * SIZES)
    T_world_target = pose(R_world_target, middle - R_world_target @ shape.centres.mean(axis=0))
    return T_world_target, np.arange(SLANTS) == slant


def _seen(camera: Camera, T_world_target: Pose, shape: Shape, placement: Handheld) -> Pixels | None:
    """Return the centres of the dots that the camera sees whole; nothing where these are not enough."""
    if float(camera.towards(T_world_target[:3, 3]) @ T_world_target[:3, 2]) <= 0.0:
        return None
    if placement.all_rings and not _inside(camera, T_world_target, shape.key).all():
        return None
    visible = _inside(camera, T_world_target, shape.dots).all(axis=-1)
    if visible.mean() < placement.visible_share:
        return None
    return np.asarray(camera.project(transform(T_world_target, shape.centres[visible])).q)


def _inside(camera: Camera, T_world_target: Pose, p: Vectors3) -> Mask:
    """Return a mask of the points of the target that are inside the picture."""
    return camera.in_picture(camera.project(transform(T_world_target, p)).q)


def _cells(camera: Camera, q: Pixels) -> Bool[np.ndarray, "cells"]:
    """Return a mask of the cells of the camera's picture that contain one of the pixels."""
    col, row = ((q + 0.5) / np.array(camera.size) * CELLS).astype(int).T
    covered = np.zeros(CELLS, dtype=bool)
    covered[np.clip(col, 0, CELLS[0] - 1), np.clip(row, 0, CELLS[1] - 1)] = True
    return covered.ravel()


def _most_covering(candidates: list[Candidate], count: int) -> list[int]:
    """Return indices of candidates, each the one that adds most coverage to those before it.

    Covering what is covered n times already counts 1 / (n + 1)^2, so that what is not covered yet counts
    most. Each picture and the tilts weigh the same. Of equals the first one is taken.
    """
    pictures = [
        np.stack(parts) for parts in zip(*(candidate.covers for candidate in candidates), strict=True)
    ]
    covers = np.concatenate(pictures, axis=1)
    weight = np.concatenate([np.full(part.shape[1], 1.0 / part.shape[1]) for part in pictures])
    times = np.zeros(covers.shape[1])
    chosen: list[int] = []
    for _ in range(count):
        gain = covers @ (weight / (1.0 + times) ** 2)
        gain[chosen] = -1.0
        chosen.append(int(np.argmax(gain)))
        times += covers[chosen[-1]]
    return chosen
