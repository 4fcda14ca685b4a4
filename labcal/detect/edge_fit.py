"""Sub-pixel fit of dots: a blurred step along an ellipse, with its own shading on either side."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.edges.certainty import CERTAINTY
from labcal.detect.edges.edge_limits import EdgeLimits, PictureLimits
from labcal.detect.edges.edge_model import STATE
from labcal.detect.edges.gauss_newton import fit_all
from labcal.detect.edges.harmonics import KeptFits
from labcal.detect.edges.light_sums import light_slopes
from labcal.detect.edges.neighbours import any_near, apart
from labcal.detect.edges.noise import noise_factor
from labcal.detect.edges.one_light import OneLight
from labcal.detect.edges.outline_noise import outline_noise
from labcal.detect.edges.residuals import (
    BURNT,
    CLIPPED,
    COLUMNS,
    DEPARTURE,
    LAGS,
    PROFILE,
    SUMS,
    VARIANCE,
    ResidualLimits,
)
from labcal.detect.grey import GreyPicture, clipping
from labcal.detect.matrices import inverses, mapped, matrix_roots
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.edge import EdgeSettings

_DEFAULTS = EdgeSettings()
_SAME = np.eye(2)[None]


@dataclass(frozen=True)
class EdgeFits:
    """The fits of a picture's dots; NaN where a dot is not fitted.

    Attributes
    ----------
    ok : ndarray of bool, shape (n,)
        True if the fit converged to an ellipse near its beginning.
    centre : ndarray, shape (n, 2)
        Centres of area of the outer outlines, px.
    covariance : ndarray, shape (n, 2, 2)
        Of `centre`, px squared, from the residuals of the dot itself, and from how the noise along the
        outlines of the picture differs from white noise.
    shape : ndarray, shape (n, 2, 2)
        Outline matrices, see `PictureDots.outline`.
    blur : ndarray, shape (n,)
        Standard deviation of the edge, px.
    departure : ndarray, shape (n,)
        Root mean square distance of the outline from the ellipse over twelve sectors, px.
    clipped : ndarray, shape (n,)
        How one-sidedly the picture clips the board beside the edge, or the dot, 0 to 1.
    burnt : ndarray, shape (n,)
        How much more of the brighter side is clipped than of the darker one, -1 to 1.
    profile : ndarray, shape (n,)
        By how much of the step the profile across the edge is no error function, root mean square.
    board, dot : ndarray, shape (n,)
        Grey values on either side of the edge, above no light.
    light_slope : ndarray, shape (n, 2)
        Change of the light on the board, as a share of it, a px.
    variance : ndarray, shape (n,)
        Of the residuals, in grey values squared.
    noise_factor : float
        Variance of the noise along the outlines, as it moves a centre, over that of white noise with the
        variance of the residuals.
    """

    ok: Mask
    centre: Pixels
    covariance: PixelCovariances
    shape: PixelCovariances
    blur: Float64[np.ndarray, " n"]
    departure: Float64[np.ndarray, " n"]
    clipped: Float64[np.ndarray, " n"]
    burnt: Float64[np.ndarray, " n"]
    profile: Float64[np.ndarray, " n"]
    board: Float64[np.ndarray, " n"]
    dot: Float64[np.ndarray, " n"]
    light_slope: Pixels
    variance: Float64[np.ndarray, " n"]
    noise_factor: float


def fit_edges(
    grey: GreyPicture,
    spots: Outlines,
    hole: Float64[np.ndarray, " n"],
    reach: float,
    black: float = 0.0,
    settings: EdgeSettings = _DEFAULTS,
) -> EdgeFits:
    """Fit ``B + (D - B) Phi(-d / blur)`` to the band of pixels around every dot's outline.

    `d` is the distance from the ellipse outward, to first order ``(rho - 1) / |grad rho|`` (Sampson 1982);
    `B` and `D`, the board and the dot, each have a linear shading. Gauss-Newton on centre, ellipse, blur and
    shadings.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture, dots darker than the board.
    spots : Outlines
        Where to begin: within some tenths of the radius.
    hole : ndarray, shape (n,)
        Radius of a ring's hole over its outer radius, which is left out of the fit; 0 for a full dot.
    reach : float
        How far, in radii, no other dot is met.
    black : float
        Grey value of no light: the largest one of a negative.
    settings : EdgeSettings
    """
    count = len(spots.centre)
    flatten = inverses(matrix_roots(spots.shape))
    table = np.zeros((count, COLUMNS))
    table[:, :2] = spots.centre
    table[:, 2], table[:, 3], table[:, 4] = flatten[:, 0, 0], flatten[:, 0, 1], flatten[:, 1, 1]
    table[:, 5] = np.clip(spots.blur, settings.first_blur_px, settings.max_first_blur_radii * spots.radius)
    begun = table.copy()
    every = max(1, -(-count // settings.noise_dots))
    sums = np.zeros((-(-count // every), LAGS, SUMS))
    outlines_every = max(1, -(-count // settings.noise_outlines))
    clipped = clipping(grey, settings.clipped_value_share)
    picture = PictureLimits(reach, *clipped, black, every, outlines_every)
    limits = settings.limits(EdgeLimits), settings.limits(ResidualLimits)
    certainty = np.zeros((count, CERTAINTY))
    ok, pixels, places = fit_all(grey, table, hole, picture, limits, (sums, certainty))
    for _ in range(settings.neighbour_rounds):
        if not any_near(table, ok, reach, settings.near_neighbour_blurs):
            break
        alone = apart(grey, table, ok, hole)
        sums[:], certainty[:], table[~ok] = 0.0, 0.0, begun[~ok]
        ok, pixels, places = fit_all(alone, table, hole, picture, limits, (sums, certainty))
    table[~ok] = np.nan
    flat = noise_factor(sums, settings)
    light = OneLight.of(table, flat, settings)
    some = np.flatnonzero(ok)
    some = some[some % outlines_every == 0]
    weights = light.select(some).weights(table[some], black)
    kept = KeptFits(weights, certainty[some], pixels, places[some])
    noise = outline_noise(table[some], kept, flat, settings)
    F = np.ascontiguousarray(table[:, [2, 3, 3, 4]]).reshape(-1, 2, 2)
    covariance = light.covariances(table, noise.factor)
    if noise.factor != 1.0:
        root = matrix_roots(noise.by_direction[None])
        covariance = mapped(root, covariance)
        covariance[:, 1, 0] = covariance[:, 0, 1]  # but for the last bit they are the same
    in_steps = table[:, 5] <= settings.min_blur_px  # the outline runs from pixel to pixel
    stepped = np.where(in_steps, settings.stepped_variance_px3 / spots.radius, 0.0)
    covariance[:, 0, 0] += stepped
    covariance[:, 1, 1] += stepped
    board, dot = np.abs(table[:, [STATE, STATE + 3]] - black).T
    return EdgeFits(
        ok=ok,
        centre=light.centres(table),
        covariance=covariance,
        shape=inverses(mapped(F, _SAME)),
        blur=table[:, 5],
        departure=table[:, DEPARTURE],
        clipped=table[:, CLIPPED],
        burnt=table[:, BURNT],
        profile=table[:, PROFILE],
        board=board,
        dot=dot,
        light_slope=light_slopes(table, board),
        variance=table[:, VARIANCE],
        noise_factor=noise.factor,
    )
