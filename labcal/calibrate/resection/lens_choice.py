"""The choice of a lens model by held-out known points."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.held_out import folds, simplest
from labcal.calibrate.lens_candidates import AUTO, OF_POINTS
from labcal.calibrate.resection.resected import NEAR, ResectedCamera, adjusted_with_prior, resect
from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENGTH, LENSES, PRESCRIPTION, undistorted_dist
from labcal.cameras.prescription import load_prescription, prescription_names
from labcal.cameras.window import FlatWindow
from labcal.errors import InputError, UnknownNameError
from labcal.geometry.hull import inside_hull
from labcal.geometry.poses import transform
from labcal.optim.whitening import UniformNoise

_LATTICE = 24


@dataclass(frozen=True)
class _Trial:
    """One lens model and how it did."""

    fitted: ResectedCamera
    """From all points."""
    squares: Float64[np.ndarray, " tests"]
    """Squared distances of held-out points, px squared; infinite where they cannot be imaged."""


def chosen_camera(method: str, q: Pixels, p: Vectors3, size: tuple[int, int]) -> ResectedCamera:
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
    What is held out, and what counts as no better: :mod:`labcal.calibrate.held_out`.
    """
    trials = [trial for lens in OF_POINTS if (trial := _trial(method, q, p, size, lens)) is not None]
    if not trials:
        resect(method, q, p, camera_of_lens(OF_POINTS[0], size, None))  # says why
        raise InputError(f"{method}: no lens model images the dots without folding within the picture.")
    return trials[simplest([trial.squares for trial in trials])].fitted


def camera_of_lens(lens: str, size: tuple[int, int], window: FlatWindow | None) -> Camera:
    """Return a camera of some kind, whose other parameters do not matter.

    Parameters
    ----------
    lens : str
        A lens model, or the name or file of a prescription.
    size : (int, int)
        Of the picture, px.
    window : FlatWindow, optional
        In front of the lens.

    Raises
    ------
    UnknownNameError
        There is no such lens.
    InputError
        The prescription's description cannot be read.
    """
    width, height = size
    K = np.array([[width, 0.0, 0.5 * width], [0.0, width, 0.5 * height], [0.0, 0.0, 1.0]])
    if lens in LENSES:
        return Camera(K, lens, undistorted_dist(LENSES[lens]), np.eye(4), size, window=window)
    if lens in prescription_names() or Path(lens).suffix in {".yaml", ".yml"}:
        glass = load_prescription(lens)
        return Camera(K, PRESCRIPTION, np.zeros(LENGTH), np.eye(4), size, glass, window)
    raise UnknownNameError("lens", lens, [AUTO, *LENSES, *prescription_names()])


def _trial(method: str, q: Pixels, p: Vectors3, size: tuple[int, int], lens: str) -> _Trial | None:
    """Return how a lens model does, or None where it cannot be fitted.

    A part of the points is fitted with the prior of all of them: the camera that is tried is one estimator.
    """
    try:
        whole = resect(method, q, p, camera_of_lens(lens, size, None))
    except InputError:
        return None
    if not _sees_all_between(whole.camera, q):
        return None
    noise = UniformNoise(max(whole.sigma_px, 1e-6))
    squares = []
    for out in folds(q, np.linalg.norm(transform(whole.camera.T_cam_world, p), axis=1)):
        part = adjusted_with_prior(whole.placed, q[~out], p[~out], noise, NEAR, whole.held)
        residual = ((part.camera.project(p[out]).q - q[out]) ** 2).sum(axis=1)
        squares.append(np.where(np.isfinite(residual), residual, np.inf))
    return _Trial(whole, np.concatenate(squares))


def _sees_all_between(camera: Camera, q: Pixels) -> bool:
    """Return whether every pixel of the convex hull of some has a ray.

    The corners of the box around them are no measure: in the round picture of a fisheye no dot is there, and
    a polynomial that ends short of them may be exact for all dots.
    """
    low, high = q.min(axis=0), q.max(axis=0)
    u, v = np.meshgrid(np.linspace(low[0], high[0], _LATTICE), np.linspace(low[1], high[1], _LATTICE))
    lattice = np.stack([u.ravel(), v.ravel(), np.zeros(u.size)], axis=1)
    between = lattice[inside_hull(lattice, np.column_stack([q, np.zeros(len(q))]), 0.0), :2]
    return bool(camera.rays(between).ok.all())
