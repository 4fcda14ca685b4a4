"""A frame by three points: the origin, one on the x axis, one in the plane of x and y."""

import numpy as np

from labcal.arrays import PointCovariances, Vectors3
from labcal.errors import InputError
from labcal.reconstruct.frames.fitted_frame import FittedFrame, FrameKind, by_parameters

_ON_A_LINE = 1e-9
"""Height of a triangle over its sides, below which its points are on a line but for rounding."""
_CONSTRAINTS = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])
"""Coordinates that are 0 by decree: point (origin, on x, in the plane), and coordinate."""
MOST_TURN_RAD = 0.3
"""Standard deviation of a frame's rotation from which on its points determine none."""


def frame_by_points(
    view: str, names: tuple[str, str, str], points: Vectors3, covariance: PointCovariances
) -> FittedFrame:
    """Return the frame of three points; the third one has a positive y.

    Parameters
    ----------
    view : str
    names : tuple of str
        Names of the origin, of a point on the positive x axis, and of one in the plane of x and y.
    points : ndarray, shape (3, 3)
        Their places in the world of the model, mm.
    covariance : ndarray, shape (3, 3, 3)
        Mm squared; they count as independent.

    Raises
    ------
    InputError
        Two of the points coincide, or the three lie on a line, exactly or within their uncertainty.

    Notes
    -----
    Six coordinates are 0 in the frame. Their differentials, ``H dtheta + R_ba dp = 0``, give the derivatives
    of the six parameters by the points.
    """
    origin, on_x, in_plane = points
    along, across = on_x - origin, in_plane - origin
    upright = np.cross(along, across)
    if np.linalg.norm(upright) <= _ON_A_LINE * np.linalg.norm(along) * np.linalg.norm(across):
        raise on_a_line(names)
    x, z = along / np.linalg.norm(along), upright / np.linalg.norm(upright)
    R_ba = np.stack([x, np.cross(z, x), z])
    by_frame = by_parameters(points @ R_ba.T, 6)[_CONSTRAINTS]
    by_points = np.zeros((6, 3, 3))
    by_points[np.arange(6), _CONSTRAINTS[0]] = R_ba[_CONSTRAINTS[1]]
    slopes = -np.linalg.solve(by_frame, by_points.reshape(6, 9)).reshape(6, 3, 3).swapaxes(0, 1)
    frame = FittedFrame(
        FrameKind.POINTS, view, names, R_ba, -R_ba @ origin, 1.0, slopes, covariance,
        np.zeros((6, 6)), R_ba @ (points.mean(axis=0) - origin), np.zeros((3, 3)), None,
    )  # fmt: skip
    require_turn(frame, names)
    return frame


def require_turn(frame: FittedFrame, names: tuple[str, ...]) -> None:
    """Raise where the points of a frame leave its rotation open.

    Raises
    ------
    InputError
        They are on a line within their uncertainty.
    """
    turn = float(np.sqrt(np.linalg.eigvalsh(frame.parameter_covariance[:3, :3])[-1]))
    if not turn <= MOST_TURN_RAD:
        raise on_a_line(names, f" within their uncertainty (it leaves {np.degrees(turn):.0f} degrees open)")


def on_a_line(names: tuple[str, ...], within: str = "") -> InputError:
    """Return the error for points that fix no frame."""
    listed = ", ".join(f"'{name}'" for name in names[:6]) + (" ..." if len(names) > 6 else "")  # noqa: PLR2004
    return InputError(
        f"The points {listed} lie on a line{within}, so that they fix no frame. Name points that form a wide "
        "triangle."
    )
