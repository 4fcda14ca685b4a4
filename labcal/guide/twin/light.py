"""The light of a picture: the brightness of paper and of ink, each a smooth field over the board."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64

_DEGREES = (0, 1, 2, 3, 4, 6, 8)
"""Of the polynomials that are tried."""
_POINTS = 12_000
"""Pixels that a field is fitted to."""
_FEWEST = 12
"""Pixels for each coefficient."""
_BETTER = 0.995
"""Of the squared residuals of pixels that were held out: a higher degree must gain more than chance does."""
_CLIP = 5.0
_ROUNDING = 12.0**-0.5
"""Standard deviation of rounding in steps of the values; dark ink may show no other noise."""
_PURE = 1e-3
"""A pixel shows one colour where the share of the other is less."""


@dataclass(frozen=True)
class LightField:
    """A polynomial over a part of the picture, held at its value at the border outside.

    Attributes
    ----------
    low, high : float64 array, (2,)
        Corners of that part, px.
    degree : int
    coefficients : float64 array, (terms,)
        Of products of Chebyshev polynomials whose degrees add up to no more.
    """

    low: Float64[np.ndarray, "2"]
    high: Float64[np.ndarray, "2"]
    degree: int
    coefficients: Float64[np.ndarray, " terms"]

    def over(self, shape: tuple[int, int]) -> Float32[np.ndarray, "h w"]:
        """Return the field at every pixel of a picture."""
        height, width = shape
        x = self._scaled(np.arange(width, dtype=np.float64), 0)
        y = self._scaled(np.arange(height, dtype=np.float64), 1)
        of_x, of_y = _chebyshev(x, self.degree), _chebyshev(y, self.degree)
        table = np.zeros((self.degree + 1, self.degree + 1))
        for (i, j), value in zip(_terms(self.degree), self.coefficients, strict=True):
            table[i, j] = value
        return np.asarray((of_y @ table.T @ of_x.T).astype(np.float32))

    def _scaled(self, x: Float64[np.ndarray, " n"], axis: int) -> Float64[np.ndarray, " n"]:
        middle, half = 0.5 * (self.low + self.high)[axis], 0.5 * (self.high - self.low)[axis]
        return np.asarray(np.clip((x - middle) / max(half, 1.0), -1.0, 1.0))


@dataclass(frozen=True)
class PictureLight:
    """The light of one channel of a picture, in values that are proportional to light."""

    paper: LightField
    ink: LightField

    def image(self, share: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        """Return the light of a picture without noise, from the blurred share of paper in each pixel."""
        paper, ink = self.paper.over(share.shape), self.ink.over(share.shape)
        return np.asarray(ink + share * (paper - ink))


def fitted_light(
    light: Float32[np.ndarray, "h w"],
    share: Float32[np.ndarray, "h w"],
    compared: Bool[np.ndarray, "h w"],
    random: np.random.Generator,
) -> PictureLight | None:
    """Return the light of a picture, from pixels that show nothing but paper, or nothing but ink.

    Parameters
    ----------
    light : ndarray, shape (h, w)
        One channel of the photograph, in values that are proportional to light.
    share : ndarray, shape (h, w)
        Blurred share of paper.
    compared : ndarray of bool, shape (h, w)
        Pixels of the board that count.
    random : numpy.random.Generator
        It chooses pixels.

    Returns
    -------
    PictureLight or None
        None where no pixel shows ink alone: the dots are too small for the blur.
    """
    rows, cols = np.nonzero(compared)
    low = np.array([cols.min(), rows.min()], dtype=np.float64)
    high = np.array([cols.max(), rows.max()], dtype=np.float64)
    paper = _field(light, compared & (share > 1.0 - _PURE), (low, high), random)
    ink = _field(light, compared & (share < _PURE), (low, high), random)
    return None if paper is None or ink is None else PictureLight(paper, ink)


def _field(
    light: Float32[np.ndarray, "h w"],
    where: Bool[np.ndarray, "h w"],
    box: tuple[Float64[np.ndarray, "2"], Float64[np.ndarray, "2"]],
    random: np.random.Generator,
) -> LightField | None:
    """Return the smooth field through some pixels; the degree is the least that held-out pixels ask for."""
    rows, cols = np.nonzero(where)
    if len(rows) < 2 * _FEWEST:
        return None
    if len(rows) > _POINTS:
        chosen = random.choice(len(rows), _POINTS, replace=False)
        rows, cols = rows[chosen], cols[chosen]
    else:
        order = random.permutation(len(rows))
        rows, cols = rows[order], cols[order]
    low, high = box
    half = np.maximum(0.5 * (high - low), 1.0)
    x, y = ((np.stack([cols, rows]) - 0.5 * (low + high)[:, None]) / half[:, None]).astype(np.float64)
    value = light[rows, cols].astype(np.float64)
    held = np.arange(len(value)) % 4 == 0
    best, least = 0, np.inf
    for degree in _DEGREES:
        terms = len(_terms(degree))
        if len(value) < _FEWEST * terms:
            break
        design = _design(x, y, degree)
        coefficients, kept = _robust(design[~held], value[~held])
        off = value[held] - design[held] @ coefficients
        square = float((np.minimum(np.abs(off), _CLIP * kept) ** 2).mean())
        if square < _BETTER * least:
            best, least = degree, square
    coefficients, _ = _robust(_design(x, y, best), value)
    return LightField(low, high, best, coefficients)


def _robust(
    design: Float64[np.ndarray, "n terms"], value: Float64[np.ndarray, " n"]
) -> tuple[Float64[np.ndarray, " terms"], float]:
    """Return coefficients without pixels far off (dust, a scratch), and the scatter of the others."""
    keep = np.ones(len(value), dtype=bool)
    steps = np.diff(np.unique(value))
    least = max(_ROUNDING * float(np.median(steps)) if len(steps) else 0.0, 1e-9)
    for _ in range(2):
        some = design[keep]
        coefficients = np.linalg.lstsq(some.T @ some, some.T @ value[keep], rcond=None)[0]
        off = value - design @ coefficients
        scatter = max(1.4826 * float(np.median(np.abs(off - np.median(off)))), least)
        keep = np.abs(off) <= _CLIP * scatter
    return coefficients, scatter


def _terms(degree: int) -> list[tuple[int, int]]:
    return [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]


def _chebyshev(x: Float64[np.ndarray, " n"], degree: int) -> Float64[np.ndarray, "n terms"]:
    return np.asarray(np.polynomial.chebyshev.chebvander(x, degree))


def _design(
    x: Float64[np.ndarray, " n"], y: Float64[np.ndarray, " n"], degree: int
) -> Float64[np.ndarray, "n terms"]:
    of_x, of_y = _chebyshev(x, degree), _chebyshev(y, degree)
    return np.stack([of_x[:, i] * of_y[:, j] for i, j in _terms(degree)], axis=-1)
