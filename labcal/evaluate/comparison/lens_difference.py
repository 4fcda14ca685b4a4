"""The difference of two lenses over the picture, px, after the motion of the camera that explains it best."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Pixels, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import point_derivatives, projection_derivatives
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.evaluate.comparison.without_motion import MotionRemover, RemainingDifference, Uncertain
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.hull import inside_hull
from labcal.geometry.poses import from_rotation_vector, transform

LATTICE = (33, 25)
"""Pixels over a picture, across and down."""
_FAR = 1e7
"""Distance that stands for infinity, in units of the largest other one, or mm."""
_STEPS = 20
_ARRIVED_PX = 1e-7
_FEWEST = 20
"""Pixels where both calibrations were supported, from which on these alone determine the motion."""
_FLOOR_PX = 0.01
"""Difference that is added to what is expected, so that weights stay finite."""


@dataclass(frozen=True)
class CalibratedLens:
    """A camera in its own frame, with what is known of its lens.

    Attributes
    ----------
    camera : Camera
    covariance : float64 array, (parameters, parameters), or None
        Of fx, fy, cx, cy and the coefficients, board poses marginalised out.
    outline : float64 array, (vertices, 2)
        Hull of the dots that it was calibrated from, px; without vertices where that is not known.
    """

    camera: Camera
    covariance: Float64[np.ndarray, "parameters parameters"] | None
    outline: Float64[np.ndarray, "vertices 2"]

    @classmethod
    def of(cls, rig: Rig, name: str) -> "CalibratedLens":
        """Return the lens of a camera of a rig."""
        camera = in_own_frame(rig.camera(name))
        covariance = None
        if rig.covariance is not None:
            free = 4 + camera.model.coefficients
            first = rig.covariance.parameters.index(f"{name}.fx")
            covariance = rig.covariance.matrix[first : first + free, first : first + free]
        support = None if rig.calibration is None else rig.calibration.support
        return cls(camera, covariance, np.empty((0, 2)) if support is None else support.outline(name))

    def supports(self, q: Pixels) -> Mask:
        """Return a mask of pixels where dots were; all where that is not known."""
        if len(self.outline) < 3:  # noqa: PLR2004 -- a triangle
            return np.ones(len(q), dtype=bool)
        flat = np.zeros((max(len(q), len(self.outline)), 1))
        at, hull = (np.hstack([p, flat[: len(p)]]) for p in (q, self.outline))
        return inside_hull(at, hull, 0.5)


def in_own_frame(camera: Camera) -> Camera:
    """Return a camera in its own frame."""
    return Camera(
        camera.K, camera.lens, camera.dist, np.eye(4), camera.size, camera.prescription, camera.window
    )


@dataclass(frozen=True)
class LensDifference:
    """The difference of two lenses over the picture at some distances, or at infinity.

    Attributes
    ----------
    q : float64 array, (n, 2)
        Pixels of the first camera.
    distance_mm : float64 array, (n,)
        From the camera along the ray; infinite.
    remaining : RemainingDifference
        Px, second minus first; tested where both calibrations were supported.
    supported : bool
        False where too few pixels had dots in both calibrations, so that the whole picture counts.
    """

    q: Pixels
    distance_mm: Float64[np.ndarray, " n"]
    remaining: RemainingDifference
    supported: bool

    def at(self, distance_mm: float) -> "LensDifference":
        """Return the part of one distance."""
        rows = self.distance_mm == distance_mm
        r = self.remaining
        one, other = (None if u is None else Uncertain(u.by[rows], u.covariance) for u in (r.one, r.other))
        part = RemainingDifference(r.difference[rows], one, other, r.weight[rows], r.tested[rows])
        return LensDifference(self.q[rows], self.distance_mm[rows], part, self.supported)


def lens_difference(
    one: CalibratedLens, other: CalibratedLens, distances_mm: tuple[float, ...]
) -> LensDifference:
    """Return the difference of two lenses after the motion of the camera that explains most of it.

    Parameters
    ----------
    one, other : CalibratedLens
        With pictures of one size; lens models may differ.
    distances_mm : tuple of float
        From the camera along its rays. Without any the lenses are compared at infinity, where a motion is a
        rotation alone.

    Returns
    -------
    LensDifference

    Raises
    ------
    InputError
        Fewer than :data:`_FEWEST` pixels are imaged by both.

    Notes
    -----
    A pixel of the first camera is a ray; a point on it, moved by the implied motion, is projected by the
    second camera. The motion minimises the weighted differences over the pixels where both calibrations were
    supported, as mrcal's projection diff does.
    """
    base = _lattice(one.camera.size)
    far = not distances_mm
    reach = (_FAR,) if far else distances_mm
    rays = one.camera.rays(base)
    origin = np.zeros_like(rays.origin) if far else rays.origin
    p = np.concatenate([origin + distance * rays.direction for distance in reach])
    q = np.tile(base, (len(reach), 1))
    shown = np.repeat([np.inf] if far else reach, len(base))
    both = np.tile(one.supports(base) & other.supports(base) & rays.ok, len(reach))
    supported = int(both.sum()) >= _FEWEST
    fit, T = both if supported else np.isfinite(p).all(axis=1), np.eye(4)
    for _ in range(_STEPS):
        found = _Imaged.of(other.camera, p, T, far=far)
        seen = fit & found.ok
        if int(seen.sum()) < _FEWEST:
            raise InputError("The lenses have too few directions in common: they are of different cameras.")
        uncertain = _uncertain(one, other, p, found)
        remover = MotionRemover(found.design, _weight(uncertain, len(p)), seen)
        difference = np.where(found.ok[:, None], found.q - q, np.nan)
        step = -remover.motion(np.nan_to_num(difference))
        shift = np.zeros(3) if far else step[3:]
        T = from_rotation_vector(step[:3], shift) @ T
        if float(np.abs(found.design[seen] @ step).max()) < _ARRIVED_PX:
            break
    shares = [None if u is None else Uncertain(remover.left(u.by), u.covariance) for u in uncertain]
    weight = remover.weight
    return LensDifference(
        q, shown, RemainingDifference(difference, shares[0], shares[1], weight, seen), supported
    )


@dataclass(frozen=True)
class _Imaged:
    """Points as the second camera images them after a motion."""

    p: Vectors3
    q: Pixels
    ok: Mask
    by_point: Float64[np.ndarray, "n 2 3"]
    design: Float64[np.ndarray, "n 2 motion"]
    R: Float64[np.ndarray, "3 3"]

    @classmethod
    def of(cls, camera: Camera, p: Vectors3, T: Float64[np.ndarray, "4 4"], *, far: bool) -> "_Imaged":
        """Project points, with the derivatives by a further motion."""
        moved = transform(T, p)
        known = np.isfinite(moved).all(axis=1)
        moved[~known] = [0.0, 0.0, 1.0]
        found = point_derivatives(camera, moved)
        ok = known & found.ok & np.isfinite(found.q).all(axis=1)
        by_point = np.where(ok[:, None, None], found.by_point, 0.0)
        turned = -by_point @ cross_matrices(moved)
        design = turned if far else np.concatenate([turned, by_point], axis=2)
        return cls(moved, found.q, ok, by_point, design, T[:3, :3])


def _uncertain(
    one: CalibratedLens, other: CalibratedLens, p: Vectors3, found: _Imaged
) -> tuple[Uncertain | None, Uncertain | None]:
    """Return the derivatives of differences by both lenses, where their covariances are known."""
    rows, first, second = found.ok, None, None
    if one.covariance is not None:
        of_one = projection_derivatives(one.camera, np.where(rows[:, None], p, [0.0, 0.0, 1.0]))
        # With its pixel fixed, a point moves across its ray against the change of its image.
        across = found.by_point @ found.R @ np.linalg.pinv(of_one.by_point)
        first = Uncertain(_where(rows, -across @ of_one.by_camera), one.covariance)
    if other.covariance is not None:
        by = projection_derivatives(other.camera, found.p).by_camera
        second = Uncertain(_where(rows, by), other.covariance)
    return first, second


def _where(rows: Mask, by: Float64[np.ndarray, "n 2 parameters"]) -> Float64[np.ndarray, "n 2 parameters"]:
    return np.where(rows[:, None, None], by, 0.0)


def _weight(uncertain: tuple[Uncertain | None, Uncertain | None], n: int) -> Float64[np.ndarray, "n 2 2"]:
    """Return the inverse of what both budgets expect of each difference along an axis."""
    variance = np.full(n, _FLOOR_PX**2)
    if None not in uncertain:
        variance += sum(np.trace(u.blocks(), axis1=1, axis2=2) / 2.0 for u in uncertain if u is not None)
    return np.asarray(np.eye(2) / variance[:, None, None])


def _lattice(size: tuple[int, int]) -> Pixels:
    """Return pixels over the whole picture, up to its edges."""
    u, v = (np.linspace(0.0, side - 1.0, count) for side, count in zip(size, LATTICE, strict=True))
    return np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
