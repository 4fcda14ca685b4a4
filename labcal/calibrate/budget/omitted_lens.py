"""The share of a lens's omitted coefficients in a calibration's errors: a model that is a step too simple.

A lens model without decentring takes every lens for centred. Real ones are decentred a little, and through a
long lens residuals do not tell: poses and principal point follow. What is left open is then as large as
lenses are known to be off, and as residuals allow.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.prior_term import LensPrior
from labcal.calibrate.adjustment.problem import AdjustmentProblem
from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.budget.entered import Entered
from labcal.calibrate.budget.print_share import reduced_information
from labcal.calibrate.lens_prior import border_effects
from labcal.calibrate.lens_start import camera_as_lens
from labcal.cameras.lens import lens_by_name
from labcal.cameras.optics import INTRINSICS

_SIMPLE, _NEXT = ("pinhole", "brown-k1k2"), "brown5"
_SIZE = 0.001
"""One standard deviation of what an omitted coefficient does at the border of a picture, over its width: a
choice of this package, a pixel in a picture of 1,000. Residuals make it smaller where they tell."""


def omitted_errors(entered: Entered, noise: float) -> Float64[np.ndarray, "cameras omitted"]:
    """Return the errors of the cameras' parameters by coefficients that their lenses do not have.

    Parameters
    ----------
    entered : Entered
        With free lenses.
    noise : float
        Variance of residuals over the one that their covariances state.

    Returns
    -------
    ndarray, shape (cameras, omitted)
        The product with its transpose is their share in the covariance; no columns where no lens is a
        simple one.

    Notes
    -----
    To first order the parameters k of the simple model are off by A o, where o are the true omitted
    coefficients and A = H_kk^-1 H_ko follows from the information H. Of o the residuals and a prior about 0
    leave the mean m and the covariance V, so that the mean square of the error is A (V + m m') A'. It adds to
    the covariance of the simple model.
    """
    cameras = entered.state.cameras
    simple = [camera.lens in _SIMPLE for camera in cameras]
    if not any(simple):
        return np.zeros((entered.cameras, 0))
    larger = tuple(
        camera_as_lens(camera, _NEXT, "") if one else camera
        for camera, one in zip(cameras, simple, strict=True)
    )
    state = replace(entered.state, cameras=larger)
    freedom = entered.adjusted.layout.freedom
    prior = LensPrior.of(state, entered.observations, Lenses.FREE, entered.adjusted.prior_width)
    end = AdjustmentProblem(entered.observations, freedom, prior=prior).linearize(state)
    information, gradient = reduced_information(end)
    kept = np.ones(len(gradient), dtype=bool)
    weights = []
    for own, camera, old in zip(end.layout.lens, larger, cameras, strict=True):
        first = own.start + INTRINSICS + old.model.coefficients
        kept[first : own.stop] = False
        weights.append(border_effects(camera)[old.model.coefficients :] / (_SIZE * camera.size[0]))
    H, across = information[np.ix_(kept, kept)], information[np.ix_(kept, ~kept)]
    A = _solved(H, across)
    B = (information[np.ix_(~kept, ~kept)] - across.T @ A) / noise + np.diag(np.concatenate(weights) ** 2)
    score = (gradient[~kept] - A.T @ gradient[kept]) / noise
    V = np.linalg.inv(B)
    mean = -V @ score
    values, axes = np.linalg.eigh(V + np.outer(mean, mean))
    return np.asarray((A[: entered.cameras] @ axes) * np.sqrt(np.maximum(values, 0.0)))


def omitted_coefficients(lens: str) -> tuple[str, ...]:
    """Return the names of the coefficients that a lens model lacks and the budget allows for."""
    own = lens_by_name(lens).coefficients
    return lens_by_name(_NEXT).names[own:] if lens in _SIMPLE else ()


def _solved(H: Float64[np.ndarray, "n n"], right: Float64[np.ndarray, "n m"]) -> Float64[np.ndarray, "n m"]:
    """Return H^-1 right, with units in which every parameter alone has a curvature of 1."""
    scale = np.sqrt(np.maximum(np.diagonal(H), np.finfo(np.float64).tiny))
    return np.asarray(
        np.linalg.lstsq(H / np.outer(scale, scale), right / scale[:, None], rcond=1e-12)[0] / scale[:, None]
    )
