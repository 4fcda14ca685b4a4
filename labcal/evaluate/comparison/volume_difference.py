"""The difference of two rigs over a volume, mm: points of the same pixels, after a motion of the world."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import KnownCamera, noise_covariance, triangulate
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.errors import InputError
from labcal.evaluate.comparison.without_motion import MotionRemover, RemainingDifference, Uncertain
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.poses import from_rotation_vector, pose, rigid_alignment, transform

_PIXEL_PX = 0.01
"""Noise of the pixels that weigh the directions of points, along each axis: less than cameras see."""
_UNSEEN = 1e8
"""Factor of the variance of a pixel outside of its picture, which then counts for nothing."""
_CONDITION = 1e10
"""Of a point's covariance, beyond which its most certain directions count as less certain."""
_FEWEST = 10
_STEPS = 10
_ARRIVED_MM = 1e-9


@dataclass(frozen=True)
class VolumeDifference:
    """The difference of two rigs over a volume.

    Attributes
    ----------
    point : float64 array, (n, 3)
        By the first rig, in its world, mm.
    remaining : RemainingDifference
        Mm, second minus first, in the first rig's world.
    T_one_other : float64 array, (4, 4)
        The implied motion: the second rig's world to the first one's.
    motion_sigma : float64 array, (6,)
        Standard deviations of its rotations, rad, and of the place of the volume's centre, mm, along the axes
        of the first rig's world; NaN where a rig states no covariance.
    """

    point: Vectors3
    remaining: RemainingDifference
    T_one_other: Pose
    motion_sigma: Float64[np.ndarray, "6"]


def volume_difference(one: Rig, other: Rig, names: Mapping[str, str], p: Vectors3) -> VolumeDifference:
    """Return the displacement of points that both rigs triangulate from the same pixels.

    Parameters
    ----------
    one, other : Rig
    names : mapping of str to str
        Names of the cameras in the first rig, and in the second.
    p : ndarray, shape (n, 3)
        Points of the first rig's world, mm. Those that fewer than two cameras have in their pictures do not
        count.

    Raises
    ------
    InputError
        Too few points are in the pictures of two cameras or more.

    Notes
    -----
    The motion minimises the displacements, weighted by the inverse of what both budgets expect of them. A
    displacement's covariance is that of both calibrations, carried to the points at fixed pixels, with the
    share removed that the motion takes away.
    """
    order = [(name, names[name]) for name in one.cameras]
    first = [one.camera(name) for name, _ in order]
    second = [other.camera(name) for _, name in order]
    q = np.stack([camera.project(p).q for camera in first], axis=1)
    inside = np.stack([camera.in_picture(q[:, number]) for number, camera in enumerate(first)], axis=1)
    enough = np.isfinite(q).all(axis=(1, 2)) & (inside.sum(axis=1) >= 2)  # noqa: PLR2004 -- rays meet
    p, q, inside = p[enough], q[enough], inside[enough]
    variance = _PIXEL_PX**2 * np.where(inside, 1.0, _UNSEEN)
    pixels = variance[..., None, None] * np.eye(2)
    found = triangulate(second, q, pixels) if len(p) else None
    if found is None or int(found.ok.sum()) < _FEWEST:
        met = 0 if found is None else int(found.ok.sum())
        raise InputError(
            f"Only {met} of {len(enough)} points of the volume are in the pictures of two cameras: the rigs "
            "cannot be compared there. Name `distances_mm` at which the cameras' fields of view overlap."
        )
    p, q, pixels, there = p[found.ok], q[found.ok], pixels[found.ok], found.point[found.ok]
    by_one = _uncertain(one, tuple(first), p, pixels, np.arange(len(first)))
    # The second rig's parameters are in the order of its own cameras.
    own = [list(other.cameras).index(name) for _, name in order]
    back = np.argsort(own)
    by_other = _uncertain(other, tuple(second[number] for number in back), there, pixels, back)
    return _after_motion(p, there, (by_one, by_other), noise_covariance(
        [KnownCamera(camera) for camera in first], p, pixels, 0.0
    ))  # fmt: skip


def _uncertain(
    rig: Rig, cameras: tuple[Camera, ...], p: Vectors3, pixels: np.ndarray, order: np.ndarray
) -> Uncertain | None:
    """Return the derivatives of a rig's points by its parameters, where their covariance is known."""
    if rig.covariance is None:
        return None
    return Uncertain(triangulation_derivatives(cameras, p, pixels[:, order]), rig.covariance.matrix)


def _after_motion(
    p: Vectors3,
    there: Vectors3,
    uncertain: tuple[Uncertain | None, Uncertain | None],
    noise: Float64[np.ndarray, "n 3 3"],
) -> VolumeDifference:
    """Return the difference of points, first and second, after the motion that explains it best."""
    T, everywhere, centre = rigid_alignment(p, there), np.ones(len(p), dtype=bool), p.mean(axis=0)
    one, other = uncertain
    expected = noise.copy()
    if one is not None and other is not None:
        R = T[:3, :3]
        expected += one.blocks() + R @ other.blocks() @ R.T
    weight = _inverse(expected)
    for _ in range(_STEPS):
        moved = transform(T, there)
        turned = -cross_matrices(moved - centre)
        shift = np.broadcast_to(np.eye(3), turned.shape)
        remover = MotionRemover(np.concatenate([turned, shift], axis=2), weight, everywhere)
        step = -remover.motion(moved - p)
        turn = from_rotation_vector(step[:3], np.zeros(3))[:3, :3]
        T = pose(turn, centre + step[3:] - turn @ centre) @ T
        if float(np.abs(remover.design @ step).max()) < _ARRIVED_MM:
            break
    carried = [
        None if one is None else Uncertain(-one.by, one.covariance),
        None if other is None else Uncertain(T[:3, :3] @ other.by, other.covariance),
    ]
    sigma = np.full(6, np.nan)
    if None not in carried:
        parts = [(remover.motion(u.by), u.covariance) for u in carried if u is not None]
        sigma = np.sqrt(np.maximum(sum(np.diagonal(by @ C @ by.T) for by, C in parts), 0.0))
    left = [None if u is None else Uncertain(remover.left(u.by), u.covariance) for u in carried]
    difference = transform(T, there) - p
    remaining = RemainingDifference(difference, left[0], left[1], weight, everywhere)
    return VolumeDifference(p, remaining, T, np.asarray(sigma))


def _inverse(expected: Float64[np.ndarray, "n 3 3"]) -> Float64[np.ndarray, "n 3 3"]:
    """Return inverse covariances; of what is left open in a direction, those of a bounded condition."""
    variance, axes = np.linalg.eigh(expected)
    variance = np.maximum(variance, variance[:, -1:] / _CONDITION)
    return np.asarray((axes / variance[:, None, :]) @ axes.transpose(0, 2, 1))
