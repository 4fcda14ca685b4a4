"""The noise of a picture by photon transfer: variance by light, and correlation of neighbours."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64

SIDE = 7
"""Of the blocks of pixels of one colour in which noise is measured, px; 5 where there are too few."""
_SMALLER = 5
_FEWEST = 20
"""Blocks of each colour."""
_BOUNDS = (-0.4, 0.6)
"""Of correlations; three pixels in a row cannot have more with weights of one sign."""
_DUST = 3.0
"""Of the median variance of blocks of like light; more than that is no noise."""
_LEVELS = 8
"""Groups of blocks by their light."""


@dataclass(frozen=True)
class PictureNoise:
    """Noise of one channel, in values that are proportional to light.

    Attributes
    ----------
    offset : float
        Variance without light: read noise, and the steps of the values.
    slope : float
        Growth of the variance with light: photon noise, the gain of the camera.
    along, down : float
        Correlation of the noise of pixels that are neighbours in a row, and in a column.
    blocks : int
        Blocks of pixels that it was measured in.
    """

    offset: float
    slope: float
    along: float
    down: float
    blocks: int

    def variance(self, light: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        """Return the variance by the light."""
        return np.asarray((self.offset + self.slope * np.maximum(light, np.float32(0))).astype(np.float32))

    def drawn(
        self, light: Float32[np.ndarray, "h w"], random: np.random.Generator
    ) -> Float32[np.ndarray, "h w"]:
        """Return light with noise that is drawn, correlated as it was measured."""
        import cv2  # noqa: PLC0415 -- takes a third of a second

        white = random.standard_normal(light.shape, dtype=np.float32)
        row, column = (_kernel(one).astype(np.float32) for one in (self.along, self.down))
        mixed = cv2.sepFilter2D(white, -1, row, column, borderType=cv2.BORDER_REFLECT)
        return np.asarray(light + np.sqrt(self.variance(light)) * mixed)


def measured_noise(
    light: Float32[np.ndarray, "h w"],
    paper: Bool[np.ndarray, "h w"],
    ink: Bool[np.ndarray, "h w"],
) -> PictureNoise | None:
    """Return the noise that the light of a picture shows in blocks of one colour.

    Parameters
    ----------
    light : ndarray, shape (h, w)
    paper, ink : ndarray of bool, shape (h, w)
        Pixels that show nothing else.

    Returns
    -------
    PictureNoise or None
        None where there are too few blocks.

    Notes
    -----
    In each block a plane is subtracted; what is left tells the variance with ``side^2 - 3`` degrees of
    freedom, fewer where neighbours are correlated and the plane takes more of the noise: the trace of what is
    left of the correlations of the block's pixels. The median over
    blocks of like light is not moved by dust; that of chi-square over its degrees of freedom is
    (1 - 2 / (9 nu))^3 (Wilson and Hilferty 1931). A line through the medians is the photon transfer curve
    (EMVA 1288).
    """
    for side in (SIDE, _SMALLER):
        of_paper, of_ink = _blocks(light, paper, side), _blocks(light, ink, side)
        if min(len(of_paper), len(of_ink)) >= _FEWEST:
            break
    else:
        if len(of_paper) < _FEWEST:
            return None
    groups = [part for some in (of_paper, of_ink) if len(some) for part in _by_light(some)]
    along, down = _correlations(groups, side)
    freedom = float(np.trace(_without_plane(along, down, side)))
    mean, variance, count = np.array([_level(part, freedom) for part in groups]).T
    offset, slope = _line(mean, variance, count)
    return PictureNoise(offset, slope, along, down, len(of_paper) + len(of_ink))


def _blocks(
    light: Float32[np.ndarray, "h w"], where: Bool[np.ndarray, "h w"], side: int
) -> Float64[np.ndarray, "n side side"]:
    """Return blocks of pixels that are all wanted."""
    height, width = (side * (length // side) for length in light.shape)
    shape = (height // side, side, width // side, side)
    whole = where[:height, :width].reshape(shape).all(axis=(1, 3))
    tiles = light[:height, :width].reshape(shape).transpose(0, 2, 1, 3)
    return np.asarray(tiles[whole].astype(np.float64))


def _flattened(blocks: Float64[np.ndarray, "n side side"]) -> Float64[np.ndarray, "n side side"]:
    """Return blocks without their planes."""
    side = blocks.shape[-1]
    away = np.arange(side) - 0.5 * (side - 1)
    square = side * float((away**2).sum())
    flat = blocks - blocks.mean(axis=(1, 2), keepdims=True)
    along = np.einsum("nij,j->n", flat, away) / square
    down = np.einsum("nij,i->n", flat, away) / square
    return np.asarray(flat - along[:, None, None] * away - down[:, None, None] * away[:, None])


def _by_light(blocks: Float64[np.ndarray, "n side side"]) -> list[Float64[np.ndarray, "m side side"]]:
    order = np.argsort(blocks.mean(axis=(1, 2)), kind="stable")
    groups = max(1, min(_LEVELS, len(blocks) // _FEWEST))
    return [blocks[part] for part in np.array_split(order, groups)]


def _level(blocks: Float64[np.ndarray, "n side side"], freedom: float) -> tuple[float, float, int]:
    """Return the light of blocks, the variance in them, and their number."""
    variances = (_flattened(blocks) ** 2).sum(axis=(1, 2)) / freedom
    usual = (1.0 - 2.0 / (9.0 * freedom)) ** 3
    return float(blocks.mean()), float(np.median(variances)) / usual, len(blocks)


def _line(
    mean: Float64[np.ndarray, " n"], variance: Float64[np.ndarray, " n"], count: np.ndarray
) -> tuple[float, float]:
    """Return the line of variances by light that is negative nowhere."""
    from scipy.optimize import nnls  # noqa: PLC0415 -- takes half a second to import

    scale = np.sqrt(count) / np.maximum(variance, 1e-12)
    found, _ = nnls(np.column_stack([scale, scale * mean]), scale * variance)
    return max(float(found[0]), 1e-12), float(found[1])


def _correlations(groups: Sequence[Float64[np.ndarray, "n side side"]], side: int) -> tuple[float, float]:
    """Return the correlation of neighbours along rows and columns that leaves, without planes, what is seen.

    Blocks are divided by the noise of their group, not by their own: a ratio of each block would make the
    correlation too small by a fifth.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415 -- takes half a second to import

    flat = np.concatenate([_even(_flattened(blocks)) for blocks in groups])
    seen = np.array([(flat[:, :, :-1] * flat[:, :, 1:]).mean(), (flat[:, :-1] * flat[:, 1:]).mean()])
    seen /= (flat**2).mean()
    low, high = _BOUNDS

    def off(both: Float64[np.ndarray, "2"]) -> Float64[np.ndarray, "2"]:
        left = _without_plane(float(both[0]), float(both[1]), side).reshape(side, side, side, side)
        along = np.einsum("ijij->ij", left[:, :-1, :, 1:]).mean()
        down = np.einsum("ijij->ij", left[:-1, :, 1:, :]).mean()
        return np.asarray(np.array([along, down]) / np.einsum("ijij->ij", left).mean() - seen)

    found = least_squares(off, np.clip(seen, 0.9 * low, 0.9 * high), bounds=(low, high))
    return float(found.x[0]), float(found.x[1])


def _even(flat: Float64[np.ndarray, "n side side"]) -> Float64[np.ndarray, "m side side"]:
    """Return flattened blocks of like light over their noise, without those that show dust."""
    variances = (flat**2).mean(axis=(1, 2))
    usual = max(float(np.median(variances)), 1e-12)
    return np.asarray(flat[variances <= _DUST * usual] / np.sqrt(usual))


def _without_plane(along: float, down: float, side: int) -> Float64[np.ndarray, "pixels pixels"]:
    """Return the covariance of a block's pixels of variance 1 after its plane is subtracted."""
    from scipy.linalg import toeplitz  # noqa: PLC0415 -- takes half a second to import

    axes = []
    for correlation in (down, along):
        first = np.zeros(side)
        kernel = _kernel(correlation)
        first[:3] = np.correlate(kernel, kernel, "full")[2:]
        axes.append(toeplitz(first))
    away = np.arange(side) - 0.5 * (side - 1)
    one = np.ones(side)
    plane = np.linalg.qr(np.stack([np.kron(one, one), np.kron(one, away), np.kron(away, one)], axis=-1))[0]
    keep = np.eye(side * side) - plane @ plane.T
    return np.asarray(keep @ np.kron(*axes) @ keep)


def _kernel(correlation: float) -> Float64[np.ndarray, "3"]:
    """Return the filter (a, 1, a), normalised, that gives white noise a correlation of neighbours.

    The correlation is ``2 a / (1 + 2 a^2)``, at most 0.707.
    """
    if abs(correlation) < 1e-3:  # noqa: PLR2004 -- none
        return np.array([0.0, 1.0, 0.0])
    a = (1.0 - np.sqrt(1.0 - 2.0 * correlation**2)) / (2.0 * correlation)
    kernel = np.array([a, 1.0, a])
    return np.asarray(kernel / np.linalg.norm(kernel))
