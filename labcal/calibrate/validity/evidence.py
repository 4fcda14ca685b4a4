"""New views as evidence about the parameters of a rig: a quadratic cost, poses of the target eliminated."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from jaxtyping import Float64

from labcal.calibrate.adjustment.blocks import assemble
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.problem import AdjustmentProblem
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState, moved_poses
from labcal.calibrate.validity.change import Change, possible_changes
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.optim.robust import SQUARES

_SETTLING = 12
"""Most Gauss-Newton steps of the poses of the target."""
_SETTLED = 1e-3
"""Decrease of the cost below which the poses have settled, in units of a squared standard deviation."""
_MOST_DOTS = 400
"""Dots of a print whose errors are followed one by one; of larger boards, so many stand for all."""


@dataclass(frozen=True)
class Evidence:
    """The cost of new views about a state, as a quadratic of the rig's parameters.

    Attributes
    ----------
    state : RigState
        With the poses of the target that suit its cameras best.
    cost : float
        Squares of residuals in units of their variances, the errors of the print eliminated.
    gradient : float64 array, (shared,)
        Half of its derivatives.
    information : float64 array, (shared, shared)
        Half of the second ones, by Gauss-Newton.
    dots : float64 array, (dots, 3)
        Most likely places of the dots on the print, mm.
    """

    state: RigState
    cost: float
    gradient: Float64[np.ndarray, " shared"]
    information: Float64[np.ndarray, "shared shared"]
    dots: Float64[np.ndarray, "dots 3"]


@dataclass(frozen=True)
class NewViews:
    """Dots of new views, with the noise that they have.

    Attributes
    ----------
    observations : Observations
        Images of centres, px, with their covariances, the variance component and all factors.
    print_sigma_mm : float
        Standard deviation of dots on the print along each direction of its plane, mm.
    """

    observations: Observations
    print_sigma_mm: float

    def noisier(self, factor: float) -> "NewViews":
        """Return the same dots with so many times the variance."""
        seen = replace(self.observations, covariance=factor * self.observations.covariance)
        return replace(self, observations=seen)

    def freedom(self, state: RigState) -> Freedom:
        """Return what the calibration leaves open: lenses and poses."""
        return Freedom(Lenses.FREE, np.zeros((state.dots.size, 0)))

    def changes(self, cameras: tuple[int, ...]) -> tuple[Change, ...]:
        """Return the kinds of changes that are looked for."""
        return possible_changes(cameras)

    def rig_cameras(self, state: RigState) -> tuple[Camera, ...]:
        """Return the rig's cameras, the first one as the world."""
        return state.cameras

    def rig_columns(self, state: RigState) -> Float64[np.ndarray, "rig shared"]:
        """Return the derivatives of the rig's parameters by all."""
        return np.eye(Layout(state, self.freedom(state)).count)

    def evidence(self, state: RigState) -> Evidence | None:
        """Return the evidence at a state, whose poses of the target are adjusted; None if it images not all.

        Notes
        -----
        Errors d of dots on the print, the same in all views, have a prior of their own: they are eliminated
        as the poses are, so that ``information`` and ``cost`` are those of residuals with the covariance
        that noise and print make together.
        """
        try:
            settled = self.settled(state)
        except (InputError, np.linalg.LinAlgError):
            return None
        if settled is None:
            return None
        basis, per_mode = self._print_modes(settled)
        end = AdjustmentProblem(self.observations, Freedom(Lenses.FREE, basis)).linearize(settled)
        if end.reduced is None:
            return None
        information, gradient = end.reduced.unscaled(end.blocks.gradient)
        white = self.observations.whitener.whiten(settled.residuals(self.observations).T)
        cost = float((white**2).sum())
        n, dots = len(information) - basis.shape[1], settled.dots
        if basis.shape[1]:
            own = information[n:, n:] + np.diag(per_mode)
            right = np.column_stack([information[n:, :n], gradient[n:]])
            carried = scipy.linalg.cho_solve(scipy.linalg.cho_factor(own), right)
            cost -= float(gradient[n:] @ carried[:, -1])
            dots = dots - (basis @ carried[:, -1]).reshape(-1, 3)
            gradient = gradient[:n] - information[:n, n:] @ carried[:, -1]
            information = information[:n, :n] - information[:n, n:] @ carried[:, :-1]
        if not (np.isfinite(cost) and np.isfinite(information).all() and np.isfinite(gradient).all()):
            return None
        return Evidence(settled, cost, gradient, 0.5 * (information + information.T), dots)

    def settled(self, state: RigState) -> RigState | None:
        """Return a state with the poses of the target adjusted to its cameras; None if it images not all."""
        still = Freedom(Lenses.FIXED, np.zeros((state.dots.size, 0)))
        for _ in range(_SETTLING):
            blocks = assemble(Layout(state, still), self.observations, SQUARES)
            if not np.isfinite(blocks.gradient.view).all():
                return None
            step = np.linalg.solve(blocks.view, blocks.gradient.view[:, :, None])[:, :, 0]
            state = replace(state, T_world_target=moved_poses(state.T_world_target, -step))
            if float((step * blocks.gradient.view).sum()) < _SETTLED:
                break
        return state if np.isfinite(state.residuals(self.observations)).all() else None

    def _print_modes(
        self, state: RigState
    ) -> tuple[Float64[np.ndarray, "coordinates modes"], Float64[np.ndarray, " modes"]]:
        """Return directions of errors of the print, and the inverse variances along them, per square mm."""
        if self.print_sigma_mm == 0.0:
            return np.zeros((state.dots.size, 0)), np.zeros(0)
        measured = np.flatnonzero(np.bincount(self.observations.dot, minlength=len(state.dots)))
        some = measured[:: -(-len(measured) // _MOST_DOTS)]
        basis = np.zeros((len(state.dots), 3, 2 * len(some)))
        for axis in range(2):
            basis[some, axis, 2 * np.arange(len(some)) + axis] = 1.0
        stand_for = len(measured) / len(some)
        weight = 1.0 / (stand_for * self.print_sigma_mm**2)
        return basis.reshape(state.dots.size, -1), np.full(basis.shape[2], weight)
