"""Which lens model known points support, by points that were held out."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import Pixels, Points
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.solve.resection.resected import ResectedCamera, adjusted, resect
from labcal.solve.resection.whitening import Even

CANDIDATES = ("pinhole", "brown-k1k2", "brown5", "fisheye-kb4", "rational8")
"""By how many numbers they have."""
_SLABS = 3
_RIM = 0.2
"""Share of the points, those farthest from their middle in the picture, that are held out together."""
_LATTICE = 24
_SURE = 2.0
"""Standard errors by which a lens must be better than one with fewer numbers."""


@dataclass(frozen=True)
class LensTrial:
    """One lens model and how it did."""

    lens: str
    fitted: ResectedCamera | None
    """From all points; None where the model cannot be fitted."""
    held_out: Float64[np.ndarray, " tests"]
    """Squared distances of held-out points, px squared; infinite where they cannot be imaged."""


def chosen_camera(method: str, q: Pixels, p: Points, size: tuple[int, int]) -> ResectedCamera:
    """Return the camera with the simplest lens model that predicts held-out points as well as any.

    Parameters
    ----------
    method : str
        For messages.
    q, p : ndarray, shapes (n, 2) and (n, 3)
        Pixels, and the world points (mm) that they see.
    size : (int, int)
        Of the picture, px.

    Raises
    ------
    InputError
        The points determine no camera with any lens model.

    Notes
    -----
    The rim of the picture and slabs of depth are held out as a whole: points drawn at random have neighbours
    among those that stay, so that too flexible a lens goes unnoticed. Of two models, the one with more
    numbers must be better by more than chance.
    """
    trials = [_trial(method, q, p, size, lens) for lens in CANDIDATES]
    usable = [trial for trial in trials if trial.fitted is not None]
    if not usable:
        resect(method, q, p, _kind("pinhole", size))  # says why
        raise InputError(f"{method}: no lens model images the dots without folding within the picture.")
    best = min(usable, key=lambda trial: float(trial.held_out.mean()))
    for trial in usable:
        worse = trial.held_out - best.held_out
        if trial is best or worse.mean() <= _SURE * worse.std() / np.sqrt(len(worse)):
            return _fitted(trial)
    return _fitted(best)


def _fitted(trial: LensTrial) -> ResectedCamera:
    if trial.fitted is None:
        raise InputError(f"The lens '{trial.lens}' was not fitted.")
    return trial.fitted


def _kind(lens: str, size: tuple[int, int]) -> Camera:
    """Return any camera with a lens model."""
    K = np.array([[size[0], 0.0, 0.5 * size[0]], [0.0, size[0], 0.5 * size[1]], [0.0, 0.0, 1.0]])
    return Camera(K, lens, np.zeros(8), np.eye(4), size)


def _trial(method: str, q: Pixels, p: Points, size: tuple[int, int], lens: str) -> LensTrial:
    try:
        whole = resect(method, q, p, _kind(lens, size))
    except InputError:
        return LensTrial(lens, None, np.array([np.inf]))
    if not _sees_all_between(whole.camera, q):
        return LensTrial(lens, None, np.array([np.inf]))
    squares = []
    for out in _folds(whole.camera, q, p):
        part = adjusted(whole.placed, q[~out], p[~out], Even(max(whole.sigma_px, 1e-6)))
        miss = ((part.camera.project(p[out]).q - q[out]) ** 2).sum(axis=1)
        squares.append(np.where(np.isfinite(miss), miss, np.inf))
    return LensTrial(lens, whole, np.concatenate(squares))


def _folds(camera: Camera, q: Pixels, p: Points) -> Iterator[Bool[np.ndarray, " n"]]:
    """Return which points are held out, fold by fold."""
    off = np.linalg.norm(q - np.median(q, axis=0), axis=1)
    yield off >= np.quantile(off, 1.0 - _RIM)
    distance = np.linalg.norm(transform(camera.T_cam_world, p), axis=1)
    order = np.argsort(np.argsort(distance, kind="stable"), kind="stable")
    for slab in range(_SLABS):
        yield order * _SLABS // len(p) == slab


def _sees_all_between(camera: Camera, q: Pixels) -> bool:
    """Return whether every pixel of the box around some has a ray."""
    low, high = q.min(axis=0), q.max(axis=0)
    u, v = np.meshgrid(np.linspace(low[0], high[0], _LATTICE), np.linspace(low[1], high[1], _LATTICE))
    return bool(camera.rays(np.stack([u, v], axis=-1)).ok.all())
