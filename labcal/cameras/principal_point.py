"""Notes on principal points that lie where no lens has its axis."""

import numpy as np

from labcal.cameras.camera import Camera

_LEAST_OFF, _NEARER = 0.08, 3.0
"""A principal point this far off the middle, in diagonals, and this many times nearer to that of the picture
with its sides exchanged, is taken for a sign that they are."""


def principal_point_note(name: str, camera: Camera) -> str | None:
    """Return a note where the principal point is outside of the picture; None where it is in it.

    Parameters
    ----------
    name : str
        The camera's.
    camera : Camera
    """
    _, _, cx, cy = camera.intrinsics
    width, height = camera.size
    if 0.0 <= cx <= width - 1 and 0.0 <= cy <= height - 1:
        return None
    return (
        f"the principal point of {name}, ({cx:.1f}, {cy:.1f}) px, lies outside of its picture of {width} x "
        f"{height} px: the size, or the order of the numbers, may be another one, or the pictures are parts "
        "of larger ones"
    )


def exchanged_sides_note(name: str, camera: Camera, mend: str) -> str | None:
    """Return a note where width and height of a picture seem to be exchanged; None where they do not.

    Parameters
    ----------
    name : str
        The camera's.
    camera : Camera
    mend : str
        Advice, in which ``{width}`` and ``{height}`` stand for the sides of the picture after it, px.
    """
    sides, point = np.array(camera.size, dtype=np.float64), np.array(camera.intrinsics[2:])
    off, off_exchanged = (float(np.linalg.norm(point - (one - 1.0) / 2.0)) for one in (sides, sides[::-1]))
    if off < _LEAST_OFF * np.linalg.norm(sides) or off < _NEARER * off_exchanged:
        return None
    width, height = camera.size
    return (
        f"width and height of the pictures of {name}, {width} x {height} px, seem to be exchanged: its "
        f"principal point, ({point[0]:.1f}, {point[1]:.1f}) px, is {off:.3g} px off the middle of such a "
        f"picture, and {off_exchanged:.3g} px off that of one of {height} x {width} px. "
        + mend.format(width=height, height=width)
    )
