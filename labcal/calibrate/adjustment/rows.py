"""Whitened derivatives and residuals of observations, a run of one camera's pictures at a time."""

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.observations import Observations, Run
from labcal.calibrate.adjustment.state import POSE, Layout
from labcal.cameras.derivatives import point_derivatives, projection_derivatives
from labcal.optim.robust import Loss

SHIFT = slice(-4, -1)
"""Columns of a shift of the target."""
_RESIDUAL = -1


def linearised_rows(
    layout: Layout, observations: Observations, run: Run, loss: Loss
) -> Float64[np.ndarray, "width 2 n"]:
    """Return the derivatives of a run's residuals, and these, in units of standard deviations.

    Parameters
    ----------
    layout : Layout
        The state, and whether lenses are free.
    observations : Observations
    run : Run
        One of theirs.
    loss : Loss
        Residuals are weighted by its slope (Triggs et al. 2000, "Bundle adjustment", section 4.3, without
        the term of second order).

    Returns
    -------
    ndarray, shape (lens + 7, 2, n)
        By each number of the lens, where it is free; by a turn of the target about its origin and by a shift,
        both along the camera's axes and as if each picture's target could move by itself; last the residual,
        predicted minus measured. How poses of views and of cameras move the target is the same for all dots
        of a picture, and follows in :mod:`labcal.calibrate.adjustment.blocks`.

    Notes
    -----
    With a pixel's derivative j by a point x of a frame, turning the frame's contents by w moves the point by
    ``w x x``, and the pixel by ``j (w x x) = w (x x j)``.
    """
    camera, lens = layout.state.cameras[run.camera], layout.lens[run.camera]
    free = lens.stop - lens.start
    arm, p = layout.state.seen_by(observations, run)
    found = (projection_derivatives if free else point_derivatives)(camera, p.T)
    rows = np.empty((free + POSE + 1, 2, p.shape[1]))
    turn, shift, residual = rows[free : free + 3], rows[SHIFT], rows[_RESIDUAL]
    whitener = observations.whitener.rows(run.rows)
    residual[...] = whitener.whiten(found.q.T - observations.q[run.rows].T)
    weight = np.sqrt(loss.weight((residual**2).sum(axis=0)))
    residual *= weight
    weighted = whitener.weighted(weight)
    rows[:free] = weighted.whiten(found.by_camera.T)
    shift[...] = weighted.whiten(found.by_point.T)
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        np.subtract(arm[one] * shift[two], arm[two] * shift[one], out=turn[axis])
    return rows
