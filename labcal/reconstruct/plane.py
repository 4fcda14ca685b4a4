"""A plane through points, with its uncertainty."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import AnyArray
from labcal.errors import InputError
from labcal.public_object import PublicObject
from labcal.reconstruct.chosen_points import AnyReconstruction, ChosenPoints, Shares

_FEWEST = 3
_ON_A_LINE = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class Plane(PublicObject):
    """A least-squares plane; all points weigh the same.

    Attributes
    ----------
    centre : float64 array, (3,)
        Mean of the points, mm.
    axes : float64 array, (3, 3)
        Rows: two directions in the plane, along which the points extend most and least, and the normal.
    rms_mm : float
        Root mean square distance of the points from the plane.
    shares : Shares
        Covariance of the plane's height above its centre (mm) and of its slopes along both directions (rad).

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples, pipeline
    >>> found = pipeline.reconstruct(examples.rig(), examples.detections(), examples.TARGET)
    >>> board = labcal.plane(found, found.points.view == "hand-0")
    >>> bool(board.sigma_height_mm < 0.05), board.sigma_slopes_rad.shape
    (True, (2,))
    """

    centre: Float64[np.ndarray, "3"]
    axes: Float64[np.ndarray, "3 3"]
    rms_mm: float
    shares: Shares

    @property
    def normal(self) -> Float64[np.ndarray, "3"]:
        """The unit normal, towards the origin of the world."""
        return np.asarray(self.axes[2])

    @property
    def sigma_height_mm(self) -> float:
        """Standard deviation of the plane's height above its centre, along the normal."""
        return float(np.sqrt(self.shares.total[0, 0]))

    @property
    def sigma_slopes_rad(self) -> Float64[np.ndarray, "2"]:
        """Standard deviations of the slopes along both directions."""
        return np.asarray(np.sqrt(np.diagonal(self.shares.total)[1:]))

    def _summary(self) -> Mapping[str, object]:
        return {
            "normal": [round(value, 6) for value in self.normal.tolist()],
            "rms": f"{self.rms_mm:.3g} mm",
            "sigma_height": f"{self.sigma_height_mm:.3g} mm",
            "sigma_slopes": f"{self.sigma_slopes_rad.max():.3g} rad",
            "budget": self.shares.budget.value,
        }


def plane(found: AnyReconstruction, lines: AnyArray) -> Plane:
    """Return the plane through points of a rig.

    Parameters
    ----------
    found : Reconstruction or NamedReconstruction
    lines : array_like of int or of bool, or sequence of str or (str, str)
        Lines of the points in ``found.points``: their numbers, or a mask; of named points also their names,
        with the view before the name where several views have it.

    Returns
    -------
    Plane
        Mm; with the covariance of its height and slopes.

    Raises
    ------
    InputError, InputTypeError
        Fewer than three points, or all on a line; there is no such line, or one has no solution; or the
        points are not those of a rig.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples, pipeline
    >>> found = pipeline.reconstruct(examples.rig(), examples.detections(), examples.TARGET)
    >>> board = labcal.plane(found, found.points.view == "hand-0")
    >>> bool(board.rms_mm < 0.2)
    True
    """
    points = ChosenPoints.of(found, lines, "lines")
    if len(points.point) < _FEWEST:
        raise InputError(f"A plane needs at least {_FEWEST} points, but {len(points.point)} were given.")
    centre = points.point.mean(axis=0)
    arm = points.point - centre
    _, extent, axes = np.linalg.svd(arm, full_matrices=False)
    if extent[1] <= _ON_A_LINE * extent[0]:
        raise InputError("A plane needs points that do not all lie on one line.")
    axes = axes if axes[2] @ centre <= 0.0 else axes * np.array([[1.0], [1.0], [-1.0]])
    height = arm @ axes[2]
    # Heights are fitted by a constant and two slopes; the coordinates in the plane are uncorrelated.
    design = np.stack([np.ones(len(arm)), arm @ axes[0], arm @ axes[1]])
    fitted = design / (design**2).sum(axis=1, keepdims=True)
    shares = points.shares(fitted[:, :, None] * axes[2])
    return Plane(centre, axes, float(np.sqrt((height**2).mean())), shares)
