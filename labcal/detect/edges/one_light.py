"""One light on dot and board, as far as a picture says so, as a further measurement of its dots."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import PixelCovariances, Pixels
from labcal.detect.edges.light_sums import gains, parameter_weights, updated_centres, updated_covariances
from labcal.detect.edges.residuals import SLOPE_DIFFERENCE, SLOPE_DIFFERENCE_COVARIANCE
from labcal.detect.medians import median_of
from labcal.detect.stage_settings.edge import EdgeSettings

_MEDIAN_SQUARE = 0.4549
"""The median of chi-square's distribution with one degree of freedom."""
_OWN_NOISE = [SLOPE_DIFFERENCE_COVARIANCE, SLOPE_DIFFERENCE_COVARIANCE + 2]
"""Columns of the variances of both slope differences."""


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
        off = table[:, SLOPE_DIFFERENCE : SLOPE_DIFFERENCE + 2]
        known = np.isfinite(off[:, 0])
        if not known.any():
            return cls(np.zeros((len(table), 2, 2)), 0.0)
        expected = median_of(factor * table[known][:, _OWN_NOISE])
        seen = median_of(off[known] ** 2) / _MEDIAN_SQUARE - expected
        count = 2 * int(known.sum())
        usual = settings.shared_light_count * settings.shared_light_share**2
        scatter = (count * max(seen, 0.0) + usual) / (count + settings.shared_light_count)
        return cls(gains(table, factor, float(scatter)), float(scatter))

    def select(self, which: np.ndarray) -> "OneLight":
        """Return the update of some of the dots, by index."""
        return OneLight(self.gain[which], self.scatter)

    def centres(self, table: Float64[np.ndarray, "n c"]) -> Pixels:
        """Return the updated centres, px."""
        return updated_centres(table, self.gain)

    def covariances(self, table: Float64[np.ndarray, "n c"], factor: float) -> PixelCovariances:
        """Return the covariances of the updated centres, px squared.

        Joseph's form, which holds for any gain: that of the least variance belongs to another noise.

        Parameters
        ----------
        table : ndarray, shape (n, COLUMNS)
        factor : float
            Variance of the noise over that which the table counts with.
        """
        return updated_covariances(table, self.gain, factor, self.scatter)

    def weights(self, table: Float64[np.ndarray, "n c"], black: float) -> Float64[np.ndarray, "n 2 p"]:
        """Return the weights of a fit's parameters in the updated centre.

        Parameters
        ----------
        table : ndarray, shape (n, COLUMNS)
        black : float
            Grey value of no light.
        """
        return parameter_weights(table, self.gain, black)
