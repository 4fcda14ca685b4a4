"""Marks to look for in pictures, and how."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import isfinite

from labcal.arguments import any_number, one_text, set_checked, settings_of, wrong_type
from labcal.bounds import MOST_MM
from labcal.detect.settings import DetectSettings
from labcal.errors import InputError
from labcal.paths import AnyPath
from labcal.shoot.tone_curve import AnyToneCurve, ToneCurve
from labcal.wording import shown


@dataclass(frozen=True)
class MarkSearch:
    """Marks to look for in pictures, and how.

    Examples
    --------
    >>> from labcal.pipeline import MarkSearch
    >>> MarkSearch("apriltag-36h11,ring-23", mark_diameter=6.0).markers
    ('apriltag-36h11', 'ring-23')
    """

    markers: tuple[str, ...] | str
    """Kinds of marks, in one text with commas, or as a sequence: dictionaries of tags (``apriltag-36h11``,
    ``aruco-4x4-50``), codes of coded dots (``ring-23``) or their sheets (``coded-8x6``), plain dots
    (``dots``)."""
    mark_diameter: float | None = None
    """Diameter of coded and of plain dots, mm, where it is known; a sheet of coded dots states its own."""
    tone_curve: AnyToneCurve | AnyPath = ToneCurve.LINEAR
    """The camera's, which is undone first."""
    detector: DetectSettings | None = None
    """Thresholds, sizes and counts of the detector; the defaults where left out."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, no kind of marks is named, or the diameter is none.
        """
        diameter = None if self.mark_diameter is None else _diameter(self.mark_diameter)
        detector = settings_of(self.detector, DetectSettings)
        set_checked(self, {"markers": _names(self.markers), "mark_diameter": diameter, "detector": detector})

    @property
    def names(self) -> tuple[str, ...]:
        """Kinds of marks."""
        return tuple(self.markers)


def _names(given: object) -> tuple[str, ...]:
    """Return the names of kinds of marks."""
    if isinstance(given, str):
        names = [name.strip() for name in given.split(",")]
    elif isinstance(given, Iterable):
        names = [one_text(name, "markers") for name in given]
    else:
        raise wrong_type(given, "a text, or a sequence of texts", "markers")
    if not names or not all(names):
        raise InputError(
            f"`markers` names kinds of marks, as in 'apriltag-36h11' or 'ring-23,dots', but {shown(given)} "
            "was given."
        )
    return tuple(names)


def _diameter(given: object) -> float:
    """Return a diameter, mm."""
    diameter = any_number(given, "mark_diameter", "a number of mm")
    if not (isfinite(diameter) and 0.0 < diameter <= MOST_MM):
        raise InputError(
            f"`mark_diameter` is the diameter of the dots, a positive number of mm, but {shown(given)} was "
            "given."
        )
    return diameter
