"""The record of where dots supported a calibration."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels
from labcal.cameras.rig import Rig
from labcal.cameras.support import CalibrationSupport
from labcal.correspond.detections import Detections
from labcal.geometry.hull import hull_vertices
from labcal.geometry.poses import transform
from labcal.targets.catalogue import AnyTarget

_DECIMALS_PX, _DECIMALS_MM = 1, 3


def support_record(
    dots: Detections,
    target: AnyTarget,
    views: tuple[str, ...],
    T_world_target: Float64[np.ndarray, "views 4 4"],
    lenses_of: Rig | None = None,
) -> CalibrationSupport:
    """Return the convex hulls of dots in pictures and in space.

    Parameters
    ----------
    dots : Detections
        Those that entered the calibration.
    target : AnyTarget
    views : tuple of str
    T_world_target : ndarray, shape (views, 4, 4)
        Poses of the target, mm.
    lenses_of : Rig, optional
        The rig from which lenses were kept, whose dots supported them.
    """
    kept = None if lenses_of is None or lenses_of.calibration is None else lenses_of.calibration.support
    pictures = {name: _outline(dots.position[dots.camera == name]) for name in dots.cameras}
    if kept is not None:
        pictures |= kept.pictures_px
    places, poses = target.points(), dict(zip(views, T_world_target, strict=True))
    rows, pitch = dots.index[:, 1] * target.cols + dots.index[:, 0], 10**-_DECIMALS_MM
    held = [transform(T, places[np.unique(rows[dots.view == view])]) for view, T in poses.items()]
    volume = np.concatenate([hull_vertices(p, pitch) for p in held if len(p)] or [np.empty((0, 3))])
    return CalibrationSupport(
        pictures_px=pictures,
        volume_mm=tuple(
            (x, y, z) for x, y, z in np.round(hull_vertices(volume, pitch), _DECIMALS_MM).tolist()
        ),
    )


def _outline(q: Pixels) -> tuple[tuple[float, float], ...]:
    """Return the hull of pixels."""
    hull = np.round(hull_vertices(q, 10**-_DECIMALS_PX), _DECIMALS_PX)
    return tuple((x, y) for x, y in hull.tolist())
