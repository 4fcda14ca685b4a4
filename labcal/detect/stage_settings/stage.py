"""Base class of the settings of all stages: frozen, checked, and handed to compiled code as tuples."""

from collections.abc import Callable
from typing import TypeVar

from pydantic import BaseModel, ConfigDict

Limits = TypeVar("Limits")


class StageSettings(BaseModel):
    """Settings of one stage of detection.

    A setting is what another print, camera or light may want otherwise: a threshold, a size, a count of
    rounds, a radius, a level of probability. Its name ends in its unit (whole numbers without one are
    counts), its description says what a larger value does, and its bounds are those within which detection
    works at all. What is no setting stays a constant of its file: mathematics (the median of chi-square),
    the layout of tables, guards against singular systems and division by zero, and the sizes of chunks and
    samples, which change the time and next to nothing else.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def limits(self, kind: Callable[..., Limits]) -> Limits:
        """Return the settings that a named tuple has fields for, as compiled code takes them."""
        return kind(*(getattr(self, name) for name in vars(kind)["_fields"]))
