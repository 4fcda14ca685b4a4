"""Smooth errors of residuals, compared with the scatter of single dots."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.rows import linearised_rows
from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.single_calibration import AdjustedDots
from labcal.optim.robust import SQUARES

_DEGREE = 2
_FEWEST_DOTS = 12
"""Of a picture that has a say: what poses and smooth errors leave over."""
_RANK = 1e-6


@dataclass(frozen=True)
class SmoothErrors:
    """Energy of the smooth part of the residuals of a camera that its pose does not absorb.

    A lens that does not suit, an uneven print or the detection itself makes errors that neighbouring dots
    share. They move a pose by more than independent errors of the same size would; by how much, those
    smooth errors tell that are next to the six which a pose takes up: polynomials of second degree over the
    target.
    """

    energy: float
    """Sum of squares, in units of the dots' variances."""
    freedom: float
    """The same for independent errors of dots."""

    @classmethod
    def of(cls, result: AdjustedDots) -> "SmoothErrors":
        """Return the smooth errors of a single-camera calibration."""
        end = result.adjusted
        dots = result.observations.moved(-end.eccentricity).where(~end.outlier).scattered(end.scatter_px**2)
        energy, freedom = 0.0, 0.0
        for run in dots.runs:
            rows = linearised_rows(end.layout, dots, run, SQUARES)
            for picture, at in run.within():
                if at.stop - at.start >= _FEWEST_DOTS:
                    smooth = _smooth(rows[-POSE - 1 : -1, :, at], end.state.dots, dots, picture.rows)
                    energy += float(((smooth.T @ rows[-1, :, at].ravel()) ** 2).sum())
                    freedom += smooth.shape[1]
        lens = end.layout.lens[0]
        return cls(energy, max(freedom - (lens.stop - lens.start), 0.0))

    @classmethod
    def together(cls, parts: "list[SmoothErrors]") -> "SmoothErrors":
        """Return the smooth errors of several cameras."""
        return cls(sum(part.energy for part in parts), sum(part.freedom for part in parts))

    @property
    def inflation(self) -> float:
        """Factor by which pose variances exceed those of independent errors, at least 1."""
        return max(1.0, self.energy / self.freedom) if self.freedom > 0.0 else 1.0


def _smooth(
    by_pose: Float64[np.ndarray, "6 2 m"],
    places: Float64[np.ndarray, "dots 3"],
    dots: Observations,
    rows: slice,
) -> Float64[np.ndarray, "twom modes"]:
    """Return an orthonormal basis of smooth errors of a picture that its pose does not absorb."""
    x, y = places[dots.dot[rows], :2].T
    x, y = (x - x.mean()) / (np.ptp(x) or 1.0), (y - y.mean()) / (np.ptp(y) or 1.0)
    powers = [x**i * y**j for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]
    fields = np.zeros((2 * len(powers), 2, len(x)))
    fields[0::2, 0], fields[1::2, 1] = powers, powers
    white = dots.whitener.rows(rows).whiten(fields)
    columns = np.concatenate([by_pose, white]).reshape(POSE + len(white), -1).T
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    basis, triangle = np.linalg.qr(columns)
    found = np.abs(np.diagonal(triangle)) > _RANK
    found[:POSE] = False
    return np.asarray(basis[:, found])
