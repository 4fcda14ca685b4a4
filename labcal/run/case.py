"""A case, the unit of work of a sweep, and its outcome."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Generic, Protocol, TypeVar, runtime_checkable

from pydantic import BaseModel


@runtime_checkable  # so that tests can check annotations
class Case(Protocol):
    """A named unit of work."""

    @property
    def key(self) -> str:
        """The name of its result file, without the ending."""


C = TypeVar("C", bound=Case)
R = TypeVar("R", bound=BaseModel)


class Fault(StrEnum):
    """Kinds of reasons why a case has no result."""

    CASE = "case"
    """labcal refuses the case, as it would at every try."""
    MACHINE = "machine"
    """A device failed, or the case ended every process that tried it; another try may succeed."""
    PROGRAM = "program"
    """An error that nobody meant: a mistake in labcal, or in a method of the user's."""


@dataclass(frozen=True)
class CaseOutcome(Generic[R]):
    """The end of a case: its result, or the reason why there is none."""

    key: str
    result: R | None
    reason: str | None
    """The cause where there is no result; None where there is one."""
    seconds: float
    """Duration of the case; it differs from run to run."""
    fault: Fault | None = None
    """The kind of the reason."""
