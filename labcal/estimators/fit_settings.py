"""Settings of the fitting of methods."""

from dataclasses import dataclass

from labcal.arguments import choice_of, one_text, real_number, set_checked, truth_value, whole_number
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.lens_candidates import AUTO
from labcal.correspond.view_roles import HoldOut, checked_hold_out
from labcal.estimators.stage_errors import StageSigma

_MOST_SIGMA_MM, _MOST_SIGMA_DEG = 1000.0, 10.0
"""Of a stage."""


@dataclass(frozen=True)
class FitSettings:
    """Settings of a fit.

    Examples
    --------
    >>> from labcal.pipeline import FitSettings
    >>> FitSettings(lens="brown5", hold_out=("view-3", "view-7")).hold_out
    ('view-3', 'view-7')
    """

    lens: str = AUTO
    """Lens of methods with cameras, and of the adjustment that places a hand-held target."""
    seed: int = 0
    """Seed of whatever is random in a method."""
    dot_places: DotTreatment | str = DotTreatment.AUTO
    """As in :class:`~labcal.calibrate.handheld.HandheldSettings`, of a hand-held target."""
    rehearsal: bool = True
    """True to validate each method on a surrogate, which gives its expected error."""
    hold_out: HoldOut = ()
    """Views of a hand-held target that do not enter."""
    stage_sigma_mm: float | None = None
    """Standard deviation of a stage's places of the target along each axis, mm; independent between views."""
    stage_sigma_deg: float | None = None
    """Standard deviation of a stage's rotations of the target about each axis through its origin, deg."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, or the seed is negative.
        """
        values = {
            "lens": one_text(self.lens, "lens"),
            "seed": whole_number(self.seed, "seed", 0),
            "dot_places": choice_of(self.dot_places, DotTreatment, "dot_places"),
            "rehearsal": truth_value(self.rehearsal, "rehearsal"),
            "hold_out": checked_hold_out(self.hold_out),
            "stage_sigma_mm": _sigma(self.stage_sigma_mm, "stage_sigma_mm", _MOST_SIGMA_MM),
            "stage_sigma_deg": _sigma(self.stage_sigma_deg, "stage_sigma_deg", _MOST_SIGMA_DEG),
        }
        set_checked(self, values)

    @property
    def stage_sigma(self) -> StageSigma | None:
        """The stated errors of a stage; one that is left out counts as none. None where neither is stated."""
        if self.stage_sigma_mm is None and self.stage_sigma_deg is None:
            return None
        return StageSigma(self.stage_sigma_mm or 0.0, self.stage_sigma_deg or 0.0)


def _sigma(given: object, name: str, most: float) -> float | None:
    return None if given is None else real_number(given, name, (0.0, most))
