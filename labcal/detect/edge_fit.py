"""Sub-pixel fit of one dot: a blurred step along an ellipse, with its own shading on either side."""

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.special import ndtr

from labcal.detect.grey import GreyPicture
from labcal.detect.noise import Scatter
from labcal.detect.outlines import matrix_root

_ITERATIONS = 12
_TOLERANCES = (0.05, 5e-4)  # px: change of the centre at which the first and the last round end
_BAND = (3.5, 2.0)  # half width of the fitted band: blurs, and px
_FIRST_BLUR = (0.06, 0.7, 4.0)  # of the radius, at least and at most px
_LEAST_BLUR = 0.2  # px
_HOLE_BLURS = 1.5  # blurs kept away from a ring's hole
_DOT_SHADING = 0.03  # prior standard deviation of the shading across a dot, of its step, a radius
_PARAMETERS = 12
_CLUTTER = (5.0, 0.08, 2.0)  # standard deviations, and of the step, that clutter differs; blurs from the edge
_FLAT = 2.5  # blurs from the edge: beyond is dot or board only
_SECTORS = 12
_TINY = float(np.finfo(np.float32).tiny)
_HIGHEST_ORDER, _SHORTEST_WAVE = 12, 8.0  # waves around the outline, and px along it, that are not noise
_PROFILE_BIN = 0.5  # px


@dataclass(frozen=True)
class EdgeFit:
    """The fit of one dot.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Centre of area of the outer outline, px.
    covariance : ndarray, shape (2, 2)
        Of `centre`, px squared, for noise that is independent from pixel to pixel.
    shape : ndarray, shape (2, 2)
        Outline matrix, see `PictureDots.outline`.
    blur : float
        Standard deviation of the edge, px.
    departure : float
        Root mean square distance of the outline from the ellipse over twelve sectors, px.
    scatter : Scatter
        What the residuals of this dot tell of the noise.
    """

    centre: np.ndarray
    covariance: np.ndarray
    shape: np.ndarray
    blur: float
    departure: float
    scatter: Scatter


@dataclass(frozen=True)
class _Band:
    """The pixels of a fit: their mask in their rectangle, positions (2, n) and grey values."""

    mask: np.ndarray
    position: np.ndarray
    value: np.ndarray


@dataclass(frozen=True)
class _State:
    """Centre, symmetric matrix that maps the outline to the unit circle, and blur."""

    centre: np.ndarray
    flatten: np.ndarray
    blur: float


@dataclass(frozen=True)
class _Linear:
    """The problem around a state.

    `jacobian` holds centre 2, ellipse 3, blur 1, shading of the board 3 and of the dot 3, in rows; `normal`
    contains the prior, without which the shading inside a small dot could not be told from a shift; `along`
    is the change of grey with the distance from the outline.
    """

    residual: np.ndarray
    jacobian: np.ndarray
    normal: np.ndarray
    gradient: np.ndarray
    along: np.ndarray


def fit_edge(
    grey: GreyPicture, centre: np.ndarray, shape: np.ndarray, hole: float, reach: float
) -> EdgeFit | None:
    """Fit ``B + (D - B) Phi(-d / blur)`` to the band of pixels around a dot's outline.

    `d` is the distance from the ellipse outward, to first order ``(rho - 1) / |grad rho|`` (Sampson 1982);
    `B` and `D`, the board and the dot, each have a linear shading. Gauss-Newton on centre, ellipse, blur and
    shadings.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture, dots darker than the board.
    centre, shape : ndarray, shapes (2,) and (2, 2)
        Where to begin: within some tenths of the radius.
    hole : float
        Radius of a ring's hole over its outer radius, which is left out of the fit; 0 for a full dot.
    reach : float
        How far, in radii, no other dot is met.

    Returns
    -------
    EdgeFit or None
        None where the fit does not settle on an ellipse near the beginning.
    """
    radius = float(np.sqrt(np.sqrt(np.linalg.det(shape))))
    blur = float(np.clip(_FIRST_BLUR[0] * radius, _FIRST_BLUR[1], _FIRST_BLUR[2]))
    state = _State(centre, np.linalg.inv(matrix_root(shape)), blur)
    for tolerance in _TOLERANCES:  # the band follows the blur once that is known
        band = _band(grey, state, hole, reach)
        if len(band.value) < 3 * _PARAMETERS:
            return None
        settled = _settle(state, band, tolerance)
        if settled is None or np.linalg.norm(settled.centre - centre) > radius / 2:
            return None
        state, band = settled, _without_clutter(settled, band)
    settled = _settle(state, band, _TOLERANCES[-1])
    return None if settled is None else _judge(settled, band)


def _band(grey: GreyPicture, state: _State, hole: float, reach: float) -> _Band:
    """Select the pixels near the outline, away from the hole and from other dots."""
    extent = np.sqrt(np.diag(np.linalg.inv(state.flatten @ state.flatten)))
    width = _BAND[0] * state.blur + _BAND[1]
    half = np.minimum(extent * reach, extent + width) + 1
    low = np.maximum(np.floor(state.centre - half), 0).astype(int)
    high = np.minimum(np.ceil(state.centre + half), np.array(grey.shape[::-1]) - 1).astype(int)
    patch = grey[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64)
    y, x = np.mgrid[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64)
    position = np.stack([x.ravel(), y.ravel()])
    rho, distance, *_ = _ellipse_distance(state, position)
    mask = (np.abs(distance) < width) & (rho < reach)
    if hole > 0:
        margin = hole + _HOLE_BLURS * state.blur / float(extent.min())
        mask &= rho > min(margin, (1 + hole) / 2)
    return _Band(mask.reshape(patch.shape), position[:, mask], patch.ravel()[mask])


def _without_clutter(state: _State, band: _Band) -> _Band:
    """Leave out what is neither dot nor board: dirt, glare, other marks, all away from the edge."""
    linear = _linearise(state, band)
    distance = _ellipse_distance(state, band.position)[1]
    size = np.abs(linear.residual)
    step = float(np.ptp(band.value))
    odd = (size > max(_CLUTTER[0] * 1.4826 * float(np.median(size)), _CLUTTER[1] * step)) & (
        np.abs(distance) > _CLUTTER[2] * state.blur
    )
    if not odd.any():
        return band
    spread = np.zeros(band.mask.shape, dtype=np.uint8)
    spread[band.mask] = odd
    near = cv2.dilate(spread, np.ones((5, 5), np.uint8))[band.mask] > 0
    keep = ~(near & (np.abs(distance) > _CLUTTER[2] * state.blur))
    mask = band.mask.copy()
    mask[band.mask] = keep
    return _Band(mask, band.position[:, keep], band.value[keep])


def _ellipse_distance(state: _State, position: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return rho, the distance to the outline, direction and length of rho's gradient, flat positions."""
    flat = state.flatten @ (position - state.centre[:, None])
    rho = np.maximum(np.sqrt(flat[0] ** 2 + flat[1] ** 2), 1e-9)
    gradient = state.flatten @ flat / rho
    slope = np.sqrt(gradient[0] ** 2 + gradient[1] ** 2)
    slope = np.maximum(slope, 1e-3 * state.flatten[0, 0])  # it is 0 at the centre
    return rho, (rho - 1) / slope, gradient / slope, flat, slope


def _linearise(state: _State, band: _Band) -> _Linear:
    """Return residuals and derivatives; the shadings enter linearly and are solved for on the way."""
    rho, distance, normal, flat, slope = _ellipse_distance(state, band.position)
    inside = ndtr(-distance / state.blur)
    outside = 1 - inside
    x, y = flat
    jacobian = np.empty((_PARAMETERS, len(rho)))
    shading = jacobian[6:]
    shading[0], shading[1], shading[2] = outside, outside * x, outside * y
    shading[3], shading[4], shading[5] = inside, inside * x, inside * y
    gram, target = shading @ shading.T, shading @ band.value
    ridge = 1e-9 * np.trace(gram)
    plain = np.linalg.solve(gram + ridge * np.eye(6), target)
    residual = band.value - plain @ shading
    variance = float(residual @ residual) / (len(rho) - _PARAMETERS)
    prior = np.zeros(_PARAMETERS)
    prior[[10, 11]] = variance / max(_DOT_SHADING * abs(float(plain[3] - plain[0])), _TINY) ** 2
    coefficients = np.linalg.solve(gram + np.diag(prior[6:] + ridge), target)
    residual = band.value - coefficients @ shading
    steps = coefficients[3:] - coefficients[:3]
    along = -(steps[0] + steps[1] * x + steps[2] * y) * np.exp(-0.5 * (distance / state.blur) ** 2)
    along /= state.blur * np.sqrt(2 * np.pi)
    jacobian[0], jacobian[1] = -along * normal[0], -along * normal[1]
    # rho of the ellipse (1 + E) flat grows by flat' E flat / rho; a distance is rho over its slope.
    pull = along / (rho * slope)
    jacobian[2], jacobian[3], jacobian[4] = pull * x * x, 2 * pull * x * y, pull * y * y
    jacobian[5] = -along * distance / state.blur
    gradient = jacobian @ residual
    gradient[6:] = 0  # solved for already, the prior included
    return _Linear(residual, jacobian, jacobian @ jacobian.T + np.diag(prior), gradient, along)


def _settle(state: _State, band: _Band, tolerance: float) -> _State | None:
    """Iterate to the least squares; None where it runs away."""
    radius = 1 / np.sqrt(np.linalg.det(state.flatten))
    for _ in range(_ITERATIONS):
        linear = _linearise(state, band)
        try:
            change = np.linalg.solve(linear.normal, linear.gradient)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(change).all():
            return None
        # A step that leaves the region where the linearisation means anything is shortened.
        stretch = np.array([[change[2], change[3]], [change[3], change[4]]])
        length = max(
            np.sqrt(change[0] ** 2 + change[1] ** 2) / (0.2 * radius), np.abs(stretch).max() / 0.2, 1.0
        )
        flatten = (np.eye(2) + stretch / length) @ state.flatten
        blur = float(np.clip(state.blur + change[5], state.blur / 2, state.blur * 2))
        # Turning the unit circle changes nothing: back to the symmetric matrix.
        state = _State(
            state.centre + change[:2] / length, matrix_root(flatten.T @ flatten), max(blur, _LEAST_BLUR)
        )
        if state.blur > radius:
            return None
        if np.abs(change[:2]).max() < tolerance and np.abs(stretch).max() * radius < 10 * tolerance:
            return state
    return None


def _judge(state: _State, band: _Band) -> EdgeFit | None:
    """Return the fit with its uncertainty, and how well the outline is an ellipse."""
    linear = _linearise(state, band)
    rho, distance, _, flat, _ = _ellipse_distance(state, band.position)
    angle = np.arctan2(flat[1], flat[0])
    sector = ((angle / (2 * np.pi) + 0.5) * _SECTORS).astype(int) % _SECTORS
    weight = np.bincount(sector, linear.along**2, _SECTORS)
    moved = np.bincount(sector, linear.along * linear.residual, _SECTORS) / np.maximum(weight, _TINY)

    # What is the same at every sight of this dot (a print that is no circle, an edge that is no erf) is no
    # noise.
    perimeter = 2 * np.pi / np.sqrt(np.linalg.det(state.flatten))
    orders = np.arange(3, min(_HIGHEST_ORDER, int(perimeter / _SHORTEST_WAVE)) + 1)
    direction: np.ndarray = (flat[0] + 1j * flat[1]) / rho
    waves = np.power(direction, orders[:, None]) * linear.along
    basis = np.concatenate([linear.jacobian, waves.real, waves.imag])
    normal = basis @ basis.T
    normal[:_PARAMETERS, :_PARAMETERS] = linear.normal
    try:
        inverse = np.linalg.inv(linear.normal)[:2, :2]
        noise = linear.residual - np.linalg.solve(normal, basis @ linear.residual) @ basis
    except np.linalg.LinAlgError:
        return None
    bins = np.round(distance / _PROFILE_BIN).astype(int)
    bins -= bins.min()
    noise = noise - (np.bincount(bins, noise) / np.maximum(np.bincount(bins), 1))[bins]
    freedom = len(noise) - len(basis) - len(np.unique(bins))
    if freedom < _PARAMETERS:
        return None
    variance = float(noise @ noise) / freedom
    return EdgeFit(
        centre=state.centre,
        covariance=variance * (inverse + inverse.T) / 2,
        shape=np.linalg.inv(state.flatten @ state.flatten),
        blur=state.blur,
        departure=float(np.sqrt((moved**2).mean())),
        scatter=_scatter(band, linear, np.abs(distance) > _FLAT * state.blur),
    )


def _scatter(band: _Band, linear: _Linear, flat: np.ndarray) -> Scatter:
    """Spread residuals and gradients over the rectangle of the fit."""
    residual = np.zeros(band.mask.shape)
    residual[band.mask] = np.where(flat, linear.residual, 0.0)
    gradient = np.zeros((2, *band.mask.shape))
    gradient[:, band.mask] = linear.jacobian[:2]
    where = band.mask.copy()
    where[band.mask] = flat
    return Scatter(residual, where, gradient)
