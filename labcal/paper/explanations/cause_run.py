"""One case: the size of a cause at which one method on one row errs as the paper prints."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from pydantic import BaseModel, ConfigDict

from labcal.errors import LabcalError
from labcal.paper.explanations.board_problem import BoardProblem
from labcal.paper.explanations.causes import cause_named
from labcal.paper.explanations.size import size_giving
from labcal.paper.rows import PaperRow
from labcal.paper.simulated import NoiseReading
from labcal.paper.training_run import TrainingRun, run_training
from labcal.rng import generator

_NOTHING = float("nan")


@dataclass(frozen=True)
class CauseRun:
    """The definition of a case."""

    row: PaperRow
    method: str
    cause: str
    board: BoardProblem
    seed: int
    """Draws the mistake, and the first weights of a network."""
    max_epochs: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        name = "-".join((self.row.exp, self.method, self.cause, str(self.seed)))
        return "".join(letter if letter.isalnum() else "-" for letter in name)


class ReachedSize(BaseModel):
    """The size that gives the paper's figure under one reading of this figure."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: float | None
    """In the unit of the cause; None where no size does."""
    greatest_mm: float | None
    """The greatest error that was met; None where there was none."""


class CauseOutcome(BaseModel):
    """The result under both readings of the paper's figure."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    mean_signed: ReachedSize
    """Its magnitude is the mean of all errors with their signs."""
    coordinate: ReachedSize
    """It is the RMS error of a coordinate, about that of a single point that is looked at."""


def solve_size(case: CauseRun) -> CauseOutcome:
    """Solve for the size of a cause."""
    sizes = cause_named(case.cause).sizes
    errors = cache(lambda size: errors_mm(case, size))
    target = 1e3 * abs(case.row.paper_abs_m)
    return CauseOutcome(
        mean_signed=_reached(target, lambda size: errors(size)[0], sizes),
        coordinate=_reached(target, lambda size: errors(size)[1], sizes),
    )


def errors_mm(case: CauseRun, size: float) -> tuple[float, float]:
    """Return the magnitude of the mean signed error and the RMS error of a coordinate, mm.

    Both are NaN where the method cannot be fitted to data with a mistake of this size.
    """
    cause = cause_named(case.cause)
    random = generator(case.seed, "explanation", case.row.data, case.cause)
    problem = cause.disturbed(case.board, size, random)
    run = TrainingRun(case.row, case.method, NoiseReading.NONE, "", problem, case.seed, case.max_epochs)
    try:
        outcome = run_training(run)
    except LabcalError:
        return _NOTHING, _NOTHING
    return abs(outcome.mean_signed_mm), outcome.rmse_mm / 3**0.5


def _reached(target: float, error_at: Callable[[float], float], sizes: tuple[float, ...]) -> ReachedSize:
    met: list[float] = []

    def noted(size: float) -> float:
        met.append(error_at(size))
        return met[-1]

    size = size_giving(target, noted, sizes)
    numbers = [error for error in met if error == error]  # noqa: PLR0124 -- NaN is not equal to itself
    return ReachedSize(size=size, greatest_mm=max(numbers, default=None))
