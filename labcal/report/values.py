"""Values of result documents: figures that may be null, and texts that can be shown."""

from math import isfinite
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field

from labcal.bounds import MOST_WEIGHT
from labcal.wording import has_control


def _nan_for_null(value: object) -> object:
    """Return NaN for what :func:`labcal.run.json_text.to_json` writes as null."""
    return float("nan") if value is None else value


def _within_sense(value: float) -> float:
    """Return a figure that can be drawn and squared, or none."""
    if isfinite(value) and abs(value) > MOST_WEIGHT:
        raise ValueError(f"{value!r} is beyond all sense")
    return value


Measured = Annotated[float, BeforeValidator(_nan_for_null), AfterValidator(_within_sense)]
"""A figure that is null in JSON where it came out as no number."""


def _without_control(text: str) -> str:
    """Return a text that can be drawn and shown."""
    if has_control(text):
        raise ValueError("the text holds control characters")
    return text


Words = Annotated[str, Field(max_length=10_000), AfterValidator(_without_control)]
"""A text for the page and its figures."""
