"""Errors that the dots of a measured print have in common, which their own covariances do not tell.

A print that is measured once has errors of its own. Those of single dots hardly move a camera, since there
are many dots; errors of stretch, keystone and scale move it as much as they like.
"""

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.budget.print_share import PrintShare
from labcal.calibrate.freed_dots import FreedDots
from labcal.targets.places import DotPlaces

_COMMON = 1.5
"""Times the variance of single dots from which on a direction is an error that they have in common."""
_MOST = 12
"""Directions that are kept; of freed dots on boards of 13 x 10 two to five stand out."""
_LEAST = 1e-9
"""Variance of a place, mm squared, that is added where one is nothing, over the largest one."""


def measured_places(freed: FreedDots, share: PrintShare | None) -> DotPlaces:
    """Return the document of freed dots with the errors that they have in common.

    Parameters
    ----------
    freed : FreedDots
    share : PrintShare or None
        The print's share of the calibration; its `datum` is what no view tells.
    """
    shared = _in_common(freed)
    datum = np.zeros((freed.place.size, 0)) if share is None else share.datum
    update = {"shared": _rows(shared), "datum": _rows(datum)}
    return freed.places().model_copy(update=update)


def _in_common(freed: FreedDots) -> Float64[np.ndarray, "coordinates directions"]:
    """Return directions in which dots err together by more than each by itself, one sigma each, mm.

    Notes
    -----
    With own covariances L L' of single dots, eigenvectors u of the whitened joint covariance whose
    eigenvalues s exceed 1 by far give L u sqrt(s - 1); the rest is as good as independent.
    """
    own = freed.own_covariance
    found = np.flatnonzero(freed.freed)
    scale = float(np.trace(own[found], axis1=1, axis2=2).max())
    L = np.linalg.cholesky(own[found] + _LEAST * scale * np.eye(3))
    white = np.linalg.inv(L)
    joint = freed.covariance[found][:, :, found]
    joint = np.einsum("iab,ibjc,jdc->iajd", white, joint, white, optimize=True)
    size, axes = np.linalg.eigh(joint.reshape(3 * len(found), -1))
    stand_out = np.flatnonzero(size > _COMMON)[::-1][:_MOST]
    along = (L @ axes[:, stand_out].reshape(len(found), 3, -1)) * np.sqrt(size[stand_out] - 1.0)
    directions = np.zeros((len(own), 3, len(stand_out)))
    directions[found] = along
    return directions.reshape(freed.place.size, -1)


def _rows(directions: Float64[np.ndarray, "coordinates directions"]) -> tuple[tuple[float, ...], ...]:
    """Return directions as they stand in the file: to a hundred-thousandth of their largest part."""
    rows = []
    for direction in directions.T:
        step = 10.0 ** np.floor(np.log10(max(float(np.abs(direction).max()), 1e-12)) - 5.0)
        rows.append(tuple(float(f"{step * np.round(one / step):.7g}") for one in direction))
    return tuple(rows)
