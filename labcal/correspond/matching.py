"""Dots seen by all cameras, as the table that methods are fitted to and predict from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Pose, Vectors3
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.targets.target import Target


@dataclass(frozen=True)
class Matches:
    """Dots that every camera measured in the same view, sorted by view, row and column."""

    cameras: tuple[str, ...]
    view: np.ndarray
    """(n,) of str"""
    index: Int64[np.ndarray, "n 2"]
    """(col, row)"""
    q: Float64[np.ndarray, "n cameras 2"]
    """Positions, px."""
    covariance: Float64[np.ndarray, "n cameras 2 2"]
    """Of the positions, px squared."""

    def __len__(self) -> int:
        return len(self.view)

    @property
    def X(self) -> Float64[np.ndarray, "n columns"]:
        """Positions as columns x1 y1 x2 y2 ..., px."""
        return self.q.reshape(len(self.q), 2 * len(self.cameras))

    @cached_property
    def rows_by_view(self) -> dict[str, Int64[np.ndarray, " rows"]]:
        """The numbers of the lines of each view, views in order of appearance."""
        return rows_by_name(self.view)

    def where(self, mask: np.ndarray) -> "Matches":
        """Return the lines where the mask holds."""
        return Matches(self.cameras, self.view[mask], self.index[mask], self.q[mask], self.covariance[mask])


def rows_by_name(names: np.ndarray) -> dict[str, Int64[np.ndarray, " rows"]]:
    """Return the indices of each name in an array of str, names in order of appearance.

    Comparing the array with every name in turn takes minutes where a table has thousands of views.
    """
    each, first, number = np.unique(names, return_index=True, return_inverse=True)
    order = np.argsort(number, kind="stable")
    rows = np.split(order, np.searchsorted(number[order], np.arange(1, len(each))))
    return {str(each[at]): rows[at] for at in np.argsort(first).tolist()}


def match(detections: Detections, cameras: Sequence[str]) -> Matches:
    """Return the dots that all of `cameras` measured in the same view.

    Parameters
    ----------
    detections : Detections
        Only dots flagged ``ok`` enter.
    cameras : sequence of str
        The cameras wanted, in the order of the columns.

    Raises
    ------
    InputError
        A camera is missing from the detections, or a dot is listed twice for a picture or has no position.
    """
    missing = [name for name in cameras if name not in detections.cameras]
    if missing:
        raise InputError(
            f"There are no detections of camera {', '.join(missing)}, "
            f"only of {', '.join(detections.cameras) or 'none'}."
        )
    usable = detections.measured()
    lines: dict[tuple[str, int, int], dict[str, int]] = {}
    for i, (view, camera, (col, row)) in enumerate(
        zip(usable.view.tolist(), usable.camera.tolist(), usable.index.tolist(), strict=True)
    ):
        lines.setdefault((view, row, col), {})[camera] = i
    order = {view: i for i, view in enumerate(usable.views)}
    keys = sorted(
        (key for key, seen in lines.items() if all(name in seen for name in cameras)),
        key=lambda key: (order[key[0]], key[1], key[2]),
    )
    rows = np.array([[lines[key][name] for name in cameras] for key in keys], dtype=np.int64).reshape(
        -1, len(cameras)
    )
    return Matches(
        cameras=tuple(cameras),
        view=np.array([view for view, _, _ in keys], dtype=np.str_),
        index=np.array([(col, row) for _, row, col in keys], dtype=np.int64).reshape(-1, 2),
        q=usable.position[rows],
        covariance=usable.covariance[rows],
    )


def require_on_target(detections: Detections, target: Target) -> None:
    """Raise where dots flagged ``ok`` are beyond the target, so that it is not the one in the pictures.

    Raises
    ------
    InputError
        A column or row is beyond the target's, or dots are of boards by name.
    """
    detections.require_one_board()
    index = detections.index[detections.ok]
    beyond = ((index < 0) | (index >= [target.cols, target.rows])).any(axis=1)
    if beyond.any():
        col, row = index[beyond][0]
        raise InputError(
            f"The detections hold dot ({col}, {row}), but the target '{target.name}' has {target.cols} x "
            f"{target.rows} dots. Name the target that the pictures show."
        )


def stage_points(matches: Matches, target: Target, T_world_target: Mapping[str, Pose]) -> Vectors3:
    """Return the world positions of matched dots, from the pose of the target in each view.

    Parameters
    ----------
    matches : Matches
    target : Target
    T_world_target : mapping of str to ndarray of shape (4, 4)
        Pose of the target by view, mm.

    Returns
    -------
    ndarray, shape (n, 3)
        Millimetres; NaN for views without a pose.
    """
    p_target = target.points(matches.index)
    p = np.full(p_target.shape, np.nan)
    for view, rows in matches.rows_by_view.items():
        if view in T_world_target:
            p[rows] = transform(T_world_target[view], p_target[rows])
    return p
