"""Places that a method gives, without those beyond all sense."""

import numpy as np

from labcal.arrays import Vectors3
from labcal.bounds import MOST_MM


def sensible_places(found: Vectors3) -> Vectors3:
    """Return points with NaN in place of those beyond `MOST_MM`, whose squares may be no numbers any more.

    Parameters
    ----------
    found : float64 array, (n, 3)
        Mm; NaN where a method gives none.

    Examples
    --------
    >>> sensible_places(np.array([[1.0, 2.0, 3.0], [0.0, 1e200, 0.0]])).tolist()
    [[1.0, 2.0, 3.0], [nan, nan, nan]]
    """
    sensible = (np.abs(found) <= MOST_MM).all(axis=1, keepdims=True)
    return np.where(sensible, found, np.nan)
