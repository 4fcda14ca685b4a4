"""The noise that compression with loss adds at the edges of dots, simulated with the photograph's own."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from jaxtyping import Float32

from labcal.guide.twin.again import RenderedAgain, TwinJob
from labcal.guide.twin.dot_windows import dot_windows
from labcal.guide.twin.noise import measured_noise
from labcal.rng import generator

_PURE = 1e-3
_BLOCK = 8
"""Of JPEG, px; what rounding of its coefficients adds spreads over the whole of it."""
_ROUNDS = 3
_LIKE = 1.05
_ROUNDING = np.float32(1.0 / 12.0)
"""Variance of the rounding of values."""
_MOST = 8.0
"""Of the noise before compression over that after it; coarser steps leave nothing that tells."""


def with_compression(made: RenderedAgain, job: TwinJob) -> RenderedAgain:
    """Return a rendering that knows what the compression of its photograph adds.

    Parameters
    ----------
    made : RenderedAgain
    job : TwinJob

    Notes
    -----
    Steps of coefficients that are larger than the noise take from it where a picture is flat, and at edges,
    where coefficients are large, add a twelfth of their square each. Pictures with noise are compressed as
    the photograph was, with so much noise that blocks of paper show what those of the photograph do. The mean
    square of their differences is the variance: in each block of 8 x 8 px with an edge, and over all others.
    """
    if made.stored.coding is None:
        return made
    made = replace(made, before_coding=_before(made, job))
    clean, base = made.clean(), made.variances()
    edge = (made.behind.share > _PURE) & (made.behind.share < 1.0 - _PURE)
    with_edge = _block_means(edge.astype(np.float32)) > 0.0
    square = [np.zeros(edge.shape, dtype=np.float32) for _ in clean]
    for picture in _drawn(made, job):
        values = picture.reshape(*picture.shape[:2], -1)
        for channel, light in enumerate(clean):
            off = values[..., channel] - made.stored.values(light)
            square[channel] += off**2 / np.float32(job.draws)
    coded = []
    for light, variance, mean in zip(clean, base, square, strict=True):
        step2 = made.stored.light_of_step(light) ** 2
        stated = variance / step2
        flat = made.compared & ~with_edge
        even = stated * np.float32(mean[flat].sum() / stated[flat].sum() if flat.any() else 1.0)
        coded.append(np.maximum(np.where(with_edge, _block_means(mean), even), _ROUNDING) * step2)
    known = replace(made, coded=coded)
    of, variance = known.light[known.main], known.variances()[known.main]
    windows = dot_windows(known.photo[known.main], variance, known.seen(), of, known.around)
    return replace(known, windows=windows)


def _drawn(made: RenderedAgain, job: TwinJob) -> Iterator[np.ndarray]:
    for number in range(job.draws):
        yield made.noisy(number, generator(job.seed, job.source.view, job.source.camera, f"coding {number}"))


def _before(made: RenderedAgain, job: TwinJob) -> float:
    """Return the variance of noise before compression, in units of the one after, that leaves the latter."""
    main, share = made.main, made.behind.share
    paper, ink = made.compared & (share > 1.0 - _PURE), made.compared & (share < _PURE)
    level = np.median(made.clean()[main][paper]).reshape(1, 1)
    wanted = float(made.noise[main].variance(level)[0, 0])
    before = 1.0
    for _ in range(_ROUNDS):
        now = replace(made, before_coding=before)
        left = measured_noise(made.stored.channels(next(_drawn(now, job)))[main], paper, ink)
        ratio = wanted / float(left.variance(level)[0, 0]) if left is not None else 1.0
        before = float(np.clip(before * ratio, 1.0 / _MOST, _MOST))
        if 1.0 / _LIKE < ratio < _LIKE:
            break
    return before


def _block_means(picture: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Return the mean of the block of each pixel; blocks begin at the first pixel."""
    height, width = picture.shape
    down, along = -height % _BLOCK, -width % _BLOCK
    whole = np.pad(picture, ((0, down), (0, along)), mode="edge")
    rows, cols = whole.shape[0] // _BLOCK, whole.shape[1] // _BLOCK
    mean = whole.reshape(rows, _BLOCK, cols, _BLOCK).mean(axis=(1, 3), dtype=np.float64)
    spread = np.repeat(np.repeat(mean.astype(np.float32), _BLOCK, axis=0), _BLOCK, axis=1)
    return np.asarray(spread[:height, :width])
