"""Bundle adjustment in rounds: adjust, compute eccentricity and variance component, adjust again."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64

from labcal.calibrate.adjustment.blocks import Blocks
from labcal.calibrate.adjustment.datum_constraints import DatumConstraints
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.outliers import outliers
from labcal.calibrate.adjustment.prior_term import LensPrior
from labcal.calibrate.adjustment.problem import AdjustmentProblem, ViewsEliminated
from labcal.calibrate.adjustment.scatter import Scatter
from labcal.calibrate.adjustment.state import POSE, Freedom, Layout, Lenses, RigState
from labcal.calibrate.eccentricity import DiscShapes, dot_eccentricities
from labcal.calibrate.lens_prior import FoundLens, PriorWidth, narrow_is_better
from labcal.cameras.optics import INTRINSICS
from labcal.errors import InputError
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize
from labcal.optim.robust import SQUARES, Huber, Loss
from labcal.optim.stopping import Stopping, StopReason

STOPPING = Stopping(max_epochs=200, min_gradient=1e-3)
"""Within a thousandth of a standard deviation of the minimum."""
_MORE_ROUNDS = 6
"""Most rounds more until the same dots are outliers twice."""
_FEWEST_FREE = 0.1
"""Share of the residuals' components that unknowns leave at least."""
DAMPING = Damping(start=1e-6, ceiling=1e6)
"""Starts are good: OpenCV calibrates to the minimum of nearly the same cost."""


@dataclass(frozen=True)
class Adjusted:
    """The result of a bundle adjustment."""

    state: RigState
    layout: Layout
    """Positions of parameters in `covariance`."""
    end: ViewsEliminated
    """The normal equations at the end, with the scatter."""
    residual: Float64[np.ndarray, "n 2"]
    """Predicted minus measured, px."""
    eccentricity: Float64[np.ndarray, "n 2"]
    """Eccentricity that was subtracted from the measured positions, px."""
    outlier: Bool[np.ndarray, " n"]
    """Mask of outliers, which did not enter."""
    scatter_px: float
    """Variance component as a standard deviation, per axis."""
    reason: StopReason
    prior_width: PriorWidth
    """Width of the prior of lens coefficients."""
    prior: LensPrior
    """The prior itself."""

    @cached_property
    def covariance(self) -> Float64[np.ndarray, "shared shared"]:
        """Of what all views share, with the scatter; NaN where the views leave a parameter open."""
        return self.end.shared_covariance()

    @cached_property
    def spread(self) -> Float64[np.ndarray, "shared shared"]:
        """The same, with some very large variance for what the views leave open."""
        return self.end.shared_spread()

    @property
    def normal(self) -> Blocks:
        """The blocks of the normal equations at the end."""
        return self.end.blocks

    @property
    def typical_px(self) -> float:
        """Root mean square 2-D distance of all dots but outliers."""
        return float(np.sqrt((self.residual[~self.outlier] ** 2).sum(axis=1).mean()))

    @property
    def lenses(self) -> list[FoundLens]:
        """The cameras with the covariances of their coefficients, where these are free."""
        found = []
        for camera, own in zip(self.state.cameras, self.layout.lens, strict=True):
            at = slice(own.start + INTRINSICS, own.stop)
            found.append(FoundLens(camera, self.covariance[at, at]))
        return found

    def rms_px(self, observations: Observations) -> Float64[np.ndarray, " cameras"]:
        """Return OpenCV's figure by camera, without outliers: the root mean square of the 2-D distance."""
        square = np.where(self.outlier, np.nan, (self.residual**2).sum(axis=1))
        cameras = range(len(self.state.cameras))
        return np.array([np.sqrt(np.nanmean(square[observations.of_camera(c)])) for c in cameras])


def adjust_in_rounds(
    start: RigState,
    observations: Observations,
    freedom: Freedom,
    radii: Float64[np.ndarray, " dots"] | DiscShapes,
    eccentricity_rounds: int,
    stopping: Stopping = STOPPING,
) -> Adjusted:
    """Adjust, and repeat with eccentricity, variance component and outliers of the previous round.

    Where the dots leave a lens open up to folds inside the picture, its coefficients are held tighter.

    Parameters
    ----------
    start : RigState
        Near enough for the lens formulas to image every dot.
    observations : Observations
        Centroids as measured; every view of the state has some.
    freedom : Freedom
    radii : ndarray, shape (dots,), or DiscShapes
        Of the dots' outer outlines, mm; with the planes of dots that are not parallel.
    eccentricity_rounds : int
        Number of times that the eccentricity is predicted and subtracted; 0 takes the pixels for images of
        centres.
    stopping : Stopping, optional
        Of every adjustment.

    Raises
    ------
    InputError
        A measured dot cannot be imaged at the start, or where the adjustment went.
    """
    if not np.isfinite(start.residuals(observations)).all():
        raise InputError(
            "Where the adjustment would begin, a camera cannot image all of its dots. Check that the target "
            "is the one in the pictures, choose a lens model that suits the lens, or give a rig with `start`."
        )
    rounds = _Rounds(start, observations, freedom, radii, eccentricity_rounds, stopping)
    wide = rounds.adjusted(PriorWidth.WIDE)
    if freedom.lenses is Lenses.FIXED or not any(found.is_open for found in wide.lenses):
        return wide
    narrow = rounds.adjusted(PriorWidth.NARROW)
    ratio = narrow.typical_px / max(wide.typical_px, np.finfo(np.float64).tiny)
    return narrow if narrow_is_better(wide.state.cameras, narrow.state.cameras, ratio) else wide


@dataclass(frozen=True)
class _Rounds:
    """Inputs of :func:`adjust_in_rounds`."""

    start: RigState
    observations: Observations
    freedom: Freedom
    radii: Float64[np.ndarray, " dots"] | DiscShapes
    eccentricity_rounds: int
    stopping: Stopping

    def adjusted(self, width: PriorWidth) -> Adjusted:
        """Adjust in rounds with a prior of the lenses' coefficients."""
        observations, freedom, eccentricity_rounds = self.observations, self.freedom, self.eccentricity_rounds
        prior = LensPrior.of(self.start, observations, freedom.lenses, width)
        now = _Standing.of(self.start, observations, np.zeros_like(observations.q), freedom)
        # The start may be drawn towards outliers: at first they are only held back.
        loss: Loss = Huber() if now.aside.any() else SQUARES
        entering = np.full(len(observations), fill_value=True)
        reasons: list[StopReason] = []
        for number in range(max(eccentricity_rounds, 1) + 1 + _MORE_ROUNDS):
            if 0 < number <= eccentricity_rounds:
                now = now.recentred(predicted_eccentricities(now.state, observations, self.radii))
            dots = now.measured.where(entering).scattered(now.extra)
            problem = AdjustmentProblem(dots, freedom, loss, prior)
            solution = minimize(problem, now.state, self.stopping, DAMPING)
            now = _Standing.of(solution.parameters, observations, now.eccentricity, freedom)
            settled = bool((entering == ~now.aside).all())
            entering, loss = ~now.aside, SQUARES
            # What does not come near an end is not worth more rounds; photographs did in the third.
            reasons.append(solution.reason)
            hopeless = reasons[-3:] == [StopReason.EPOCHS] * 3
            if hopeless or (settled and number >= max(eccentricity_rounds, 1)):
                break
        dots = now.measured.where(entering).scattered(now.extra)
        end = AdjustmentProblem(dots, freedom, prior=prior).linearize(now.state)
        return Adjusted(
            state=now.state,
            layout=end.layout,
            end=end,
            residual=now.state.residuals(now.measured),
            eccentricity=now.eccentricity,
            outlier=now.aside,
            scatter_px=float(np.sqrt(now.extra)),
            reason=reasons[-1],
            prior_width=width,
            prior=prior,
        )


@dataclass(frozen=True)
class _Standing:
    """State between two rounds."""

    state: RigState
    measured: Observations
    """Images of centres, as far as the eccentricity is known."""
    eccentricity: Float64[np.ndarray, "n 2"]
    """Eccentricity that was subtracted, px."""
    aside: Bool[np.ndarray, " n"]
    """Outliers."""
    extra: float
    """Variance of all others beyond the stated one, px squared; one for all cameras.

    With one for each, a rig can come to trust one camera ever more and the other ever less.
    """

    @classmethod
    def of(
        cls,
        state: RigState,
        centroids: Observations,
        eccentricity: Float64[np.ndarray, "n 2"],
        freedom: Freedom,
    ) -> "_Standing":
        """Find variance component and outliers from the residuals of a state."""
        measured = centroids.moved(-eccentricity)
        residual = state.residuals(measured)
        if not np.isfinite(residual).all():
            raise InputError(
                "The adjustment went to where a camera cannot image all of its dots. Check that the target "
                "is the one in the pictures and that no dots are far off, or choose another lens model."
            )
        layout = Layout(state, freedom)
        constraints = DatumConstraints.of(layout, centroids).count
        unknowns = layout.count + POSE * len(state.T_world_target) - constraints
        aside = outliers(measured, residual, state.dots, _share(unknowns, len(residual)))
        kept = Scatter.of(
            residual[~aside], measured.covariance[~aside], _share(unknowns, int((~aside).sum()))
        )
        return cls(state, measured, eccentricity, aside, kept.extra_variance())

    def recentred(self, eccentricity: Float64[np.ndarray, "n 2"]) -> "_Standing":
        """Return the state with another eccentricity, and the same variance component and outliers."""
        return replace(
            self, measured=self.measured.moved(self.eccentricity - eccentricity), eccentricity=eccentricity
        )


def _share(unknowns: int, dots: int) -> float:
    """Return the degrees of freedom over the number of residuals' components."""
    return max(_FEWEST_FREE, 1.0 - unknowns / max(2 * dots, 1))


def predicted_eccentricities(
    state: RigState, observations: Observations, radii: Float64[np.ndarray, " dots"] | DiscShapes
) -> Float64[np.ndarray, "n 2"]:
    """Return the eccentricity of every observation, px."""
    shapes = radii if isinstance(radii, DiscShapes) else DiscShapes(radii)
    discs = shapes.at(state.dots)
    eccentricity = np.zeros_like(observations.q)
    for picture in observations.pictures:
        camera, T = state.cameras[picture.camera], state.T_world_target[picture.view]
        eccentricity[picture.rows] = dot_eccentricities(camera, T, discs, observations.dot[picture.rows])
    return eccentricity
