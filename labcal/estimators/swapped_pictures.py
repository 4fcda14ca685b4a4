"""Pictures that bear each other's camera's name: what exchanging them would mend is refused by name."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import resect
from labcal.calibrate.triangulation_residuals import MOST_PX, TriangulationResiduals
from labcal.cameras.camera import Camera
from labcal.correspond.matching import Matches
from labcal.correspond.training import TrainingData
from labcal.errors import InputError
from labcal.geometry.projective_map import homogeneous, projective_map

SWAPPED_BETTER = 0.1
"""Pictures are swapped where exchanging them leaves less than this share of the misses."""
_NAME, _LENS = "resection", "brown-k1k2"


def refuse_swapped(cameras: Sequence[Camera], matches: Matches) -> None:
    """Raise where, seen by known cameras, pictures of a view are exchanged.

    Parameters
    ----------
    cameras : sequence of Camera
        In the order of the matches.
    matches : Matches

    Raises
    ------
    InputError
        In a view, the rays of the dots meet far better when two cameras' pictures are exchanged.
    """
    misses_px = TriangulationResiduals.of(cameras, matches).px
    for view, rows in matches.rows_by_view.items():
        given = float(np.median(misses_px[rows]))
        if given <= MOST_PX:
            continue
        of_view = matches.where(rows)
        for pair, order in _exchanges(len(cameras)):
            exchanged = replace(of_view, q=of_view.q[:, order], covariance=of_view.covariance[:, order])
            _refuse(
                view,
                [matches.cameras[i] for i in pair],
                given,
                TriangulationResiduals.of(cameras, exchanged).typical_px,
            )


def refuse_swapped_training(data: TrainingData) -> None:
    """Raise where pictures of one training view are exchanged.

    Parameters
    ----------
    data : TrainingData

    Raises
    ------
    InputError
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
    tried = [(view, *exchange) for view in views for exchange in _exchanges(len(data.cameras))]
    linear = [_linear_miss(data, _exchanged(data, view, order), everyone) for view, _, order in tried]
    view, pair, order = tried[int(np.argmin(linear))]
    left = _unexplained(data, _exchanged(data, view, order), pair)
    _refuse(view, [data.cameras[i] for i in pair], given, left)


def _exchanges(cameras: int) -> Iterator[tuple[tuple[int, int], list[int]]]:
    """Yield every two cameras, and the order of all with these two exchanged."""
    for a, b in combinations(range(cameras), 2):
        order = list(range(cameras))
        order[a], order[b] = b, a
        yield (a, b), order


def _exchanged(data: TrainingData, view: str, order: list[int]) -> Float64[np.ndarray, "n columns"]:
    """Return the columns with the cameras in another order in one view."""
    X, rows = data.X.copy(), data.view == view
    X[rows] = X[rows].reshape(-1, len(order), 2)[:, order].reshape(-1, X.shape[1])
    return X


def _linear_miss(data: TrainingData, X: Float64[np.ndarray, "n columns"], cameras: Sequence[int]) -> float:
    """Return by how much cameras without distortion miss the dots, px; infinite where there is none."""
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
    """Return by how much resected cameras miss the dots, px, the worst one; infinite where there is none."""
    worst = 0.0
    for number in cameras:
        kind = camera_of_lens(_LENS, data.image_sizes[number], None)
        try:
            sigma = resect(_NAME, X[:, 2 * number : 2 * number + 2], data.Y, kind).sigma_px
        except InputError:
            return float("inf")
        worst = max(worst, sigma)
    return worst


def _refuse(view: str, cameras: Sequence[str], given: float, exchanged: float) -> None:
    """Raise where exchanged pictures are much better."""
    if exchanged < SWAPPED_BETTER * given:
        as_given = f"as they are {given:.3g} px" if np.isfinite(given) else "as they are nothing fits"
        raise InputError(
            f"In view '{view}' the pictures of '{cameras[0]}' and '{cameras[1]}' seem to be swapped: "
            f"exchanged, dots are off by {exchanged:.3g} px, {as_given}. Say which picture is whose: "
            "`cameras` of 'detect'."
        )
