"""Exchanged pictures of a target at known places, found by cameras that are resected from it."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.agreement.exchange.decision import LEFT, exchanges, refuse_exchanged
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import MOST_OFF, resect
from labcal.calibrate.triangulation_residuals import MOST_PX
from labcal.correspond.training import TrainingData
from labcal.errors import InputError
from labcal.geometry.projective_map import homogeneous, projective_map

_NAME, _LENS = "resection", "brown-k1k2"


def refuse_exchanged_by_places(data: TrainingData) -> None:
    """Raise where pictures of one training view are exchanged.

    Parameters
    ----------
    data : TrainingData

    Raises
    ------
    ExchangedPicturesError
        Cameras explain the dots far better when two pictures of a view are exchanged.

    Notes
    -----
    Cameras without distortion, which are found in a moment, say which exchange would help most; it is tried.
    """
    everyone = range(len(data.cameras))
    given = _unexplained(data, data.X, everyone)
    if given <= MOST_PX:
        return
    views = dict.fromkeys(data.view.tolist())
    tried = [(view, *exchange) for view in views for exchange in exchanges(len(data.cameras))]
    linear = [_linear_residual(data, _exchanged(data, view, order), everyone) for view, _, order in tried]
    view, pair, order = tried[int(np.argmin(linear))]
    left = _unexplained(data, _exchanged(data, view, order), pair)
    # A resection that fails is off by so much at least, in the narrower of both pictures.
    bound = LEFT * MOST_OFF * min(data.image_sizes[number][0] for number in pair)
    refuse_exchanged(view, (data.cameras[pair[0]], data.cameras[pair[1]]), given, left, bound)


def _exchanged(data: TrainingData, view: str, order: list[int]) -> Float64[np.ndarray, "n columns"]:
    """Return the columns with the cameras in another order in one view."""
    X, rows = data.X.copy(), data.view == view
    X[rows] = X[rows].reshape(-1, len(order), 2)[:, order].reshape(-1, X.shape[1])
    return X


def _linear_residual(
    data: TrainingData, X: Float64[np.ndarray, "n columns"], cameras: Sequence[int]
) -> float:
    """Return the RMS residual of cameras without distortion, px; infinite where there is none."""
    squares = 0.0
    for number in cameras:
        q = X[:, 2 * number : 2 * number + 2]
        try:
            seen = homogeneous(data.Y) @ projective_map(_NAME, data.Y, q).T
        except InputError:
            return float("inf")
        squares += float(((seen[:, :2] / seen[:, 2:] - q) ** 2).sum())
    return float(np.sqrt(squares / len(X)))


def _unexplained(data: TrainingData, X: np.ndarray, cameras: Sequence[int]) -> float:
    """Return the scatter of resected cameras' residuals, px, the worst one; infinite where there is none."""
    worst = 0.0
    for number in cameras:
        kind = camera_of_lens(_LENS, data.image_sizes[number], None)
        try:
            sigma = resect(_NAME, X[:, 2 * number : 2 * number + 2], data.Y, kind).sigma_px
        except InputError:
            return float("inf")
        worst = max(worst, sigma)
    return worst
