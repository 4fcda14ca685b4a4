"""Comparison of two rigs: which cameras belong together, where they are compared, and how."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.cameras.rig import Rig, contradiction_note
from labcal.errors import InputError, UnknownNameError
from labcal.evaluate.comparison.compare_settings import CompareSettings, Pictures
from labcal.evaluate.comparison.lens_difference import CalibratedLens, lens_difference
from labcal.evaluate.comparison.rig_comparison import CameraComparison, RigComparison
from labcal.evaluate.comparison.volume_difference import VolumeDifference, volume_difference
from labcal.geometry.hull import inside_hull
from labcal.wording import listed

_ACROSS = 16
"""Points along each side of the box around a volume."""
_ENOUGH = 100
"""Points that both calibrations supported, from which on only these count."""
_DOWN = (9, 7)
"""Pixels of the first camera whose rays hold the points of a volume that only distances tell."""
_PAIR = 2
_SPACE = 3


def compared(one: Rig, other: Rig, settings: CompareSettings) -> RigComparison:
    """Return the difference of two rigs; as :func:`labcal.pipeline.compare`."""
    names = _names(one, other, settings.cameras or {})
    cameras = []
    for name, second in names.items():
        _require_same_size(one, other, name, second)
        cameras.append(_camera(one, other, (name, second), settings.reach_mm))
    warnings = _doubts(one, other, cameras)
    points = _volume(one, other, names, settings.reach_mm) if len(names) >= _PAIR else None
    volume: VolumeDifference | None = None
    if points is not None:
        volume = volume_difference(one, other, names, points)
    elif len(names) >= _PAIR:
        warnings.append(
            "no rig states where its target was, so that nothing is compared in mm: give `distances_mm`, or "
            "calibrate again"
        )
    pictures = settings.origin
    if pictures is None:
        pictures = _known_by_views(one, other)
    if pictures is None:
        warnings.append(
            "both calibrations name views alike, or none: if they come from the same pictures, their errors "
            "are not independent and the test means nothing; state `pictures='same'` or "
            "`pictures='different'`"
        )
    if pictures is Pictures.SAME:
        warnings.append(
            "calibrations of the same pictures share their errors: differences are smaller than both budgets "
            "tell, and are not tested"
        )
    return RigComparison(tuple(cameras), volume, pictures, tuple(warnings))


def _names(one: Rig, other: Rig, given: Mapping[str, str]) -> dict[str, str]:
    """Return the names of cameras in the second rig by those in the first."""
    for name, second in given.items():
        for which, rig, wanted in (("first", one, name), ("second", other, second)):
            if wanted not in rig.cameras:
                raise UnknownNameError(f"camera in the {which} rig", wanted, rig.cameras)
    names = {name: given.get(name, name) for name in one.cameras}
    if sorted(names.values()) != sorted(other.cameras):
        raise InputError(
            f"The cameras of the rigs are not the same: {listed(one.cameras)} and {listed(other.cameras)}. "
            "Pair names that differ with `cameras`, as in left=cam0,right=cam1; both rigs need equally many."
        )
    return names


def _require_same_size(one: Rig, other: Rig, name: str, second: str) -> None:
    """Raise where pictures of a camera have two sizes: pixels of one are then not those of the other."""
    (a, b), (c, d) = one.cameras[name].size, other.cameras[second].size
    if (a, b) != (c, d):
        raise InputError(
            f"Pictures of camera '{name}' have {a} x {b} pixels in the first rig and {c} x {d} in the other: "
            "no pixel is common to both. Compare calibrations of pictures of one size."
        )


def _camera(
    one: Rig, other: Rig, names: tuple[str, str], distances_mm: tuple[float, ...]
) -> CameraComparison:
    """Return the comparison of one camera."""
    first, second = CalibratedLens.of(one, names[0]), CalibratedLens.of(other, names[1])
    reach = distances_mm or _distances(one, names[0]) or _distances(other, names[1])
    finite = lens_difference(first, second, reach) if reach else None
    parts = [] if finite is None else [finite.at(distance) for distance in reach]
    if not (first.camera.model.parallel or second.camera.model.parallel):
        parts.append(lens_difference(first, second, ()))
    if not parts:
        raise InputError(
            f"Camera '{names[0]}' has parallel rays, which are not compared at infinity, and no rig states "
            "where its target was. Give `distances_mm`."
        )
    return CameraComparison(*names, first, second, tuple(parts), finite)


def _distances(rig: Rig, name: str) -> tuple[float, ...]:
    """Return the least, the median and the largest distance of the target from a camera, mm, if known."""
    volume = _known_volume(rig)
    if volume is None:
        return ()
    away = np.linalg.norm(volume - rig.camera(name).centre, axis=1)
    return tuple(sorted({float(f"{distance:.3g}") for distance in np.quantile(away, [0.0, 0.5, 1.0])}))


def _known_volume(rig: Rig) -> Float64[np.ndarray, "vertices 3"] | None:
    """Return the vertices of the volume where the target was, where they span one."""
    support = None if rig.calibration is None else rig.calibration.support
    if support is None or len(support.volume) <= _SPACE:
        return None
    return support.volume


def _volume(
    one: Rig, other: Rig, names: Mapping[str, str], distances_mm: tuple[float, ...]
) -> Vectors3 | None:
    """Return the points to compare in the first rig's world; None where no volume is known."""
    hull, second = _known_volume(one), None
    if next(iter(other.cameras)) == names[next(iter(one.cameras))]:
        second = _known_volume(other)  # whose world is that of the same camera
    hull = second if hull is None else hull
    if hull is not None:
        axes = [np.linspace(*ends, _ACROSS) for ends in zip(hull.min(axis=0), hull.max(axis=0), strict=True)]
        p = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, _SPACE)
        p = np.concatenate([p[inside_hull(p, hull, 1e-6)], hull])
        common = p if second is None else p[inside_hull(p, second, 1e-6)]
        return np.asarray(common if len(common) >= _ENOUGH else p)
    if not distances_mm:
        return None
    camera = one.camera(next(iter(one.cameras)))
    u, v = (np.linspace(0.0, side - 1.0, n) for side, n in zip(camera.size, _DOWN, strict=True))
    rays = camera.rays(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2))
    p = np.concatenate([rays.origin + distance * rays.direction for distance in distances_mm])
    return np.asarray(p[np.isfinite(p).all(axis=1)])


def _known_by_views(one: Rig, other: Rig) -> Pictures | None:
    """Return the origin of pictures by names of views; None where they leave it open."""
    known = one.calibrated_on and other.calibrated_on
    apart = known and not set(one.calibrated_on) & set(other.calibrated_on)
    return Pictures.DIFFERENT if apart else None


def _doubts(one: Rig, other: Rig, cameras: list[CameraComparison]) -> list[str]:
    """Return warnings of what the comparison does not hold, or holds no longer."""
    found = []
    for which, rig in (("first", one), ("second", other)):
        if rig.covariance is None:
            found.append(
                f"the {which} rig states no covariance of its calibration, so that nothing tells how large a "
                "difference is to be expected. Calibrate again to know"
            )
        note = contradiction_note(rig)
        if note is not None:
            found.append(f"of the {which} rig: {note}")
    apart = [camera.name for camera in cameras if not camera.differences[0].supported]
    if apart:
        found.append(
            f"the dots of both calibrations have hardly any part of the picture of {listed(apart)} in "
            "common: lenses are compared over the whole picture, most of which is extrapolated"
        )
    return found
