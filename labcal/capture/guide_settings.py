"""Settings of a guided capture."""

from dataclasses import dataclass

import numpy as np

from labcal.errors import InputError

MOST_VIEWS = 40
"""Views after which a guided capture ends, where no number is given."""
FEWEST_STATED = 4
"""Usable views from which on an expected error is stated: residuals of fewer hardly test the lens model."""


@dataclass(frozen=True)
class GuideSettings:
    """Settings of a guided capture.

    Examples
    --------
    >>> from labcal.pipeline import GuideSettings
    >>> GuideSettings(wanted_mm=0.05, volume_mm=(300.0, 200.0, 100.0)).lens
    'brown5'
    """

    wanted_mm: float | None = None
    """RMS 3-D error over the volume at which the capture ends; without it, it goes on to the number of
    views."""
    volume_mm: tuple[float, ...] | None = None
    """Sides of the volume in which points will be measured: across, upright and in depth, mm, about the place
    of the target in the first view. What all cameras see at that distance, where left out."""
    lens: str = "brown5"
    """Lens model of the calibrations on the way."""
    hand_error: str = "5deg,5%"
    """Of `sim`: errors of the simulated hand that takes the poses asked for, an angle and a share of the
    distance."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError
            A length is not positive.
        """
        if self.wanted_mm is not None and not (np.isfinite(self.wanted_mm) and self.wanted_mm > 0.0):
            raise InputError(
                f"`wanted_mm`, the error to reach, must be more than 0 mm, but {self.wanted_mm} was given."
            )
        if self.volume_mm is not None:
            sides = np.array(self.volume_mm, dtype=np.float64)
            if sides.shape != (3,) or not (np.isfinite(sides).all() and (sides > 0.0).all()):
                raise InputError(
                    "`volume_mm` has three sides of more than 0 mm: across, upright and in depth, as in "
                    f"300,200,100, but {','.join(f'{side:g}' for side in np.ravel(sides))} was given."
                )
