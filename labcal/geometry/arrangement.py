"""Arrangements of training points from which a method cannot learn, refused by name."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels
from labcal.errors import InputError
from labcal.wording import counted

FLAT = 1e-9
"""An extent below this fraction of the largest one counts as none: nominal places are exact to rounding."""


def refuse_few(method: str, points: Float64[np.ndarray, "n dim"], needed: int) -> None:
    """Raise where there are fewer different points than unknowns.

    Raises
    ------
    InputError
        There are fewer than `needed`, or some more than once.
    """
    given, different = len(points), len(np.unique(points, axis=0))
    if different < needed:
        were = "was" if given == 1 else "were"
        again = "" if different == given else f", only {different} of them different"
        raise InputError(
            f"{method}: {counted(given, 'point')} {were} given{again}, but at least {needed} are needed for "
            f"its unknowns. Train on more dots or more views. (n_samples = {given})"
        )


def camera_count(method: str, columns: int) -> int:
    """Return the number of cameras of a matrix of pixels: half the number of its columns.

    Raises
    ------
    InputError
        The number of columns is odd.
    """
    if columns % 2:
        raise InputError(
            f"{method}: X has {counted(columns, 'column')}, but needs two a camera: x1 y1 x2 y2 ... in "
            f"pixels. Reshape your data so that every camera has both."
        )
    return columns // 2


def refuse_other_than_points(method: str, outputs: int) -> None:
    """Raise where Y holds anything but points in space.

    Raises
    ------
    InputError
        Y has not three columns.
    """
    if outputs != 3:  # noqa: PLR2004 - X, Y, Z
        raise InputError(f"{method}: Y has {counted(outputs, 'column')}, but needs three: X Y Z in mm.")


def extents(points: Float64[np.ndarray, "n dim"]) -> Float64[np.ndarray, " dim"]:
    """Return the extents of points along their principal directions, the largest first, in their own unit."""
    return np.linalg.svd(points - points.mean(axis=0), compute_uv=False)


def refuse_collinear(method: str, points: Float64[np.ndarray, "n dim"]) -> None:
    """Raise where all points lie on one line, or in one place.

    Raises
    ------
    InputError
        The second extent is negligible compared with the first.
    """
    first, second = extents(points)[:2]
    if second <= FLAT * first or first == 0:
        raise InputError(
            f"{method}: all {len(points)} dots lie on one line, which leaves the other directions "
            f"undetermined. Train on dots of several rows and columns."
        )


def on_one_plane(points: Float64[np.ndarray, "n 3"]) -> bool:
    """Return whether all points lie on one plane, on one line or in one place."""
    singular = extents(points)
    return bool(singular[2] <= FLAT * singular[0])


def refuse_one_plane(method: str, points: Float64[np.ndarray, "n 3"]) -> None:
    """Raise where all points lie on one plane.

    Raises
    ------
    InputError
        The third extent is negligible compared with the first.
    """
    if on_one_plane(points):
        raise InputError(
            f"{method}: all {len(points)} dots lie on one plane, on which this method is singular. Train on "
            f"several planes, or use the method 'homography' for this one."
        )


def refuse_one_pixel(method: str, pixels: Pixels) -> None:
    """Raise where one camera sees all dots at the same pixel.

    Raises
    ------
    InputError
        No coordinate varies.
    """
    if np.ptp(pixels, axis=0).max() == 0:
        raise InputError(f"{method}: a camera sees all dots at the same pixel; check the columns of X.")


def refuse_several_planes(method: str, points: Float64[np.ndarray, "n 3"]) -> None:
    """Raise where the points do not share one Z.

    Raises
    ------
    InputError
        Z varies.
    """
    low, high = points[:, 2].min(), points[:, 2].max()
    if high - low > FLAT * extents(points[:, :2])[0]:
        raise InputError(
            f"{method}: the dots lie on more than one plane, Z runs from {low:.6g} mm to {high:.6g} mm, and "
            f"this method knows a single Z. Train on one plane, or use the method 'dlt' for a volume."
        )
