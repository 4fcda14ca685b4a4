"""One light on dot and board, as far as a picture says so, as a further measurement of its dots."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import PixelCovariances, Pixels
from labcal.detect.edges.edge_model import PARAMETERS, STATE, TINY
from labcal.detect.edges.residuals import COVARIANCE, SLOPE_DIFFERENCE, SLOPE_DIFFERENCE_COVARIANCE
from labcal.detect.matrices import inverses
from labcal.detect.medians import median_of
from labcal.detect.stage_settings.edge import EdgeSettings

_MEDIAN_SQUARE = 0.4549
"""The median of chi-square's distribution with one degree of freedom."""
_TWICE = np.array([0, 1, 1, 2])
"""xx xy yy as a matrix."""


@dataclass(frozen=True)
class OneLight:
    """The Kalman update of a picture's centres by the difference of the slopes of board and dot.

    A small dot does not distinguish a slope of its grey values from a shift. But its slope is that of the
    board, as far as the picture's dots together show: the differences scatter by more than their noise where
    paper shines or a lens glares.

    Attributes
    ----------
    gain : ndarray, shape (n, 2, 2)
        Of the centres (px) on the slope differences; 0 where there are none.
    scatter : float
        Variance of the differences beyond their noise.
    """

    gain: PixelCovariances
    scatter: float

    @classmethod
    def of(cls, table: Float64[np.ndarray, "n c"], factor: float, settings: EdgeSettings) -> "OneLight":
        """Return the update for fits, see :func:`~labcal.detect.edges.gauss_newton.fit_all`.

        Parameters
        ----------
        table : ndarray, shape (n, COLUMNS)
        factor : float
            Factor by which correlated noise widens the covariances of slopes.
        settings : EdgeSettings
        """
        _, noise, shared = (factor * part for part in _covariances(table))
        off = table[:, SLOPE_DIFFERENCE : SLOPE_DIFFERENCE + 2]
        known = np.isfinite(off[:, 0])
        if not known.any():
            return cls(np.zeros((len(table), 2, 2)), 0.0)
        expected = median_of(np.diagonal(noise[known], axis1=1, axis2=2))
        seen = median_of(off[known] ** 2) / _MEDIAN_SQUARE - expected
        count = 2 * int(known.sum())
        usual = settings.shared_light_count * settings.shared_light_share**2
        scatter = (count * max(seen, 0.0) + usual) / (count + settings.shared_light_count)
        return cls(shared @ inverses(noise + scatter * np.eye(2)), float(scatter))

    def select(self, which: np.ndarray) -> "OneLight":
        """Return the update of some of the dots, by index."""
        return OneLight(self.gain[which], self.scatter)

    def centres(self, table: Float64[np.ndarray, "n c"]) -> Pixels:
        """Return the updated centres, px."""
        off = table[:, SLOPE_DIFFERENCE : SLOPE_DIFFERENCE + 2]
        moved: Pixels = table[:, :2] - np.einsum("nij,nj->ni", self.gain, off)
        return moved

    def covariances(self, table: Float64[np.ndarray, "n c"], factor: float) -> PixelCovariances:
        """Return the covariances of the updated centres, px squared.

        Joseph's form, which holds for any gain: that of the least variance belongs to another noise.

        Parameters
        ----------
        table : ndarray, shape (n, COLUMNS)
        factor : float
            Variance of the noise over that which the table counts with.
        """
        own, noise, shared = _covariances(table)
        gain, back = self.gain, np.swapaxes(self.gain, 1, 2)
        crossed = gain @ np.swapaxes(shared, 1, 2)
        pixels = own - crossed - np.swapaxes(crossed, 1, 2) + gain @ noise @ back
        covariance = factor * pixels + self.scatter * (gain @ back)
        covariance[:, 1, 0] = covariance[:, 0, 1]  # but for the last bit they are the same
        updated: PixelCovariances = covariance
        return updated

    def weights(self, table: Float64[np.ndarray, "n c"], black: float) -> Float64[np.ndarray, "n 2 p"]:
        """Return the weights of a fit's parameters in the updated centre.

        Parameters
        ----------
        table : ndarray, shape (n, COLUMNS)
        black : float
            Grey value of no light.
        """
        board, dot = table[:, STATE] - black, table[:, STATE + 3] - black
        scale = np.maximum(np.maximum(np.abs(board), np.abs(dot)), TINY) * np.maximum(
            np.abs(dot - board), TINY
        )
        weights = np.zeros((len(table), 2, PARAMETERS))
        weights[:, [0, 1], [0, 1]] = 1.0
        for axis in range(2):
            weights[:, :, STATE + 1 + axis] = self.gain[:, :, axis] * (dot / scale)[:, None]
            weights[:, :, STATE + 4 + axis] = -self.gain[:, :, axis] * (board / scale)[:, None]
        return weights


def _covariances(
    table: Float64[np.ndarray, "n c"],
) -> tuple[PixelCovariances, PixelCovariances, PixelCovariances]:
    """Return the covariances of centres, of slope differences, and of the former with the latter."""
    own = table[:, COVARIANCE + _TWICE].reshape(-1, 2, 2)
    noise = table[:, SLOPE_DIFFERENCE_COVARIANCE + _TWICE].reshape(-1, 2, 2)
    shared = table[:, SLOPE_DIFFERENCE_COVARIANCE + 3 + np.arange(4)].reshape(-1, 2, 2)
    return own, noise, shared
