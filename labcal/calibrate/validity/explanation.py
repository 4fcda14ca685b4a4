"""The best explanation of new views by one kind of change, or by none: calibration as prior, Gauss-Newton."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.calibrate.validity.change import Change
from labcal.calibrate.validity.evidence import Evidence, NewViews
from labcal.errors import InputError

_MOST_STEPS = 15
_ARRIVED = 1e-2
"""Decrease of the cost below which a step is the last one, in units of a squared standard deviation."""
_HALVINGS = 6
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
        In the order of ``rig.json``.
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
    """

    change: Change | None
    size: Float64[np.ndarray, " count"]
    size_covariance: Float64[np.ndarray, "count count"]
    cost: float
    log_evidence: float
    evidence: Evidence
    covariance: Float64[np.ndarray, "shared shared"]


@dataclass(frozen=True)
class _Standing:
    """A point on the way: errors of the calibration are ``covariance @ dual``."""

    dual: Float64[np.ndarray, " shared"]
    size: Float64[np.ndarray, " count"]
    cost: float
    evidence: Evidence


def explained(
    calibrated: Calibrated, change: Change | None, views: NewViews, floor: float = np.inf
) -> Explanation | None:
    """Return the best explanation by a kind of change; None where none images all dots.

    Parameters
    ----------
    calibrated : Calibrated
    change : Change or None
        None of a rig that is as it was.
    views : NewViews
    floor : float
        Cost of an explanation that is known: what is far worse need not be exact.

    Notes
    -----
    Errors e of the calibration have the covariance C, the change of size s has the prior S, both about 0.
    With the derivatives B of the parameters by s the sum e + B s has the covariance P = C + B S B', and the
    minimum of a quadratic of information H and gradient g about x is P z with (1 + H P) z = H x - g, which
    inverts neither C nor H: views may leave parameters open, and calibrations may know some exactly. The
    evidence is the Gaussian one, with the determinant of 1 + H P as Occam's factor (MacKay 1992).
    """
    C = calibrated.covariance
    count = 0 if change is None else change.count
    sizes = (
        np.zeros(0) if change is None else change.sizes(calibrated.state.cameras, calibrated.distance_mm) ** 2
    )

    def standing(dual: np.ndarray, size: np.ndarray) -> _Standing | None:
        try:
            state = calibrated.state if change is None else change.applied(calibrated.state, size)
            state = _stepped(state, C @ dual)
        except InputError:
            return None
        evidence = views.evidence(state)
        if evidence is None:
            return None
        prior = float(dual @ C @ dual) + float((size**2 / sizes).sum())
        return _Standing(dual, size, evidence.cost + prior, evidence)

    now = standing(np.zeros(len(C)), np.zeros(count))
    if now is None:
        return None
    for _ in range(_MOST_STEPS):
        B = _columns(change, now.evidence.state, len(C))
        P = C + (B * sizes) @ B.T
        x = C @ now.dual + B @ now.size
        H = now.evidence.information
        z = _Damped.of(H, P).inverse @ (H @ x - now.evidence.gradient)
        goal = (z, sizes * (B.T @ z))
        best = now
        share = 1.0
        for _ in range(_HALVINGS):
            tried = standing(now.dual + share * (goal[0] - now.dual), now.size + share * (goal[1] - now.size))
            if tried is not None and tried.cost < now.cost:
                best = tried
                break
            share *= 0.5
        gain, now = now.cost - best.cost, best
        if gain < max(_ARRIVED, _HOPELESS * (now.cost - floor)):
            break
    H, B = now.evidence.information, _columns(change, now.evidence.state, len(C))
    P = C + (B * sizes) @ B.T
    whole = _Damped.of(H, P)
    evidence = -0.5 * (now.cost + whole.log_det)
    after = P @ whole.inverse
    # Of the size: what the pictures say once the calibration's own errors have followed.
    seen = B.T @ _Damped.of(H, C).inverse @ H @ B
    size_covariance = np.linalg.inv(np.diag(1.0 / sizes) + 0.5 * (seen + seen.T))
    return Explanation(change, now.size, size_covariance, now.cost, evidence, now.evidence, after)


def _stepped(state: RigState, shared: Float64[np.ndarray, " shared"]) -> RigState:
    """Return a state with other parameters of the cameras."""
    layout = Layout(state, Freedom(Lenses.FREE, np.zeros((state.dots.size, 0))))
    return layout.stepped(shared, np.zeros((len(state.T_world_target), 6)))


def _columns(change: Change | None, state: RigState, shared: int) -> Float64[np.ndarray, "shared count"]:
    return np.zeros((shared, 0)) if change is None else change.columns(state)


@dataclass(frozen=True)
class _Damped:
    """The matrix 1 + H P, in units in which all variances of P are 1."""

    inverse: Float64[np.ndarray, "n n"]
    log_det: float

    @classmethod
    def of(cls, H: Float64[np.ndarray, "n n"], P: Float64[np.ndarray, "n n"]) -> "_Damped":
        """Return its inverse, in the parameters' own units, and the logarithm of its determinant."""
        variance = np.diagonal(P)
        s = np.sqrt(np.where(variance > 0.0, variance, 1.0))
        M = np.eye(len(P)) + (H * np.outer(s, s)) @ (P / np.outer(s, s))
        return cls(np.linalg.inv(M) * s[None, :] / s[:, None], float(np.linalg.slogdet(M)[1]))
