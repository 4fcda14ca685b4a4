"""Light of samples of a print, finer than pixels, by its distances from the edges of ink."""

import numpy as np
from jaxtyping import Float32, Float64

from labcal.detect.compiled import compiled


def lit_samples(
    places: tuple[Float64[np.ndarray, "h w"], Float64[np.ndarray, "h w"]],
    finer: int,
    distance: Float32[np.ndarray, "rows cols"],
    edges: Float64[np.ndarray, "4"],
    levels: Float64[np.ndarray, "3"],
) -> Float32[np.ndarray, "fine_h fine_w"]:
    """Return the light that samples of pixels see.

    Within a pixel, places on the board change in a line. Ink changes in a line across a sample at an edge,
    by the slope of the distance in the picture, so that a tilted edge is where it is along both axes.

    Parameters
    ----------
    places : tuple of ndarray, each of shape (h, w)
        Where the pixels' centres see the board: x and y in steps of the grid of distances.
    finer : int
        Samples along a side of a pixel.
    distance : ndarray, shape (rows, cols)
        From the nearest edge, positive on ink, in steps.
    edges : ndarray, shape (4,)
        Of the board: least and greatest x, least and greatest y, in steps.
    levels : ndarray, shape (3,)
        Of paper, of ink, and of what lies beyond the board.
    """
    x, y = places
    (x_down, x_along), (y_down, y_along) = np.gradient(x), np.gradient(y)
    slopes = np.stack([x_along, x_down, y_along, y_down], axis=-1) / finer
    return np.asarray(_sampled(np.stack([x, y], axis=-1), slopes, finer, distance, edges, levels))


@compiled
def _sampled(
    place: np.ndarray, slopes: np.ndarray, finer: int, distance: np.ndarray, edges: np.ndarray,
    levels: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Return :func:`lit_samples`; `place` (h, w, 2), and its `slopes` (h, w, 4) from sample to sample."""
    height, width = place.shape[:2]
    light = np.empty((height * finer, width * finer), dtype=np.float32)
    rows, cols = distance.shape
    for v in range(height):
        for u in range(width):
            x_along, x_down, y_along, y_down = slopes[v, u]
            for j in range(finer):
                down = j + 0.5 - 0.5 * finer
                for i in range(finer):
                    along = i + 0.5 - 0.5 * finer
                    x = place[v, u, 0] + along * x_along + down * x_down
                    y = place[v, u, 1] + along * y_along + down * y_down
                    value = levels[2]
                    if edges[0] < x < edges[1] and edges[2] < y < edges[3]:
                        col = min(max(int(x), 0), cols - 2)
                        row = min(max(int(y), 0), rows - 2)
                        right, up = x - col, y - row
                        low, high = distance[row, col], distance[row + 1, col]
                        of_low, of_high = distance[row, col + 1] - low, distance[row + 1, col + 1] - high
                        low_end, high_end = low + right * of_low, high + right * of_high
                        away = low_end + up * (high_end - low_end)
                        by_x = of_low + up * (of_high - of_low)
                        by_y = high_end - low_end
                        step = np.hypot(by_x * x_along + by_y * y_along, by_x * x_down + by_y * y_down)
                        if abs(away) >= 0.5 * step:
                            covered = 1.0 if away > 0.0 else 0.0
                        else:
                            covered = 0.5 + away / step
                        value = levels[0] + covered * (levels[1] - levels[0])
                    light[v * finer + j, u * finer + i] = value
    return light
