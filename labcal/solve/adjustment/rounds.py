"""Bundle adjustment in rounds: adjust, predict the centre bias and the scatter, adjust again."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.errors import InputError
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize
from labcal.optim.solution import Stopping, StopReason
from labcal.solve.adjustment.lens_prior import LensPrior
from labcal.solve.adjustment.observations import Observations
from labcal.solve.adjustment.problem import AdjustmentProblem
from labcal.solve.adjustment.scatter import extra_variance
from labcal.solve.adjustment.state import POSE, Freedom, Layout, RigState
from labcal.solve.centre_bias import Discs, centre_shift

STOPPING = Stopping(max_epochs=200, min_gradient=1e-3)
"""Within a thousandth of a standard deviation of the minimum."""
DAMPING = Damping(start=1e-6, ceiling=1e6)
"""Starts are good: OpenCV calibrates to the minimum of nearly the same cost."""


@dataclass(frozen=True)
class Adjusted:
    """The end of a bundle adjustment."""

    state: RigState
    layout: Layout
    """Where parameters stand in `covariance`."""
    covariance: Float64[np.ndarray, "shared shared"]
    """Of what all views share, with the scatter; NaN where the views leave a parameter open."""
    residual: Float64[np.ndarray, "n 2"]
    """Predicted minus measured, px."""
    shift: Float64[np.ndarray, "n 2"]
    """Centroid minus centre that was taken off the measured positions, px."""
    scatter_px: float
    """What dots scatter (per axis) beyond their covariances."""
    reason: StopReason

    def rms_px(self, observations: Observations) -> Float64[np.ndarray, " cameras"]:
        """Return OpenCV's figure by camera: the root mean square of the 2-D distance."""
        square = (self.residual**2).sum(axis=1)
        cameras = range(len(self.state.cameras))
        return np.array([np.sqrt(square[observations.of_camera(c)].mean()) for c in cameras])


def adjust_in_rounds(
    start: RigState,
    observations: Observations,
    freedom: Freedom,
    radii: Float64[np.ndarray, " dots"],
    bias_rounds: int,
) -> Adjusted:
    """Adjust, and repeat with what the adjustment tells of bias and scatter.

    Parameters
    ----------
    start : RigState
        Near enough for the lens formulas to image every dot.
    observations : Observations
        Centroids as measured; every view of the state has some.
    freedom : Freedom
    radii : ndarray, shape (dots,)
        Of the dots' outer outlines, mm.
    bias_rounds : int
        How often centroid minus centre is predicted and taken off; 0 takes the pixels for images of centres.

    Raises
    ------
    InputError
        A measured dot cannot be imaged at the start.
    """
    if not np.isfinite(start.residuals(observations)).all():
        raise InputError(
            "Where the adjustment would begin, a camera cannot image all of its dots. Check that the target "
            "is the one in the pictures, choose a lens model that suits the lens, or give a rig with --start."
        )
    state, measured = start, observations
    shift = np.zeros_like(observations.q)
    extra = _extra(state, measured, freedom)
    prior = LensPrior.of(start, observations, freedom.lenses)
    for number in range(max(bias_rounds, 1) + 1):
        if 0 < number <= bias_rounds:
            shift = predicted_shift(state, observations, radii)
            measured = observations.moved(-shift)
        problem = AdjustmentProblem(measured.scattered(extra), freedom, prior=prior)
        solution = minimize(problem, state, STOPPING, DAMPING)
        state = solution.parameters
        extra = _extra(state, measured, freedom)
    end = AdjustmentProblem(measured.scattered(extra), freedom, prior=prior).linearize(state)
    return Adjusted(
        state=state,
        layout=end.layout,
        covariance=end.shared_covariance(),
        residual=state.residuals(measured),
        shift=shift,
        scatter_px=float(np.sqrt(extra)),
        reason=solution.reason,
    )


def predicted_shift(
    state: RigState, observations: Observations, radii: Float64[np.ndarray, " dots"]
) -> Float64[np.ndarray, "n 2"]:
    """Return centroid minus centre of every observation, px."""
    discs = Discs(state.dots, radii)
    shift = np.zeros_like(observations.q)
    for picture in observations.pictures:
        camera, T = state.cameras[picture.camera], state.T_world_target[picture.view]
        shift[picture.rows] = centre_shift(camera, T, discs, observations.dot[picture.rows])
    return shift


def _extra(state: RigState, observations: Observations, freedom: Freedom) -> float:
    """Return the variance beyond the stated one, px squared; one for all cameras.

    With one for each, a rig can come to trust one camera ever more and the other ever less.
    """
    residual = state.residuals(observations)
    unknowns = Layout(state, freedom).count + POSE * len(state.T_world_target)
    return extra_variance(residual, observations.covariance, max(0.1, 1.0 - unknowns / residual.size))
