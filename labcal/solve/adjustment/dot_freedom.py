"""How dots may move on a print without shifting, turning or growing it as a whole."""

from enum import StrEnum

import numpy as np
from jaxtyping import Bool, Float64

from labcal.errors import InputError

MOST_DOTS = 2000
"""Dots that may be free at once: their covariance is a full matrix."""


class DotMotion(StrEnum):
    """In which directions dots may move."""

    NONE = "none"
    IN_PLANE = "in-plane"
    IN_SPACE = "in-space"


def dot_freedom(
    dots: Float64[np.ndarray, "dots 3"], movable: Bool[np.ndarray, " dots"], motion: DotMotion
) -> Float64[np.ndarray, "coordinates free"]:
    """Return an orthonormal basis of the dots' motions with the gauge taken out.

    Parameters
    ----------
    dots : ndarray, shape (dots, 3)
        Where they are declared, mm.
    movable : ndarray of bool, shape (dots,)
        Which dots may move; the gauge is over them.
    motion : DotMotion

    Returns
    -------
    ndarray, shape (3 dots, free)
        The mean displacement of the movable dots is 0, and so are their mean rotation and their mean change
        of scale: pictures tell none of these apart from the target's pose and its distance. What they leave
        is the shape (inner constraints of a free network, Granshaw 1980).

    Raises
    ------
    InputError
        More dots than :data:`MOST_DOTS` are movable.
    """
    count = int(movable.sum())
    if count > MOST_DOTS:
        raise InputError(
            f"{count} dots would be free at once, but their covariance is computed for up to {MOST_DOTS}. "
            "Use a target with fewer dots, or leave --free-dots out."
        )
    if motion is DotMotion.NONE or count == 0:
        return np.zeros((dots.size, 0))
    along = 2 if motion is DotMotion.IN_PLANE else 3
    x, y, z = (dots[movable] - dots[movable].mean(axis=0)).T
    o, one = np.zeros_like(x), np.ones_like(x)
    turns = [[-y, x, o]] if along == 2 else [[-y, x, o], [z, o, -x], [o, -z, y]]  # noqa: PLR2004 -- a plane
    shifts = [[one, o, o], [o, one, o], [o, o, one]][:along]
    gauge = np.array([np.stack(motions[:along], axis=-1).ravel() for motions in [*shifts, *turns, [x, y, z]]])
    rotated, _ = np.linalg.qr(gauge.T, mode="complete")
    inner = rotated[:, len(gauge) :]
    basis = np.zeros((len(dots), 3, inner.shape[1]))
    basis[movable, :along] = inner.reshape(count, along, -1)
    return basis.reshape(dots.size, -1)
