"""The best explanation of new views by one kind of change, or by none: calibration as prior, Gauss-Newton."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.state import POSE, Layout, RigState
from labcal.calibrate.validity.change import Change
from labcal.calibrate.validity.evidence import Evidence, NewViews
from labcal.calibrate.validity.mark_views import MarkViews
from labcal.errors import InputError

Views = NewViews | MarkViews
"""New views of a target in the hand, or of marks that stay where they are."""

_MOST_STEPS = 60
_ARRIVED = 1e-2
"""Expected decrease of the cost below which no step is made, in units of a squared standard deviation."""
_FIRST_DAMPING, _MOST_DAMPING = 1e-3, 1e6
"""In units of each parameter's own curvature, once a step without damping has failed (Marquardt 1963)."""
_TENFOLD = 10.0
_NOTHING = 1e-14
"""Of the largest eigenvalue of correlations, below which one is rounding."""
_HOPELESS = 1e-2
"""The same in units of how much worse the explanation is than the best one."""


@dataclass(frozen=True)
class Calibrated:
    """A rig as calibrated, before the new views: its state is the mean, its covariance that of all errors.

    Attributes
    ----------
    state : RigState
        The cameras, and poses of the target in the new views.
    covariance : float64 array, (shared, shared)
        In the order of ``rig.json``; of a rig in its room with those of the room before, and marks behind.
    distance_mm : float
        Of the target from the cameras.
    """

    state: RigState
    covariance: Float64[np.ndarray, "shared shared"]
    distance_mm: float


@dataclass(frozen=True)
class Explanation:
    """New views explained by errors of the calibration and by one change.

    Attributes
    ----------
    change : Change or None
        None of a rig that is as it was.
    size : float64 array, (count,)
        Of the change; rad, mm, relative focal lengths, px.
    size_covariance : float64 array, (count, count)
    cost : float
        Squares of residuals, of errors of the calibration and of the change in units of their variances.
    log_evidence : float
        Logarithm of the probability density of the pictures, up to what all explanations share.
    evidence : Evidence
        At the end.
    covariance : float64 array, (shared, shared)
        Of the rig's parameters at the end, from calibration and pictures together.
    errors : float64 array, (roots,)
        Errors of the calibration, in units of :func:`covariance_root`.
    """

    change: Change | None
    size: Float64[np.ndarray, " count"]
    size_covariance: Float64[np.ndarray, "count count"]
    cost: float
    log_evidence: float
    evidence: Evidence
    covariance: Float64[np.ndarray, "shared shared"]
    errors: Float64[np.ndarray, " roots"]

    def axis_gains(self) -> Float64[np.ndarray, " count"]:
        """Return the decrease of the cost by the change along each of its parameters alone.

        With the precision P of the size x, the cost falls by ``(P x)_i^2 / P_ii`` where all others are 0.
        """
        precision = np.linalg.inv(self.size_covariance)
        return np.asarray((precision @ self.size) ** 2 / np.diagonal(precision))


@dataclass(frozen=True)
class _Standing:
    """A point on the way, in units of the prior: `unit` has the variance 1 before the views."""

    unit: Float64[np.ndarray, " units"]
    cost: float
    evidence: Evidence


@dataclass(frozen=True)
class _Search:
    """The search for the best explanation by one kind of change."""

    calibrated: Calibrated
    change: Change | None
    views: Views
    root: Float64[np.ndarray, "shared roots"]
    """Of the calibration's covariance."""
    sizes: Float64[np.ndarray, " count"]
    """Standard deviations of the change before the views."""

    def at(self, unit: Float64[np.ndarray, " units"]) -> _Standing | None:
        """Return the cost at a point; None where the cameras image not all dots."""
        start, error = self.calibrated.state, self.root @ unit[: self.root.shape[1]]
        try:
            state = start if self.change is None else self.change.applied(start, self.size(unit))
            layout = Layout(state, self.views.freedom(state))
            state = layout.stepped(error, np.zeros((len(state.T_world_target), POSE)))
        except InputError:
            return None
        evidence = self.views.evidence(state)
        return None if evidence is None else _Standing(unit, evidence.cost + float(unit @ unit), evidence)

    def size(self, unit: Float64[np.ndarray, " units"]) -> Float64[np.ndarray, " count"]:
        """Return the size of the change."""
        return np.asarray(self.sizes * unit[self.root.shape[1] :])

    def reach(self, state: RigState) -> Float64[np.ndarray, "shared units"]:
        """Return the derivatives of the rig's parameters by the units."""
        if self.change is None:
            return self.root
        return with_change(self.root, self.change.columns(state) * self.sizes)

    def end(self, now: _Standing, floor: float) -> _Standing:
        """Return the end of damped Gauss-Newton steps; with long lenses the valley of the cost is curved."""
        damping = 0.0
        for _ in range(_MOST_STEPS):
            L = self.reach(now.evidence.state)
            slope = now.unit + L.T @ now.evidence.gradient
            normal = np.eye(L.shape[1]) + L.T @ now.evidence.information @ L
            expected = float(slope @ np.linalg.solve(normal, slope))
            if expected < max(_ARRIVED, _HOPELESS * (now.cost - floor)):
                break
            tried = None
            while tried is None and damping <= _MOST_DAMPING:
                damped = normal + damping * np.diag(np.diagonal(normal))
                tried = self.at(now.unit - np.linalg.solve(damped, slope))
                if tried is None or not tried.cost < now.cost:
                    tried, damping = None, max(_FIRST_DAMPING, _TENFOLD * damping)
            if tried is None:
                break
            now = tried
            damping = 0.0 if damping <= _FIRST_DAMPING else damping / _TENFOLD
        return now


def explained(
    calibrated: Calibrated,
    change: Change | None,
    views: Views,
    floor: float = np.inf,
    start: Float64[np.ndarray, " roots"] | None = None,
) -> Explanation | None:
    """Return the best explanation by a kind of change; None where none images all dots.

    Parameters
    ----------
    calibrated : Calibrated
    change : Change or None
        None of a rig that is as it was.
    views : NewViews or MarkViews
    floor : float
        Cost of an explanation that is known: what is far worse need not be exact.
    start : ndarray, shape (roots,), optional
        Errors of the calibration to begin with, as another explanation has them (:attr:`Explanation.errors`).

    Notes
    -----
    Errors of the calibration have the covariance C = R R', the change the prior S, both about 0. In units of
    these, x = R y1 + B S^1/2 y2 = L y with the derivatives B of the parameters by the change, a quadratic of
    information H and gradient g has its minimum where (1 + L'HL) y = L'(H x - g): neither C nor H is
    inverted, since views may leave parameters open, and calibrations may know some exactly. The evidence is
    the Gaussian one, with the determinant of 1 + L'HL as Occam's factor (MacKay 1992).
    """
    cameras = calibrated.state.cameras
    sizes = np.zeros(0) if change is None else change.sizes(cameras, calibrated.distance_mm)
    root = covariance_root(calibrated.covariance)
    search = _Search(calibrated, change, views, root, sizes)
    errors = np.zeros(root.shape[1]) if start is None else start
    now = search.at(np.concatenate([errors, np.zeros(len(sizes))]))
    if now is None:
        return None
    now = search.end(now, floor)
    L = search.reach(now.evidence.state)
    normal = np.eye(L.shape[1]) + L.T @ now.evidence.information @ L
    inverse, at = np.linalg.inv(normal), slice(root.shape[1], None)
    return Explanation(
        change=change,
        size=search.size(now.unit),
        size_covariance=inverse[at, at] * np.outer(sizes, sizes),
        cost=now.cost,
        log_evidence=-0.5 * (now.cost + float(np.linalg.slogdet(normal)[1])),
        evidence=now.evidence,
        covariance=L @ inverse @ L.T,
        errors=now.unit[: root.shape[1]],
    )


def with_change(
    root: Float64[np.ndarray, "shared roots"], columns: Float64[np.ndarray, "rig count"]
) -> Float64[np.ndarray, "shared units"]:
    """Return columns of a change beside those of the calibration; what comes after the rig stays."""
    all_rows = np.zeros((len(root), columns.shape[1]))
    all_rows[: len(columns)] = columns
    return np.concatenate([root, all_rows], axis=1)


def covariance_root(C: Float64[np.ndarray, "n n"]) -> Float64[np.ndarray, "n roots"]:
    """Return R with R R' = C, for a covariance that may be singular."""
    scale = np.sqrt(np.maximum(np.diagonal(C), 0.0))
    unit = np.where(scale > 0.0, scale, 1.0)
    spread, axes = np.linalg.eigh(C / np.outer(unit, unit))
    kept = spread > _NOTHING * max(1.0, spread[-1])
    return np.asarray(unit[:, None] * axes[:, kept] * np.sqrt(spread[kept]))
