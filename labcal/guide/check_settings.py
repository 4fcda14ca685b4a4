"""Settings of the check of a calibration: its log, and marks that stay where they are."""

from dataclasses import dataclass
from math import isfinite

from labcal.arguments import any_number, one_text, set_checked
from labcal.correspond.mark_search import MarkSearch
from labcal.correspond.named_points import NamedPoints
from labcal.errors import InputError
from labcal.guide.check_log import MOST_LETTERS, checked_date
from labcal.paths import AnyPath, as_text
from labcal.wording import has_control, shown

_COLDEST, _HOTTEST = -273.15, 1e4


@dataclass(frozen=True)
class CheckSettings:
    """The log that a check is added to, and the fixed marks that it may go by.

    Examples
    --------
    >>> from labcal.pipeline import CheckSettings
    >>> CheckSettings(log="checks.jsonl", temperature_c=21.5, note="after the move").temperature_c
    21.5
    """

    log: AnyPath | None = None
    """File that the check is added to, a line of JSON each; it is made if it is not there."""
    date: str | None = None
    """Of the check, ISO 8601; now, in UTC, if left out."""
    temperature_c: float | None = None
    """Degrees Celsius."""
    note: str = ""
    places: NamedPoints | AnyPath | None = None
    """Places of marks that stay where they are, as this rig measured them before, or the table of them; in
    place of a target."""
    markers: MarkSearch | str | tuple[str, ...] | list[str] | None = None
    """Kinds of these marks, where the check is given pictures and no named pixels."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, is no date or no temperature, or goes with a log or with places and there
            are none.
        """
        note = one_text(self.note, "note") if self.note != "" else ""
        if len(note) > MOST_LETTERS or has_control(note):
            raise InputError(
                f"`note` is a line of at most {MOST_LETTERS} letters without control characters, but "
                f"{shown(note)} was given."
            )
        values = {
            "log": None if self.log is None else as_text(self.log),
            "date": None if self.date is None else checked_date(one_text(self.date, "date")),
            "temperature_c": None if self.temperature_c is None else _temperature(self.temperature_c),
            "note": note,
            "places": self.places if isinstance(self.places, NamedPoints | None) else as_text(self.places),
            "markers": _search(self.markers),
        }
        if self.markers is not None and self.places is None:
            raise InputError(
                "`markers` are marks that stay where they are, whose places have to be known. Give `places`, "
                "the table of them that 'labcal measure' wrote, or leave it out."
            )
        for name in ("date", "temperature_c", "note"):
            if self.log is None and values[name] not in (None, ""):
                raise InputError(f"`{name}` goes into a log. Give `log`, too, or leave it out.")
        set_checked(self, values)


def _search(given: MarkSearch | str | tuple[str, ...] | list[str] | None) -> MarkSearch | None:
    return (
        given
        if given is None or isinstance(given, MarkSearch)
        else MarkSearch(given if isinstance(given, str) else tuple(given))
    )


def _temperature(given: object) -> float:
    value = any_number(given, "temperature_c", "a number of degrees Celsius")
    if not (isfinite(value) and _COLDEST <= value <= _HOTTEST):
        raise InputError(
            f"`temperature_c` is a temperature in degrees Celsius, but {shown(given)} was given."
        )
    return value
