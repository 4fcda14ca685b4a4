"""Motions of free dots on a print without shift, rotation and scale of the whole, which are the gauge."""

from dataclasses import dataclass
from enum import Flag, auto

import numpy as np
from jaxtyping import Bool, Float64

from labcal.errors import InputError

MOST_DOTS = 2000
"""Dots that may be free at once: their covariance is a full matrix."""
SHAPES = 4
"""The last of the :func:`plane_modes`: two of stretch, then two of keystone."""


class Constrained(Flag):
    """Parts of the places of dots that keep their declared values, since the views do not determine them."""

    NOTHING = 0
    HEIGHTS = auto()
    STRETCH = auto()
    """The difference of the scales along x and y, or the shear, or a combination."""
    KEYSTONE = auto()
    """A scale that grows along some direction, like the image of a square that is seen obliquely."""


@dataclass(frozen=True)
class DatumConstraint:
    """A datum constraint: the parts and directions of the places of dots that keep their declared values."""

    parts: Constrained
    """The parts by name."""
    directions: Float64[np.ndarray, "coordinates kept"]
    """Motions in the plane, orthonormal, that are constrained to 0."""

    @classmethod
    def nothing(cls, dots: int) -> "DatumConstraint":
        """Return the constraint that leaves all motions free."""
        return cls(Constrained.NOTHING, np.zeros((3 * dots, 0)))


def dot_freedom(
    dots: Float64[np.ndarray, "dots 3"], movable: Bool[np.ndarray, " dots"], hold: DatumConstraint
) -> Float64[np.ndarray, "coordinates free"]:
    """Return an orthonormal basis of the motions of dots without the gauge.

    Parameters
    ----------
    dots : ndarray, shape (dots, 3)
        Where they are declared, mm; z = 0.
    movable : ndarray of bool, shape (dots,)
        A mask of dots that may move; the gauge refers to them.
    hold : DatumConstraint

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
            "Use a target with fewer dots, or keep them as declared: `dot_places='declared'`."
        )
    along = 2 if Constrained.HEIGHTS in hold.parts else 3
    x, y, z = (dots[movable] - dots[movable].mean(axis=0)).T
    o, one = np.zeros_like(x), np.ones_like(x)
    gauge = [[one, o, o], [o, one, o], [-y, x, o], [x, y, z]]
    if along == 3:  # noqa: PLR2004 -- x, y, z
        gauge += [[o, o, one], [z, o, -x], [o, -z, y]]
    constraints = np.array([np.stack(motion[:along], axis=-1).ravel() for motion in gauge])
    kept = hold.directions.T.reshape(-1, len(dots), 3)[:, movable, :along].reshape(-1, constraints.shape[1])
    constraints = np.concatenate([constraints, kept])
    rotated, _ = np.linalg.qr(constraints.T, mode="complete")
    inner = rotated[:, len(constraints) :]
    basis = np.zeros((len(dots), 3, inner.shape[1]))
    basis[movable, :along] = inner.reshape(count, along, -1)
    return basis.reshape(dots.size, -1)


def plane_modes(
    dots: Float64[np.ndarray, "dots 3"], movable: Bool[np.ndarray, " dots"]
) -> Float64[np.ndarray, "coordinates 8"]:
    """Return the motions of a plane by a homography, orthonormal: gauge, then stretch (2), then keystone (2).

    The picture of a plane by a camera of which nothing is known leaves just these open.
    """
    x, y, _ = (dots[movable] - dots[movable].mean(axis=0)).T
    o, one = np.zeros_like(x), np.ones_like(x)
    motions = [[one, o], [o, one], [-y, x], [x, y], [x, -y], [y, x], [x * x, x * y], [x * y, y * y]]
    modes = np.zeros((len(dots), 3, len(motions)))
    for number, motion in enumerate(motions):
        modes[movable, :2, number] = np.stack(motion, axis=-1)
    orthonormal, _ = np.linalg.qr(modes.reshape(dots.size, -1))
    return np.asarray(orthonormal)
