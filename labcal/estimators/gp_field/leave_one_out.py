"""Leave-one-out predictions of a camera with a residual field, in closed form."""

import numpy as np
import scipy.linalg

from labcal.arrays import Pixels, Vectors3
from labcal.estimators.gp_field.fitted_camera import Asked, FittedCamera


def log_predictive_density(camera: FittedCamera, q: Pixels, p: Vectors3) -> float:
    """Return how well each trained pixel is predicted by all the others: the sum of log densities.

    Of the same pixels it can be compared between lens formulas, which the restricted likelihood cannot: that
    depends on what each formula can take up.

    Parameters
    ----------
    camera : FittedCamera
        Fitted to `q` and `p`.
    q, p : ndarray, shapes (n, 2) and (n, 3)
        Trained pixels, and the world points (mm) that they see.

    Returns
    -------
    float
        In natural logarithms, but for a constant.

    Notes
    -----
    With V the covariance of the residuals r, J their derivatives by the camera, and P the inverse of V
    without what J takes up, the error of a point that is left out is ``P_ii^-1 (P r)_i`` with the covariance
    ``P_ii^-1`` (Rasmussen and Williams 2006, section 5.4.2; Dubrule 1983 for free parameters). The kernel's
    hyperparameters are those of all points. A field that is asked where light arrives gives the density of
    measured minus explained pixels; that of the pixels takes the determinant of how the former change with
    the latter.
    """
    n = len(p)
    J = camera.placed.seen(p).by_camera
    residual = q - camera.camera.project(p).q
    root = camera.noise_px * np.eye(n)
    if camera.fitted is not None:
        root, residual = camera.fitted.field.root, camera.fitted.field.residual
    inverse = scipy.linalg.cho_solve((root, True), np.eye(n), check_finite=False)
    scale = np.linalg.norm(J.reshape(2 * n, -1), axis=0)
    basis = J / np.where(scale > 0.0, scale, 1.0)
    solved = np.tensordot(inverse, basis, axes=1)
    normal = np.linalg.pinv(np.tensordot(basis, solved, axes=((0, 1), (0, 1))), hermitian=True)
    precision = np.diagonal(inverse)[:, None, None] * np.eye(2) - solved @ normal @ solved.mT
    weighted = inverse @ residual
    weighted = weighted - solved @ (normal @ np.tensordot(basis, weighted, axes=((0, 1), (0, 1))))
    squares = (weighted * np.linalg.solve(precision, weighted[..., None])[..., 0]).sum(axis=1)
    density = 0.5 * float(np.linalg.slogdet(precision)[1].sum() - squares.sum())
    if camera.fitted is None or camera.fitted.asked is Asked.IDEAL:
        return density
    field = camera.fitted.field
    turn = np.eye(2) - field.slopes(field.x)[:, :, :2] / camera.fitted.places.width_px
    with np.errstate(divide="ignore"):
        return density + float(np.log(np.maximum(np.linalg.det(turn), 0.0)).sum())
