"""The treatment of a target's dots in a calibration, and the decision on it."""

from dataclasses import dataclass
from enum import StrEnum


class DotTreatment(StrEnum):
    """Treatment of the dots' places on the print: taken as declared, or estimated."""

    AUTO = "auto"
    """Freed where held-out views are predicted better so, and the cameras become more certain."""
    FREED = "freed"
    DECLARED = "declared"


@dataclass(frozen=True)
class DotDecision:
    """The treatment of the dots, and the evidence for it; figures are None where nothing was measured.

    Attributes
    ----------
    asked : DotTreatment
        The treatment that was asked for.
    treatment : DotTreatment
        The one that was used, freed or declared.
    why : str
        The reason, for people.
    unevenness : float or None
        Standard normal deviate of the score test of an even print, largest over cameras.
    declared_px, freed_px : float or None
        RMS of the 2-D distance in held-out views with the dots as declared and freed.
    chance : float or None
        Probability that held-out views are predicted better by freed dots to this degree by chance.
    variance_ratio : float or None
        Mean variance of points by the calibration with freed dots, over that with declared dots and their
        errors.
    """

    asked: DotTreatment
    treatment: DotTreatment
    why: str
    unevenness: float | None = None
    declared_px: float | None = None
    freed_px: float | None = None
    chance: float | None = None
    variance_ratio: float | None = None

    @property
    def frees(self) -> bool:
        """True if the dots are freed."""
        return self.treatment is DotTreatment.FREED
