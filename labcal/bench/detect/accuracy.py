"""Accuracy of measured dots: errors over the Cramer-Rao bound, bias, and stated covariances."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2, norm

from labcal.arrays import PixelCovariances, Pixels
from labcal.bench.detect.lit_board import LitBoard, lit_board
from labcal.bench.detect.plain_centres import blob_centres, contour_centres
from labcal.bench.groups import Bench, Findings
from labcal.detect.detector import detect_dots
from labcal.report.bench import Check, Figure, at_most
from labcal.rng import generator

RADII_PX = (6.0, 8.0, 10.0, 20.0, 40.0)
TILTS_DEG, QUICK_TILTS_DEG = (5.0, 25.0, 45.0, 60.0), (10.0, 60.0)
NOISES = (0.01, 0.03)
"""Standard deviation of every pixel, as a share of full scale."""
SPP, QUICK_SPP = 512, 256
DOTS = 400
"""About so many measurements for every radius, tilt and noise, by drawing noise again."""
MOST_RATIO = 1.2
MOST_BIAS_PX = {6.0: 0.005, 8.0: 0.005}
"""From a radius of 10 px on it is 0.002 px."""
LEAST_BIAS_LIMIT_PX = 0.002
SIGMAS = float(norm.isf(0.0005))
"""The bound that a normal variable exceeds with a probability of 0.1%."""
FULL = 255.0
ROUNDING = 1.0 / 12.0
"""Variance of rounding to whole levels."""


@dataclass(frozen=True)
class Errors:
    """Measured minus true centroids, px; NaN where there is no measurement."""

    labcal: Pixels
    """(n, 2)."""
    covariance: PixelCovariances
    """(n, 2, 2), as stated by labcal, px squared."""
    bound: PixelCovariances
    """(n, 2, 2), the least covariance possible, px squared."""
    blob: Pixels
    """(n, 2), of OpenCV's blob detector."""
    contour: Pixels
    """(n, 2), of an ellipse through the contour of a threshold."""


def accuracy_findings(bench: Bench) -> Findings:
    """Return ratios to the bound, biases and chi-square by radius and noise, and those of OpenCV."""
    tilts, spp = (QUICK_TILTS_DEG, QUICK_SPP) if bench.quick else (TILTS_DEG, SPP)
    bench.progress.start("accuracy", len(RADII_PX) * len(tilts))
    checks, references = [], []
    for radius in RADII_PX:
        parts: list[list[Errors]] = [[] for _ in NOISES]
        for tilt in tilts:
            board = lit_board(radius, tilt, spp, bench.seed)
            for noise, part in zip(NOISES, parts, strict=True):
                part.append(measured_errors(board, noise, DOTS, bench.seed))
            bench.progress.advance()
        for noise, part in zip(NOISES, parts, strict=True):
            name = f"dots of {radius:g} px, {noise:.0%} noise"
            errors = _joined(part)
            checks += accuracy_checks(name, errors, MOST_BIAS_PX.get(radius, LEAST_BIAS_LIMIT_PX))
            references += accuracy_figures(name, errors)
    return Findings(checks, references)


def measured_errors(board: LitBoard, noise: float, dots: int, seed: int) -> Errors:
    """Measure the dots of a board under repeated random noise.

    Parameters
    ----------
    board : LitBoard
    noise : float
        Standard deviation of every pixel, as a share of full scale.
    dots : int
        Measurements wanted.
    seed : int
    """
    random = generator(seed, "bench detect", board.name, f"noise {noise:g}")
    draws = max(1, round(dots / max(1, len(board.number))))
    return _joined([_drawn(board, noise, random) for _ in range(draws)])


def _drawn(board: LitBoard, noise: float, random: np.random.Generator) -> Errors:
    """Measure a board's dots once."""
    noisy = FULL * (board.clean + noise * random.standard_normal(board.clean.shape))
    picture = np.clip(np.rint(noisy), 0, FULL).astype(np.uint8)
    dots = detect_dots(picture, board.target)
    position = np.full((board.target.count, 2), np.nan)
    covariance = np.full((board.target.count, 2, 2), np.nan)
    number = dots.index[dots.ok, 1] * board.target.cols + dots.index[dots.ok, 0]
    position[number], covariance[number] = dots.position[dots.ok], dots.covariance[dots.ok]
    variance = noise**2 + ROUNDING / FULL**2
    return Errors(
        labcal=position[board.number] - board.centroid,
        covariance=covariance[board.number],
        bound=board.unit_bound * variance,
        blob=blob_centres(picture, board.centroid, board.shape) - board.centroid,
        contour=contour_centres(picture, board.centroid, board.shape) - board.centroid,
    )


def _joined(parts: list[Errors]) -> Errors:
    """Return the errors of all parts."""
    return Errors(
        labcal=np.concatenate([part.labcal for part in parts]),
        covariance=np.concatenate([part.covariance for part in parts]),
        bound=np.concatenate([part.bound for part in parts]),
        blob=np.concatenate([part.blob for part in parts]),
        contour=np.concatenate([part.contour for part in parts]),
    )


def accuracy_checks(name: str, errors: Errors, bias_limit_px: float) -> list[Check]:
    """Return share not measured, RMS over bound, bias, and deviation of the sum of squares from chi-square.

    Parameters
    ----------
    name : str
    errors : Errors
    bias_limit_px : float
    """
    measured = np.isfinite(errors.labcal).all(axis=1)
    e, C = errors.labcal[measured], errors.covariance[measured]
    bias = float(np.linalg.norm(e.mean(axis=0))) if len(e) else float("nan")
    squares = float(np.einsum("ni,ni->", e, np.linalg.solve(C, e[..., None])[..., 0]))
    return [
        at_most(
            f"{name}: RMS error over the Cramer-Rao bound",
            over_bound(errors.labcal, errors.bound),
            MOST_RATIO,
        ),
        at_most(f"{name}: bias, px", bias, bias_limit_px),
        at_most(
            f"{name}: normalised errors off chi-square, standard deviations",
            chi_square_z(squares, 2 * len(e)),
            SIGMAS,
        ),
    ]


def accuracy_figures(name: str, errors: Errors) -> list[Figure]:
    """Return the same ratios for centres of OpenCV, and the share of dots that labcal does not measure."""
    blob, contour = (over_bound(other, errors.bound) for other in (errors.blob, errors.contour))
    own = over_bound(errors.labcal, errors.covariance)
    missed = float((~np.isfinite(errors.labcal).all(axis=1)).mean())
    return [
        Figure(name=f"{name}: share of dots not measured", value=missed),
        Figure(name=f"{name}: RMS error over what labcal says of it", value=own),
        Figure(name=f"{name}: OpenCV's blobs, RMS over the bound", value=blob),
        Figure(name=f"{name}: ellipse through a contour, RMS over the bound", value=contour),
    ]


def over_bound(errors: Pixels, bound: PixelCovariances) -> float:
    """Return the root of the mean of ``e' inv(bound) e / 2``, which is 1 at the bound; NaN where all are."""
    known = np.isfinite(errors).all(axis=1)
    if not known.any():
        return float("nan")
    e = errors[known]
    normalised = np.einsum("ni,ni->n", e, np.linalg.solve(bound[known], e[..., None])[..., 0])
    return float(np.sqrt(normalised.mean() / 2.0))


def chi_square_z(squares: float, freedom: int) -> float:
    """Return the normal quantile with the same probability as a sum of squares.

    The two tails count alike. NaN where there is nothing.
    """
    if freedom == 0:
        return float("nan")
    logs = (chi2.logsf(squares, freedom), chi2.logcdf(squares, freedom))
    return float(norm.isf(np.exp(max(min(logs), -700.0))))
