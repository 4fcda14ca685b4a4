"""Linear models of how each cause moves the images of dots."""

from enum import StrEnum

import numpy as np
from jaxtyping import Float64

from labcal.guide.twin.residuals import DotResiduals

_DEGREE, _FEW_DEGREE = 4, 3
_MANY = 300
"""Dots of a camera that ask for the higher degree."""


class CauseKind(StrEnum):
    """Kinds of causes of residuals."""

    PRINT = "print"
    """The same displacement of a dot on the board in all pictures."""
    BEND = "bend"
    """A board that is not flat, or bent otherwise than it is known to be."""
    LENS = "lens"
    """A smooth field over the picture of a camera, the same in all views."""
    PICTURES = "pictures"
    """Shift, turn and scale of single pictures against the other cameras of the view."""


def pose_design(
    found: DotResiduals, dots: Float64[np.ndarray, "dots 3"]
) -> Float64[np.ndarray, "n 2 columns"]:
    """Return the derivatives of images by small changes of the pose of the target in each view."""
    p = dots[found.dot] - dots.mean(axis=0)
    turns = np.stack([np.cross(np.eye(3)[axis], p) for axis in range(3)], axis=-1)  # (n, 3, 3)
    own = np.concatenate([found.by_point, np.einsum("nij,njk->nik", found.by_point, turns)], axis=2)
    return _by_group(own, found.view)


def cause_design(
    kind: CauseKind, found: DotResiduals, dots: Float64[np.ndarray, "dots 3"]
) -> Float64[np.ndarray, "n 2 columns"]:
    """Return how a cause moves the images of dots, a column for each of its parameters."""
    if kind is CauseKind.PRINT:
        return _by_group(found.by_point[:, :, :2], found.dot)
    if kind is CauseKind.BEND:
        a, b = _scaled(dots[:, :2])[found.dot].T
        heights = np.stack([a * a, a * b, b * b], axis=-1)
        return np.asarray(found.by_point[:, :, 2:] * heights[:, None, :])
    if kind is CauseKind.LENS:
        return _fields(found)
    return _similarities(found)


def _fields(found: DotResiduals) -> Float64[np.ndarray, "n 2 columns"]:
    """Return polynomial fields over the pictures of each camera."""
    parts = []
    for camera in np.unique(found.camera).tolist():
        mine = found.camera == camera
        a, b = _scaled(found.q[mine]).T
        degree = _DEGREE if int(mine.sum()) >= _MANY else _FEW_DEGREE
        terms = [a**i * b**j for i in range(degree + 1) for j in range(degree + 1 - i)]
        field = np.zeros((len(found), 2, 2 * len(terms)))
        for number, term in enumerate(terms):
            field[mine, 0, 2 * number] = term
            field[mine, 1, 2 * number + 1] = term
        parts.append(field)
    return np.concatenate(parts, axis=2)


def _similarities(found: DotResiduals) -> Float64[np.ndarray, "n 2 columns"]:
    """Return shifts, turns and scales of single pictures."""
    own = np.zeros((len(found), 2, 4))
    own[:, 0, 0] = own[:, 1, 1] = 1.0
    for picture in np.unique(found.picture).tolist():
        mine = found.picture == picture
        x, y = _scaled(found.q[mine]).T
        own[mine, 0, 2], own[mine, 1, 2] = x, y
        own[mine, 0, 3], own[mine, 1, 3] = -y, x
    return _by_group(own, found.picture)


def _by_group(own: Float64[np.ndarray, "n 2 k"], group: np.ndarray) -> Float64[np.ndarray, "n 2 columns"]:
    """Return columns of which each group of lines has its own."""
    names, number = np.unique(group, return_inverse=True)
    k = own.shape[2]
    spread = np.zeros((len(own), 2, len(names), k))
    spread[np.arange(len(own)), :, number] = own
    return spread.reshape(len(own), 2, -1)


def _scaled(q: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "n 2"]:
    low, high = q.min(axis=0), q.max(axis=0)
    return np.asarray((q - 0.5 * (low + high)) / np.maximum(0.5 * (high - low), 1e-9))
