"""A frame by points whose coordinates in it are known, fitted by generalised least squares."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Matrix3, PointCovariances, Vectors3
from labcal.distributions import chi2_upper_quantile
from labcal.errors import InputError
from labcal.geometry.covariances import covariance_root
from labcal.geometry.poses import from_rotation_vector, nearest_rotation
from labcal.reconstruct.frames.by_points import on_a_line, require_turn
from labcal.reconstruct.frames.fitted_frame import FittedFrame, FrameCalibration, FrameKind, by_parameters
from labcal.wording import listed

_FEWEST = 3
_ON_A_LINE = 1e-9
_STEPS = 100
_ARRIVED = 1e-12
"""Step (radians, mm over the spread of the points) below which the next one is of no use."""
_SCALES = (1e-6, 1e6)
"""Scales of a similarity that are sensible, whatever the units."""
_UNLIKELY = 1e-3
"""Probability of residuals as large by the covariances alone, below which a warning is due."""


@dataclass(frozen=True)
class CameraShare:
    """Errors of measured points by the cameras."""

    by_cameras: Float64[np.ndarray, "n 3 cameras"]
    """Derivatives by the cameras' parameters."""
    covariance: Float64[np.ndarray, "cameras cameras"]
    """Joint covariance of these."""


@dataclass(frozen=True)
class MeasuredKnown:
    """Points that are measured in the model's world a and known in the frame b."""

    view: str
    names: tuple[str, ...]
    measured: Vectors3
    """(n, 3), in a, mm."""
    covariance: PointCovariances
    """(n, 3, 3), of `measured` by its noise, mm squared."""
    known: Vectors3
    """(n, 3), in b, mm."""
    known_covariance: PointCovariances
    """(n, 3, 3), of `known`, mm squared; 0 where it counts as exact."""
    by_cameras: CameraShare | None = None
    """The cameras' share in the errors of `measured`; None where they count as exact."""

    @property
    def sources(self) -> str:
        """The errors that the covariances hold, at the end of a sentence."""
        if self.by_cameras is None:
            return "the noise of pixels alone, not errors of the calibration or of the known places"
        return "the noise of pixels and the calibration, not more than is stated of the known places"

    def carried(self, by_point: Matrix3) -> Float64[np.ndarray, "n 3 cameras"]:
        """Return errors in b by one standard deviation along each direction of the cameras' covariance."""
        if self.by_cameras is None:
            return np.zeros((len(self.names), 3, 0))
        share = self.by_cameras
        return np.asarray(by_point @ share.by_cameras @ covariance_root(share.covariance))


def frame_by_known(kind: FrameKind, given: MeasuredKnown) -> FittedFrame:
    """Return the frame that fits known points best.

    Parameters
    ----------
    kind : FrameKind
        With a scale that is fitted for `SIMILARITY`, else without.
    given : MeasuredKnown
        Three points or more.

    Raises
    ------
    InputError
        There are fewer than three points, they lie on a line, exactly or within their uncertainty, or no
        frame brings them near each other.

    Notes
    -----
    Starts from the closed form (Umeyama 1991, "Least-squares estimation of transformation parameters between
    two point patterns", IEEE PAMI 13), then Gauss-Newton with each point weighted by the inverse of both its
    covariances, in b. The derivatives of the parameters by the points are those of the normal equations.
    """
    if len(given.names) < _FEWEST:
        raise InputError(
            f"A frame by known points takes 3 points that were measured in the same view, but there are "
            f"{len(given.names)}. Give the coordinates of more of the measured points."
        )
    start = _closed_form(kind, given)
    try:
        with np.errstate(all="ignore"):
            return _fitted(kind, given, *_refined(kind, given, *start))
    except np.linalg.LinAlgError as error:
        raise _no_fit(given) from error


def _refined(
    kind: FrameKind, given: MeasuredKnown, R_ba: np.ndarray, t_ba: np.ndarray, scale: float
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return rotation, translation and scale by Gauss-Newton from a start."""
    parameters = 7 if kind is FrameKind.SIMILARITY else 6
    spread = float(np.abs(given.known - given.known.mean(axis=0)).max())
    for _ in range(_STEPS):
        turned = scale * given.measured @ R_ba.T
        # Rotations are about the middle of the points while fitting, so that steps are of one size.
        middle = turned.mean(axis=0)
        H = by_parameters(turned - middle, parameters)
        weight = np.linalg.inv(_total_covariance(given, scale * R_ba))
        off = turned + t_ba - given.known
        HW = H.swapaxes(1, 2) @ weight
        step = -np.linalg.solve((HW @ H).sum(axis=0), (HW @ off[:, :, None]).sum(axis=0)[:, 0])
        turn = from_rotation_vector(step[:3], np.zeros(3))[:3, :3]
        stretch = float(np.exp(step[6])) if parameters > 6 else 1.0  # noqa: PLR2004 -- with a scale
        t_ba = t_ba + middle + step[3:6] - stretch * turn @ middle
        R_ba, scale = turn @ R_ba, stretch * scale
        if not (np.isfinite(step).all() and _SCALES[0] <= scale <= _SCALES[1]):
            break
        if max(np.abs(step[:3]).max(), np.abs(step[3:6]).max() / spread, abs(stretch - 1.0)) < _ARRIVED:
            return R_ba, t_ba, scale
    raise _no_fit(given)


def _no_fit(given: MeasuredKnown) -> InputError:
    """Return the error for known points that are not those that were measured."""
    return InputError(
        f"No frame brings the {len(given.names)} measured points near their known places "
        f"({listed(given.names)}). Compare names, units and signs of the table of known points."
    )


def _closed_form(kind: FrameKind, given: MeasuredKnown) -> tuple[np.ndarray, np.ndarray, float]:
    """Return rotation, translation and scale by Umeyama's closed form, all points alike."""
    middle_a, middle_b = given.measured.mean(axis=0), given.known.mean(axis=0)
    a, b = given.measured - middle_a, given.known - middle_b
    for points in (a, b):
        spread = np.linalg.svd(points, compute_uv=False)
        if spread[1] <= _ON_A_LINE * spread[0] or spread[0] == 0.0:
            raise on_a_line(given.names)
    R_ba, stretch = nearest_rotation(b.T @ a)
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(b.T @ a)) or 1.0])
    scale = float((stretch * signs).sum() / (a**2).sum()) if kind is FrameKind.SIMILARITY else 1.0
    return R_ba, middle_b - scale * R_ba @ middle_a, scale


def _total_covariance(given: MeasuredKnown, by_point: np.ndarray) -> PointCovariances:
    return np.asarray(by_point @ given.covariance @ by_point.T + given.known_covariance)


def _fitted(
    kind: FrameKind, given: MeasuredKnown, R_ba: np.ndarray, t_ba: np.ndarray, scale: float
) -> FittedFrame:
    """Return the frame with the derivatives of its parameters, residuals and warnings."""
    by_point = scale * R_ba
    turned = given.measured @ by_point.T
    H = by_parameters(turned, 7 if kind is FrameKind.SIMILARITY else 6)
    weight = np.linalg.inv(_total_covariance(given, by_point))
    HW = H.swapaxes(1, 2) @ weight
    gain = -np.linalg.solve((HW @ H).sum(axis=0), HW)
    residual = turned + t_ba - given.known
    chi_square = _chi_square(residual, weight, H, given.carried(by_point))
    freedom = residual.size - H.shape[2]
    sigma0 = float(np.sqrt(chi_square / freedom)) if freedom > 0 else None
    rms_mm, warnings = float(np.sqrt((residual**2).sum(axis=1).mean())), []
    if sigma0 is not None and chi_square > chi2_upper_quantile(_UNLIKELY, freedom):
        warnings.append(
            f"the points that determine the frame lie {rms_mm:.3g} mm RMS off their known places, "
            f"{sigma0:.2g} times what their covariances explain: these hold {given.sources}. The frame's "
            "sigmas are too small by as much"
        )
    known = (gain @ given.known_covariance @ gain.swapaxes(1, 2)).sum(axis=0)
    share = given.by_cameras
    frame = FittedFrame(
        kind, given.view, given.names, R_ba, t_ba, scale, gain @ by_point, given.covariance, known,
        turned.mean(axis=0) + t_ba, residual, sigma0, tuple(warnings),
        None if share is None else FrameCalibration(
            np.einsum("kpi,kic->pc", gain @ by_point, share.by_cameras), share.covariance
        ),
    )  # fmt: skip
    require_turn(frame, given.names)
    return frame


def _chi_square(
    residual: Vectors3,
    weight: PointCovariances,
    H: Float64[np.ndarray, "n 3 parameters"],
    carried: Float64[np.ndarray, "n 3 cameras"],
) -> float:
    """Return the least chi-square of residuals over the frame's parameters and the cameras' errors.

    The latter are unknowns with a standard deviation of 1 each, so that errors that all points share are
    weighed by their joint covariance without its inverse.
    """
    design = np.concatenate([H, carried], axis=2)
    weighted = design.swapaxes(1, 2) @ weight
    normal = (weighted @ design).sum(axis=0)
    normal[H.shape[2] :, H.shape[2] :] += np.eye(carried.shape[2])
    right = (weighted @ residual[:, :, None]).sum(axis=0)[:, 0]
    square = float(np.einsum("ni,nij,nj->", residual, weight, residual))
    return square if carried.shape[2] == 0 else square - float(right @ np.linalg.solve(normal, right))
