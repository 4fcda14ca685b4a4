"""Sub-pixel fit of one dot: a blurred step along an ellipse, with its own shading on either side."""

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.special import ndtr

from labcal.detect.grey import GreyPicture
from labcal.detect.outlines import matrix_root

_ITERATIONS = 12
_TOLERANCES = (0.05, 5e-4)  # px: change of the centre at which the first and the last round end
_BAND = (4.0, 2.0)  # half width of the fitted band: blurs, and px
_FIRST_BLUR = (0.06, 0.7, 4.0)  # of the radius, at least and at most px
_LEAST_BLUR = 0.2  # px
_HOLE_BLURS = 1.5  # blurs kept away from a ring's hole
_DOT_SHADING = 0.03  # prior standard deviation of the shading across a dot, of its step, a radius
_PARAMETERS = 12
_LAGS = 5  # px: window over which the noise of neighbouring pixels is looked at together
_TELLING = 0.5  # a dot so small that its fit leaves less of the noise's scatter cannot tell it
_SECTORS = 12
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
    observed_scatter, expected_scatter : float
        The scatter of the fit's gradient as the residuals show it, and as independent noise would give it.
        Their ratio over many dots corrects the covariances (see :func:`noise_factor`); both 0 for a dot too
        small to tell.
    """

    centre: np.ndarray
    covariance: np.ndarray
    shape: np.ndarray
    blur: float
    departure: float
    observed_scatter: float
    expected_scatter: float


@dataclass(frozen=True)
class _Band:
    """The pixels of a fit: their rectangle's corner and mask, positions and grey values."""

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

    `jacobian` holds centre 2, ellipse 3, blur 1, shading of the board 3 and of the dot 3; `normal` contains the
    prior, without which the shading inside a small dot could not be told from a shift; `along` is the change of
    grey with the distance from the outline.
    """

    residual: np.ndarray
    jacobian: np.ndarray
    normal: np.ndarray
    gradient: np.ndarray
    along: np.ndarray


def fit_edge(grey: GreyPicture, centre: np.ndarray, shape: np.ndarray, hole: float, reach: float) -> EdgeFit | None:
    """Fit ``B + (D - B) Phi(-d / blur)`` to the band of pixels around a dot's outline.

    `d` is the distance from the ellipse outward, to first order ``(rho - 1) / |grad rho|`` (Sampson 1982); `B` and
    `D`, the board and the dot, each have a linear shading. Gauss-Newton on centre, ellipse, blur and shadings.

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
        state = settled
    return _judge(state, band)


def noise_factor(fits: list[EdgeFit]) -> float:
    """Return by how much the covariances of a picture's fits are too small, at least 1.

    Demosaicing and compression tie the noise of neighbouring pixels together, and noise may differ between the
    edge and its surroundings. The scatter of the fits' gradients over windows of some pixels, pooled over all dots,
    shows both (a sandwich estimate; White 1980, Newey and West 1987).
    """
    expected = sum(fit.expected_scatter for fit in fits)
    observed = sum(fit.observed_scatter for fit in fits)
    return max(1.0, observed / expected) if expected > 0 else 1.0


def _band(grey: GreyPicture, state: _State, hole: float, reach: float) -> _Band:
    """Select the pixels near the outline, away from the hole and from other dots."""
    extent = np.sqrt(np.diag(np.linalg.inv(state.flatten @ state.flatten)))
    width = _BAND[0] * state.blur + _BAND[1]
    half = np.minimum(extent * reach, extent + width) + 1
    low = np.maximum(np.floor(state.centre - half), 0).astype(int)
    high = np.minimum(np.ceil(state.centre + half), np.array(grey.shape[::-1]) - 1).astype(int)
    patch = grey[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64)
    y, x = np.mgrid[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64)
    position = np.stack([x, y], axis=-1)
    rho, distance, *_ = _ellipse_distance(state, position.reshape(-1, 2))
    mask = (np.abs(distance) < width) & (rho < reach)
    if hole > 0:
        margin = hole + _HOLE_BLURS * state.blur / float(extent.min())
        mask &= rho > min(margin, (1 + hole) / 2)
    mask = mask.reshape(patch.shape)
    return _Band(mask, position[mask], patch[mask])


def _ellipse_distance(state: _State, position: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return rho, the distance to the outline, the direction and length of rho's gradient, and flat positions."""
    flat = (position - state.centre) @ state.flatten
    rho = np.maximum(np.sqrt((flat**2).sum(axis=1)), 1e-9)
    gradient = (flat / rho[:, None]) @ state.flatten
    slope = np.sqrt((gradient**2).sum(axis=1))
    return rho, (rho - 1) / slope, gradient / slope[:, None], flat, slope


def _linearise(state: _State, band: _Band) -> _Linear:
    """Return residuals and derivatives; the shadings enter linearly and are solved for on the way."""
    rho, distance, normal, flat, slope = _ellipse_distance(state, band.position)
    inside = ndtr(-distance / state.blur)
    outside = 1 - inside
    x, y = flat.T
    jacobian = np.empty((len(rho), _PARAMETERS))
    shading = jacobian[:, 6:]
    shading[:, 0], shading[:, 1], shading[:, 2] = outside, outside * x, outside * y
    shading[:, 3], shading[:, 4], shading[:, 5] = inside, inside * x, inside * y
    gram, target = shading.T @ shading, shading.T @ band.value
    flat_dot = np.linalg.solve(gram + 1e-9 * np.trace(gram) * np.eye(6), target)
    step = abs(float(flat_dot[3] - flat_dot[0]))
    residual = band.value - shading @ flat_dot
    variance = float(residual @ residual) / (len(rho) - _PARAMETERS)
    prior = np.zeros(_PARAMETERS)
    prior[[10, 11]] = variance / max(_DOT_SHADING * step, np.finfo(np.float32).tiny) ** 2
    coefficients = np.linalg.solve(gram + np.diag(prior[6:] + 1e-9 * np.trace(gram)), target)
    residual = band.value - shading @ coefficients
    steps = coefficients[3:] - coefficients[:3]
    along = -(steps[0] + steps[1] * x + steps[2] * y) * np.exp(-0.5 * (distance / state.blur) ** 2)
    along /= state.blur * np.sqrt(2 * np.pi)
    jacobian[:, 0:2] = -along[:, None] * normal
    # rho of the ellipse (1 + E) flat grows by flat' E flat / rho; a distance is rho over its slope.
    pull = along / (rho * slope)
    jacobian[:, 2], jacobian[:, 3], jacobian[:, 4] = pull * x * x, 2 * pull * x * y, pull * y * y
    jacobian[:, 5] = -along * distance / state.blur
    gradient = jacobian.T @ residual
    gradient[6:] = 0  # solved for already, the prior included
    return _Linear(residual, jacobian, jacobian.T @ jacobian + np.diag(prior), gradient, along)


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
        length = max(np.sqrt(change[0] ** 2 + change[1] ** 2) / (0.2 * radius), np.abs(stretch).max() / 0.2, 1.0)
        flatten = (np.eye(2) + stretch / length) @ state.flatten
        blur = float(np.clip(state.blur + change[5], state.blur / 2, state.blur * 2))
        # Turning the unit circle changes nothing: back to the symmetric matrix.
        state = _State(state.centre + change[:2] / length, matrix_root(flatten.T @ flatten), max(blur, _LEAST_BLUR))
        if state.blur > radius:
            return None
        if np.abs(change[:2]).max() < tolerance and np.abs(stretch).max() * radius < 10 * tolerance:
            return state
    return None


def _judge(state: _State, band: _Band) -> EdgeFit | None:
    """Return the fit with its uncertainty, and how well the outline is an ellipse."""
    linear = _linearise(state, band)
    residual, jacobian, along = linear.residual, linear.jacobian, linear.along
    variance = float(residual @ residual) / (len(residual) - _PARAMETERS)
    try:
        inverse = np.linalg.inv(linear.normal)
    except np.linalg.LinAlgError:
        return None
    flat = (band.position - state.centre) @ state.flatten
    sector = ((np.arctan2(flat[:, 1], flat[:, 0]) / (2 * np.pi) + 0.5) * _SECTORS).astype(int) % _SECTORS
    weight = np.bincount(sector, along**2, _SECTORS)
    moved = np.bincount(sector, along * residual, _SECTORS) / np.maximum(weight, np.finfo(float).tiny)
    # Where the true edge is no erf, the residual is the same all round: it moves no centre, and is no noise.
    bins = np.round((_ellipse_distance(state, band.position)[1]) / _PROFILE_BIN).astype(int)
    bins -= bins.min()
    residual = residual - (np.bincount(bins, residual) / np.maximum(np.bincount(bins), 1))[bins]
    observed = expected = 0.0
    independent = variance * float((jacobian[:, :2] ** 2).sum())
    products = np.zeros((*band.mask.shape, _PARAMETERS))
    score = np.zeros(band.mask.shape)
    for k in range(2):
        score[band.mask] = jacobian[:, k] * residual
        observed += float((score * _windows(score)).sum())
        # Residuals are orthogonal to the Jacobian, so even independent noise scatters less than J'J says.
        products[band.mask] = jacobian * jacobian[:, k : k + 1]
        tied = products.reshape(-1, _PARAMETERS).T @ _windows(products).reshape(-1, _PARAMETERS)
        expected += variance * float((jacobian[:, k] ** 2).sum() - (inverse * tied).sum())
    if expected < _TELLING * independent:
        observed = expected = 0.0
    return EdgeFit(
        centre=state.centre,
        covariance=variance * (inverse[:2, :2] + inverse[:2, :2].T) / 2,
        shape=np.linalg.inv(state.flatten @ state.flatten),
        blur=state.blur,
        departure=float(np.sqrt((moved**2).mean())),
        observed_scatter=observed,
        expected_scatter=expected,
    )


def _windows(values: np.ndarray) -> np.ndarray:
    """Return the sums over the window around every pixel."""
    return np.asarray(cv2.boxFilter(values, -1, (_LAGS, _LAGS), normalize=False, borderType=cv2.BORDER_CONSTANT))
