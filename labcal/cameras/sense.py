"""Checks that a camera that was read can be one: its figures against those of its picture."""

from collections.abc import Sequence

import numpy as np

from labcal.arrays import Pose
from labcal.bounds import (
    FIELD_MM,
    FOCAL_RATIO,
    FOCAL_SIDES,
    LONGEST_SIDE_PX,
    MOST_DISTORTION,
    MOST_MM,
    MOST_PIXELS,
    MOST_TILT_RAD,
    PRINCIPAL_SIDES,
)
from labcal.cameras.camera import Camera
from labcal.cameras.lens import FISHEYE, LENSES
from labcal.errors import InputError
from labcal.geometry.poses import require_rigid

_POWERS = (2, 4, 1, 1, 6, 2, 4, 6, 1, 3, 1, 3)
"""Of the radius, by which k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 move a point, over the radius."""
_FISHEYE_POWERS = (2, 4, 6, 8)
_TILT = 12
"""Place at which the tilts of the sensor begin in `dist`."""
_MIDDLE = 0.25
"""Of each side, to both sides of the picture's middle, that a lens must image."""
_NODES = 9


def require_sensible_numbers(
    K: Sequence[Sequence[float]], lens: str, dist: Sequence[float], size: tuple[int, int]
) -> None:
    """Raise where intrinsics or coefficients are beyond :mod:`labcal.bounds`, or no such numbers at all.

    Parameters
    ----------
    K : sequence, shape (3, 3)
        Px.
    lens : str
    dist : sequence of float
        In OpenCV's order.
    size : (int, int)
        Width and height of the picture, px.

    Raises
    ------
    InputError
        Says which one.
    """
    width, height = size
    if not (min(size) >= 1 and max(size) <= LONGEST_SIDE_PX and width * height <= MOST_PIXELS):
        raise InputError(
            f"A picture of {width:.6g} x {height:.6g} pixels is none of a camera: sides should be 1 to "
            f"{LONGEST_SIDE_PX}, and there should be at most {MOST_PIXELS // 1_000_000} megapixels."
        )
    if not (np.isfinite(K).all() and np.isfinite(dist).all()):
        raise InputError("K and dist must hold finite numbers.")
    (fx, _, cx), (_, fy, cy) = K[0], K[1]
    side, parallel = float(max(size)), _is_parallel(lens)
    what, unit = ("scale", "px/mm") if parallel else ("focal length", "px")
    shares = (1.0 / FIELD_MM[1], 1.0 / FIELD_MM[0]) if parallel else FOCAL_SIDES
    least, most = (share * side for share in shares)
    for name, focal in (("fx", fx), ("fy", fy)):
        if not least <= focal <= most:
            raise InputError(
                f"The {what} {name} is {focal:.6g} {unit}, but should be {least:g} to {most:g} {unit} for a "
                f"picture of {width} x {height}."
            )
    if not max(fx, fy) <= FOCAL_RATIO * min(fx, fy):
        raise InputError(
            f"The {what}s {fx:.6g} and {fy:.6g} {unit} differ by more than a factor of {FOCAL_RATIO:g}."
        )
    farthest = max(abs(cx - 0.5 * (width - 1)), abs(cy - 0.5 * (height - 1)))
    if not farthest <= PRINCIPAL_SIDES * side:
        raise InputError(
            f"The principal point ({cx:.6g}, {cy:.6g}) px is more than {PRINCIPAL_SIDES:g} times the longer "
            f"side away from the middle of a picture of {width} x {height}."
        )
    x, y = max(abs(cx), abs(width - 1 - cx)) / fx, max(abs(cy), abs(height - 1 - cy)) / fy
    reach = max(float(np.hypot(x, y)), 1e-9)
    _require_coefficients(lens, dist, reach if parallel else min(1.0, reach))


def _is_parallel(lens: str) -> bool:
    """Return whether a lens has parallel rays; a prescription or an unknown one, which others refuse, no."""
    return lens in LENSES and LENSES[lens].parallel


def _require_coefficients(lens: str, dist: Sequence[float], reach: float) -> None:
    """Raise where a coefficient moves points at a radius by many times that radius."""
    ranges = LENSES[lens].ranges if lens in LENSES else None
    if ranges is not None:
        _require_in_ranges(LENSES[lens].names, dist, ranges)
        return
    powers = _FISHEYE_POWERS if lens == FISHEYE else _POWERS
    for number, (value, power) in enumerate(zip(dist, powers, strict=False)):
        most = MOST_DISTORTION / reach**power
        if not abs(value) <= most:
            raise InputError(
                f"The lens coefficient dist[{number}] is {value:.6g}, but beyond {most:.3g} it would move "
                f"points at the picture's rim by more than {MOST_DISTORTION:g} times their radius."
            )
    if any(not abs(tilt) <= MOST_TILT_RAD for tilt in dist[_TILT:]):
        raise InputError(f"The sensor's tilts (dist[12], dist[13]) should be within {MOST_TILT_RAD} rad.")


def _require_in_ranges(
    names: Sequence[str], dist: Sequence[float], ranges: Sequence[tuple[float, float]]
) -> None:
    """Raise where a coefficient is none that makes sense."""
    for number, (name, value, (least, most)) in enumerate(zip(names, dist, ranges, strict=False)):
        if not least <= value <= most:
            raise InputError(
                f"The lens coefficient dist[{number}] ({name}) is {value:.6g}, but should be {least:g} to "
                f"{most:g}."
            )


def require_placed(T_ab: Pose, what: str) -> None:
    """Raise unless a pose is rigid, and not farther away than anything is.

    Raises
    ------
    InputError
        It is no rotation and translation, or the translation is too long.
    """
    require_rigid(T_ab, what)
    if np.abs(T_ab[:3, 3]).max() > MOST_MM:
        raise InputError(f"{what} moves by more than {MOST_MM:g} mm.")


def require_middle_seen(camera: Camera, name: str) -> None:
    """Raise where the lens images nothing in the middle half of the picture, so that it is none.

    A lens may fold, or end, towards the corners: it is then one that pictures can still be measured with.

    Raises
    ------
    InputError
        A pixel on a lattice there has no ray.
    """
    width, height = camera.size
    share = np.linspace(0.5 - _MIDDLE, 0.5 + _MIDDLE, _NODES)
    u, v = np.meshgrid(share * (width - 1), share * (height - 1))
    q = np.stack([u.ravel(), v.ravel()], axis=-1)
    lost = ~camera.rays(q).ok
    if lost.any():
        at = q[lost][0]
        raise InputError(
            f"The lens of camera '{name}' ({camera.lens}) sees no direction at pixel ({at[0]:.1f}, "
            f"{at[1]:.1f}), in the middle of its picture. The file is damaged, or its coefficients "
            "are those of another lens model."
        )
