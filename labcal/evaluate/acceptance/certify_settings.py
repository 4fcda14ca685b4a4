"""Settings of an acceptance test: limit, decision rule, and what a certificate states."""

from dataclasses import dataclass
from datetime import date as calendar_date

import numpy as np
from jaxtyping import Float64

from labcal.arguments import choice_of, one_text, real_number, set_checked
from labcal.arrays import AnyArray, float_array
from labcal.bounds import MOST_MM
from labcal.errors import InputError
from labcal.evaluate.acceptance.decision import Rule, Uncertainty
from labcal.evaluate.acceptance.length_plan import volume_sides
from labcal.wording import clipped, has_control, printable

CONFIDENCE = 0.95
"""Probability that ISO 14253-1 assumes where nothing else is agreed."""
_MOST_LETTERS = 200


@dataclass(frozen=True)
class CertifySettings:
    """Limit, decision rule, and what a certificate states.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples
    >>> from labcal.pipeline import CertifySettings
    >>> settings = CertifySettings(limit_mm=0.5, operator="M. Muster", date="2026-11-26")
    >>> labcal.certify(examples.pixels(), examples.lengths(), settings, rig=examples.rig()).outcome.value
    'incomplete'
    """

    limit_mm: float | None = None
    """Largest permissible absolute error of a length, mm: the part that holds for all lengths; without one
    errors are measured, and nothing is decided."""
    limit_ppm: float = 0.0
    """Its part that grows with the length, parts per million of it."""
    rule: Rule | str = Rule.GUARDED
    """``iso-14253-1``: conformity and non-conformity must be proven; ``simple``: errors are compared with
    their limit as they are."""
    confidence: float = CONFIDENCE
    """Probability with which what is proven is true."""
    uncertainty: Uncertainty | str = Uncertainty.REFERENCE
    """``reference``: that of the calibrated lengths, so that noise of the pixels counts as error;
    ``noise-and-reference``: noise, too, so that the limit is for errors that stay in a repetition."""
    pixel_sigma: float | None = None
    """Standard deviation of x and of y, px, of pixels that state no covariance."""
    volume_mm: AnyArray | None = None
    """Sides of the volume that is tested, mm: three numbers; it tells whether lengths reach far enough."""
    operator: str | None = None
    """Name of the person who made the test."""
    temperature_c: float | None = None
    """Temperature, degrees Celsius."""
    date: str | None = None
    """Date of the test, ``YYYY-MM-DD``; today's if left out."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError, UnknownNameError
            One is of a wrong type, no positive number, no date, or there is no such rule or uncertainty.
        """
        values: dict[str, object] = {
            "rule": choice_of(self.rule, Rule, "rule"),
            "uncertainty": choice_of(self.uncertainty, Uncertainty, "uncertainty"),
            "confidence": real_number(self.confidence, "confidence", (0.5, 1.0 - 1e-9)),
            "limit_ppm": real_number(self.limit_ppm, "limit_ppm", (0.0, 1e6)),
        }
        if self.limit_mm is None and self.limit_ppm:
            raise InputError(
                "`limit_ppm` is added to a limit. Give `limit_mm`, too; 0 if there is no such part."
            )
        if self.limit_mm is not None:
            values["limit_mm"] = real_number(self.limit_mm, "limit_mm", (0.0, MOST_MM))
            if self.limit_mm == 0.0 and self.limit_ppm == 0.0:
                raise InputError("`limit_mm` and `limit_ppm` are both 0: no length is free of errors.")
        if self.temperature_c is not None:
            values["temperature_c"] = real_number(self.temperature_c, "temperature_c", (-273.15, 1e4))
        if self.volume_mm is not None:
            values["volume_mm"] = volume_sides(self.volume_mm)
        if self.operator is not None:
            values["operator"] = _line(self.operator, "operator")
        if self.date is not None:
            values["date"] = _date(self.date)
        set_checked(self, values)

    @property
    def sides_mm(self) -> Float64[np.ndarray, "3"] | None:
        """The sides of the volume, mm; None if it is not stated."""
        return None if self.volume_mm is None else float_array(self.volume_mm, (3,), "volume_mm")

    def limits_mm(self, nominal_mm: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
        """Return the limit of each length, mm; NaN if none is stated."""
        if self.limit_mm is None:
            return np.full(len(nominal_mm), np.nan)
        return np.asarray(self.limit_mm + 1e-6 * self.limit_ppm * nominal_mm)


def _line(given: object, name: str) -> str:
    """Return a text that is a line of its own."""
    text = one_text(given, name)
    if not text or has_control(text) or len(text) > _MOST_LETTERS:
        raise InputError(f"`{name}` is a text of 1 to {_MOST_LETTERS} letters in one line.")
    return text


def _date(given: object) -> str:
    """Return a date as ISO 8601 writes it."""
    text = one_text(given, "date")
    try:
        return calendar_date.fromisoformat(text).isoformat()
    except ValueError:
        raise InputError(
            f"`date` is written as in 2026-11-26, but '{clipped(printable(text))}' was given."
        ) from None
