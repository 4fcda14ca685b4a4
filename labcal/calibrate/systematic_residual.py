"""Test of triangulation residuals for what noise and calibration do not explain: pictures that have shifted.

Noise of single dots averages out over a table; a camera that has moved, or pictures that are cropped anew,
shift all residuals alike. What the calibration itself leaves of such shifts follows from its covariance.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import Vectors3
from labcal.calibrate.residual_level import CHANCE
from labcal.calibrate.residual_parts import ResidualParts
from labcal.calibrate.triangulation_check import scatter_of
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.camera import Camera
from labcal.correspond.matching import Matches
from labcal.distributions import chi2_upper

MOST = 3000
"""Points that are tested: more add nothing that the calibration's own errors would not cover."""
_OUTLYING = 60.0
"""Times the median square of residuals: of normal ones one in ten billion."""
_FEWEST = 20
"""Points."""
_DETERMINED = 1e-6
"""Singular value over the largest one, from which on a change of pictures shows in residuals."""


@dataclass(frozen=True)
class SystematicResidual:
    """Shifts, rotations and changes of scale of whole pictures, as far as triangulation residuals show them.

    Attributes
    ----------
    rms_px : float
        RMS length of the part of the residuals that such changes explain.
    expected_px : float
        Its expected value by the noise of pixels and the covariance of the calibration.
    p_value : float
        Probability of so large a part, or a larger one, by noise and calibration alone.
    """

    rms_px: float
    expected_px: float
    p_value: float

    @property
    def beyond_chance(self) -> bool:
        """True if chance explains it but once in ten thousand good tables: a camera has changed."""
        return self.p_value < CHANCE


def systematic_residual(
    cameras: Sequence[Camera],
    matches: Matches,
    point: Vectors3,
    parameters: Float64[np.ndarray, "parameters parameters"],
    calibration: CalibrationRecord,
) -> SystematicResidual | None:
    """Return the systematic part of triangulation residuals; None of too few points.

    Parameters
    ----------
    cameras : sequence of Camera
        In the order of the matches; the first one is the world.
    matches : Matches
        Images of centres.
    point : ndarray, shape (n, 3)
        As triangulated from these, mm; NaN where there is none.
    parameters : ndarray
        Joint covariance of the cameras, in the order of ``rig.json``.
    calibration : CalibrationRecord
        Its variance component counts as noise. So much of a systematic part as its own views had, of a print
        or a lens that the model does not know, is expected in others, too.

    Notes
    -----
    The parts N'r of a point's residuals r (:class:`~labcal.calibrate.residual_parts.ResidualParts`) have the
    derivatives -N'G by the cameras' parameters. Of all points together, z = U'(N'r) with an orthonormal basis
    U of what changes of whole pictures do to N'r has the covariance U'(N'SN + N'G C G'N)U, where S holds the
    variances of pixels and C that of the cameras: z' cov^-1 z is chi-square.
    """
    rows = np.flatnonzero(np.isfinite(point).all(axis=1))
    rows = rows[:: -(-len(rows) // MOST) or 1]
    if len(rows) < _FEWEST:
        return None
    chosen = range(len(cameras))
    parts = ResidualParts.of(cameras, chosen, matches.where(rows), point[rows], scatter_of(calibration))
    good = _inlying(parts.seen, parts.noise)
    null, seen, noise = parts.null[good], parts.seen[good], parts.noise[good]
    by = parts.by_cameras[good].reshape(seen.size, -1)
    changes = np.einsum("nkw,nwc->nkc", null, _changes(cameras, parts.q[good])).reshape(seen.size, -1)
    U, size, _ = np.linalg.svd(changes / np.linalg.norm(changes, axis=0).clip(1e-300), full_matrices=False)
    U = U[:, size > _DETERMINED * size[0]]
    z = U.T @ seen.ravel()
    blocks = U.reshape(len(seen), -1, U.shape[1])
    covariance = np.einsum("nka,nkj,njb->ab", blocks, noise, blocks)
    by_noise = float(np.trace(covariance))
    moved = U.T @ by
    covariance += moved @ parameters @ moved.T
    pixels = len(seen) * len(cameras)
    if calibration.systematic_px is not None:
        # Errors of the cameras do not show in views that these were adjusted to: noise alone explains a part.
        more = calibration.systematic_px**2 * pixels - by_noise
        covariance += max(0.0, more) / len(z) * np.eye(len(z))
    chi_square = float(z @ np.linalg.solve(covariance, z))
    return SystematicResidual(
        rms_px=float(np.sqrt((z**2).sum() / pixels)),
        expected_px=float(np.sqrt(np.trace(covariance) / pixels)),
        p_value=chi2_upper(chi_square, len(z)),
    )


def _changes(
    cameras: Sequence[Camera], q: Float64[np.ndarray, "n cameras 2"]
) -> Float64[np.ndarray, "n pixels changes"]:
    """Return shifts along x and y, rotation and change of scale of each camera's pictures, px."""
    changes = np.zeros((len(q), 2 * len(cameras), 4 * len(cameras)))
    for number, camera in enumerate(cameras):
        x, y = (q[:, number] - 0.5 * np.array(camera.size)).T / max(camera.size)
        one, o = np.ones_like(x), np.zeros_like(x)
        own = np.stack([np.stack(pair, axis=1) for pair in ((one, o), (o, one), (-y, x), (x, y))], axis=2)
        changes[:, 2 * number : 2 * number + 2, 4 * number : 4 * number + 4] = own
    return changes


def _inlying(seen: Float64[np.ndarray, "n k"], noise: Float64[np.ndarray, "n k k"]) -> Bool[np.ndarray, " n"]:
    """Return a mask of points that are no outliers among the others, wherever these are."""
    square = np.einsum("nk,nkj,nj->n", seen, np.linalg.inv(noise), seen)
    return np.asarray(square <= _OUTLYING * np.median(square))
