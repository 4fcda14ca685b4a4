"""Findings of a diagnosis, and checks that could not be made."""

from dataclasses import dataclass

from labcal.guide.diagnosis.check_name import CheckName

LEVEL = 1e-3
"""Probability of each check to accuse a good shoot: all checks together stay below 2%."""
LEAST_HARM = 0.1
"""Relative increase of the expected 3-D error from which on a mistake is reported."""


@dataclass(frozen=True)
class Finding:
    """A mistake that was found.

    Attributes
    ----------
    check : CheckName
    cameras, views : tuple of str
        Those that it concerns; views in the order of the shoot.
    words : str
        What is wrong, in one or two sentences for people.
    mend : str
        What to do, in one or two sentences.
    p_value : float or None
        Probability that a good shoot shows as much; None where the mistake is seen and no test is made.
    harm_mm : float or None
        Expected RMS 3-D error over the volume of the target's dots that the mistake adds; None where it
        cannot be computed. Infinite where no rig explains the dots.
    harm_percent : float or None
        Relative increase of the expected RMS 3-D error by it, %.
    pictures : tuple of str
        Paths of the pictures that show it best, the clearest first.
    explained_by : CheckName or None
        Another finding that explains this one.
    """

    check: CheckName
    cameras: tuple[str, ...]
    views: tuple[str, ...]
    words: str
    mend: str
    p_value: float | None = None
    harm_mm: float | None = None
    harm_percent: float | None = None
    pictures: tuple[str, ...] = ()
    explained_by: CheckName | None = None


@dataclass(frozen=True)
class NotJudged:
    """A check that could not be made.

    Attributes
    ----------
    check : CheckName
    why : str
        Reason, and what would decide it, for people.
    """

    check: CheckName
    why: str


CheckResult = tuple[Finding, ...] | NotJudged
"""The findings of a check, mostly none or one; or why it could not be made."""
