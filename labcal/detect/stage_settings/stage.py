"""Base class of the settings of all stages: frozen, checked, and handed to compiled code as tuples."""

from collections.abc import Callable
from functools import cache
from operator import attrgetter
from typing import TYPE_CHECKING, ClassVar, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError, field_validator

from labcal.detect.stage_settings.setting import refusal

Limits = TypeVar("Limits")


@cache
def _fields(kind: Callable[..., object]) -> Callable[[object], tuple[object, ...]]:
    """Return a function from settings to their values for a named tuple of two fields or more."""
    return attrgetter(*vars(kind)["_fields"])


class StageSettings(BaseModel):
    """Settings of one stage of detection.

    A setting is what another print, camera or light may want otherwise: a threshold, a size, a count of
    rounds, a radius, a level of probability. Its name ends in its unit (whole numbers without one are
    counts), its description says what a larger value does, and its bounds are those within which detection
    works at all. What is no setting stays a constant of its file: mathematics (the median of chi-square),
    the layout of tables, guards against singular systems and division by zero, and the sizes of chunks and
    samples, which change the time and next to nothing else.

    Raises
    ------
    UnknownNameError
        There is no such setting.
    InputError
        A value is of another type, is out of bounds, or contradicts another one.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    stage: ClassVar[str]
    """Name of the stage, as in ``detect.edge.max_iterations``."""

    if not TYPE_CHECKING:  # which knows what may be given from the fields

        def __init__(self, **given: object) -> None:
            try:
                super().__init__(**given)
            except ValidationError as error:
                raise refusal(self.stage, type(self).model_fields, given, error) from error

    @field_validator("*", mode="before")
    @classmethod
    def _number(cls, value: object) -> object:
        """Refuse true and false, which pydantic takes for 1 and 0."""
        if isinstance(value, bool):
            raise ValueError("a truth value")  # noqa: TRY004 -- pydantic takes only this
        return value

    def limits(self, kind: Callable[..., Limits]) -> Limits:
        """Return the settings that a named tuple has fields for, as compiled code takes them."""
        return kind(*_fields(kind)(self))
