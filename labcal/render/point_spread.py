"""The point spread of a lens, which blurs the light before the pixels gather it.

Light is sampled on a film of k x k cells a pixel. The blur of a Gauss function and the mean over the cells of
a pixel are one filter along the columns and one along the rows. A film with one cell a pixel has staircases
along edges that are nearly along the rows, of wavelengths that no blur removes.
"""

import cv2
import numpy as np
from jaxtyping import Float32

from labcal.render.bands import Band, bands

_SIGMAS = 4.0
"""Reach of the Gauss function."""
_FINER = ((1.5, 4), (6.0, 2))
"""Blurs, px, below which a film has so many cells along a side of a pixel; wider ones need but one."""
_RAYS = 64
"""Of a pixel, below which it has no more than two cells along a side: with fewer than four rays a cell, lamps
would add noise, and edges are off by 0.0013 px at a blur of 0.6 px, a twentieth of what the rays do."""


def finer(blur_px: float, rays: int) -> int:
    """Return the cells along a side of a pixel that a film should have.

    Parameters
    ----------
    blur_px : float
        Standard deviation of the point spread, px.
    rays : int
        Of a pixel.
    """
    wanted = next((cells for blur, cells in _FINER if blur_px < blur), 1)
    return min(wanted, 4 if rays >= _RAYS else 2)


def reach(blur_px: float) -> int:
    """Return the number of pixels on either side from which a pixel gathers light."""
    return int(np.ceil(_SIGMAS * blur_px))


def gathered(film: Float32[np.ndarray, "k h w k *channels"], blur_px: float) -> np.ndarray:
    """Return the light that pixels gather through a lens.

    Parameters
    ----------
    film : ndarray of float32, shape (k, h, w, k) or (k, h, w, k, 3)
        Light in the cells: row of cells in a pixel, row and column of the pixel, column of cells in it.
        Beyond its edges, pixels are those at the edge.
    blur_px : float
        Standard deviation of the point spread; 0: none.

    Returns
    -------
    ndarray of float32, shape (h, w) or (h, w, 3)
    """
    return _correlated(film, blur_px, weights(blur_px, film.shape[0]))


def behind_lens(
    film: Float32[np.ndarray, "k h w k"], share: Float32[np.ndarray, "h w"], blur_px: float
) -> Float32[np.ndarray, "inner_h inner_w"]:
    """Return the light that pixels gather through a lens that lets a share of it pass, before it blurs it.

    Parameters
    ----------
    film : ndarray of float32, shape (k, h, w, k)
        As of :func:`gathered`, but wider by :func:`reach` on every side than what is returned.
    share : ndarray of float32, shape (h, w)
        Of the light that passes, by pixel.
    blur_px : float
        As of :func:`gathered`.
    """
    halo, (_, height, width, _) = reach(blur_px), film.shape
    return gathered(film * share[None, :, :, None], blur_px)[halo : height - halo, halo : width - halo]


def gathered_variance(film: Float32[np.ndarray, "k h w k *channels"], blur_px: float) -> np.ndarray:
    """Return the variance of the light that pixels gather, from that of the cells, which are independent.

    Parameters
    ----------
    film, blur_px
        As of :func:`gathered`.
    """
    return _correlated(film, blur_px, weights(blur_px, film.shape[0]) ** 2)


def cells(fine: np.ndarray, finer: int) -> np.ndarray:
    """Return a picture of cells, shape (k h, k w) or (k h, k w, 3), as a film of :func:`gathered`."""
    rows, columns, *channels = fine.shape
    apart = fine.reshape(rows // finer, finer, columns // finer, finer, *channels)
    return np.ascontiguousarray(np.moveaxis(apart, 1, 0), dtype=np.float32)


def in_cells(q: np.ndarray, finer: int) -> np.ndarray:
    """Return places (..., 2) in pixels as places in the cells of a picture of :func:`cells`."""
    return np.asarray(finer * (q + 0.5) - 0.5)


def weights(blur_px: float, finer: int) -> Float32[np.ndarray, "k taps"]:
    """Return the weights of the cells along one axis, for the cells of each number within their pixels."""
    half = reach(blur_px)
    place = np.arange(-half * finer, (half + 1) * finer) - np.arange(finer)[:, None]
    sigma = max(blur_px * finer, 1e-3)
    spread = np.exp(-0.5 * (place / sigma) ** 2)
    weight = (spread / spread.sum(axis=1, keepdims=True)).mean(axis=0)
    return np.ascontiguousarray((weight / weight.sum()).reshape(-1, finer).T, dtype=np.float32)


def _correlated(film: np.ndarray, blur_px: float, along: np.ndarray) -> np.ndarray:
    """Return the sums over cells, times weights along both axes, for each pixel."""
    _, height, width, _, *channels = film.shape
    light = np.empty((height, width, *channels), dtype=np.float32)
    for band in bands(height):
        light[band.rows] = _band(film, band, reach(blur_px), along)
    return light


def _band(film: np.ndarray, band: Band, halo: int, along: np.ndarray) -> np.ndarray:
    """Return :func:`_correlated` of one band."""
    finer, _, width, _, *channels = film.shape
    one = np.ones(1, dtype=np.float32)
    down = [_filtered(band.widened(film[n], halo), one, along[n]) for n in range(finer)]
    apart = band.narrowed(_total(down), halo).reshape(-1, width, finer, *channels)
    return _total([_filtered(np.ascontiguousarray(apart[:, :, n]), along[n], one) for n in range(finer)])


def _total(parts: list[np.ndarray]) -> np.ndarray:
    """Return the sum of arrays; the first of them takes it."""
    first, *others = parts
    for other in others:
        first += other
    return first


def _filtered(picture: np.ndarray, across: np.ndarray, down: np.ndarray) -> np.ndarray:
    """Return a picture that is correlated with weights along its rows and along its columns.

    Where there is one weight across, columns and channels may be many.
    """
    flat = picture.reshape(len(picture), -1) if len(across) == 1 else picture
    done = cv2.sepFilter2D(flat, cv2.CV_32F, across, down, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(done).reshape(picture.shape)
