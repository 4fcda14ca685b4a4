"""The difference of photograph and rendering around each dot by its causes: light, place, blur, size."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64

from labcal.guide.twin.light import PictureLight
from labcal.render.paper_share import SharpShare

CAUSES = ("light", "place", "blur", "size")
"""In the order in which they are subtracted."""
_COLUMNS = ((0, 1), (2, 3), (4,), (5,))
"""Columns of each cause: paper and ink; x and y; blur; growth."""
PARAMETERS = 6
_STEP_PX = 0.05
_AROUND_PX = 3.0
_SIGMAS = 3.0
_LEAST = 30
"""Pixels of a window."""


@dataclass(frozen=True)
class DotWindows:
    """Differences around the dots of one picture.

    Attributes
    ----------
    parameters : float64 array, (n, 6)
        Change of the light of paper and of ink, shift along x and y (px), change of the blur (px), growth of
        the radius (px), each photograph minus rendering; NaN where a dot has no window.
    sigma : float64 array, (n, 6)
    pixels : int array, (n,)
    squares : float64 array, (n,)
        Sum of squared differences in units of the noise.
    removed : float64 array, (n, 4)
        What each cause takes of them, in the order of :data:`CAUSES`.
    """

    parameters: Float64[np.ndarray, "n 6"]
    sigma: Float64[np.ndarray, "n 6"]
    pixels: Int64[np.ndarray, " n"]
    squares: Float64[np.ndarray, " n"]
    removed: Float64[np.ndarray, "n 4"]

    def typical(self, which: int) -> float:
        """Return the median of one parameter; 0 where there is none."""
        known = self.parameters[np.isfinite(self.parameters[:, which]), which]
        return float(np.median(known)) if len(known) else 0.0


@dataclass(frozen=True)
class BlurredShare:
    """The share of paper behind a blur, and how it changes.

    Attributes
    ----------
    share, by_blur, by_x, by_y : float32 array, (h, w)
        The share of paper, and its derivatives by the blur, and by the place of a pixel, 1/px.
    """

    share: Float32[np.ndarray, "h w"]
    by_blur: Float32[np.ndarray, "h w"]
    by_x: Float32[np.ndarray, "h w"]
    by_y: Float32[np.ndarray, "h w"]

    @classmethod
    def of(cls, sharp: SharpShare, blur_px: float) -> "BlurredShare":
        """Return a sharp share behind a blur, a Gauss function with that standard deviation."""
        share = sharp.behind(blur_px)
        more, less = sharp.behind(blur_px + _STEP_PX), sharp.behind(max(blur_px - _STEP_PX, 1e-3))
        step = _STEP_PX + min(_STEP_PX, blur_px - 1e-3)
        by_y, by_x = np.gradient(share)
        return cls(share, (more - less) / np.float32(step), by_x, by_y)


def dot_windows(
    light: Float32[np.ndarray, "h w"],
    variance: Float32[np.ndarray, "h w"],
    behind: BlurredShare,
    of: PictureLight,
    where: "Windows",
) -> DotWindows:
    """Return the differences around dots.

    Parameters
    ----------
    light, variance : ndarray, shape (h, w)
        Of the photograph, and of its noise, in values that are proportional to light.
    behind : BlurredShare
    of : PictureLight
        Fitted to the photograph.
    where : Windows

    Notes
    -----
    One step of Gauss-Newton. The columns are made orthogonal in their order (QR), so that the squared
    components are what each cause takes of the sum of squares after those before it.
    """
    paper, ink = of.paper.over(light.shape), of.ink.over(light.shape)
    contrast = paper - ink
    n = len(where.low)
    parameters, sigma = np.full((n, PARAMETERS), np.nan), np.full((n, PARAMETERS), np.nan)
    pixels, squares = np.zeros(n, dtype=np.int64), np.zeros(n)
    removed = np.zeros((n, len(CAUSES)))
    growing = -np.hypot(behind.by_x, behind.by_y) * (1.0 if where.dark_dots else -1.0)
    for number, (low, high) in enumerate(zip(where.low.tolist(), where.high.tolist(), strict=True)):
        box = (slice(low[1], high[1]), slice(low[0], high[0]))
        inside = where.compared[box]
        if inside.sum() < _LEAST:
            continue
        share, edge = behind.share[box][inside], contrast[box][inside]
        weight = 1.0 / np.sqrt(variance[box][inside])
        columns = np.stack(
            [
                share, 1.0 - share,
                -edge * behind.by_x[box][inside], -edge * behind.by_y[box][inside],
                edge * behind.by_blur[box][inside], edge * growing[box][inside],
            ],
            axis=-1,
        ).astype(np.float64)  # fmt: skip
        off = ((light[box][inside] - ink[box][inside] - share * edge) * weight).astype(np.float64)
        Q, R = np.linalg.qr(columns * weight[:, None])
        if np.abs(np.diag(R)).min() < 1e-9 * np.abs(np.diag(R)).max():
            continue
        parts = Q.T @ off
        R_inverse = np.linalg.inv(R)
        parameters[number] = R_inverse @ parts
        sigma[number] = np.sqrt((R_inverse**2).sum(axis=1))
        pixels[number], squares[number] = len(off), float(off @ off)
        removed[number] = [float((parts[list(which)] ** 2).sum()) for which in _COLUMNS]
    return DotWindows(parameters, sigma, pixels, squares, removed)


@dataclass(frozen=True)
class Windows:
    """The windows around the dots of a picture.

    Attributes
    ----------
    low, high : int array, (n, 2)
        First pixel of each, and the one past the last.
    compared : bool array, (h, w)
        Pixels that count.
    dark_dots : bool
        True if dots are darker than the board.
    """

    low: Int64[np.ndarray, "n 2"]
    high: Int64[np.ndarray, "n 2"]
    compared: Bool[np.ndarray, "h w"]
    dark_dots: bool

    @classmethod
    def around(
        cls,
        outlines: Float64[np.ndarray, "n samples 2"],
        blur_px: float,
        compared: Bool[np.ndarray, "h w"],
        dark_dots: bool,  # noqa: FBT001 -- what the target is, not how to work
    ) -> "Windows":
        """Return windows around outlines (px) that hold their blurred edges."""
        height, width = compared.shape
        more = _AROUND_PX + _SIGMAS * blur_px
        low = np.floor(outlines.min(axis=1) - more).astype(np.int64)
        high = np.ceil(outlines.max(axis=1) + more).astype(np.int64) + 1
        size = np.array([width, height])
        return cls(np.clip(low, 0, size), np.clip(high, 0, size), compared, dark_dots)
