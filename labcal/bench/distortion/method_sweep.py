"""Sweeps over cases of several methods, of which one of a user's may end the process that runs it."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar, runtime_checkable

from pydantic import BaseModel

from labcal.bench.distortion.checks import HYBRID
from labcal.bench.method_executor import own_methods
from labcal.errors import DeviceError, WorkersEndError
from labcal.run.case import CaseOutcome, Fault
from labcal.run.progress import Progress
from labcal.run.sweep import sweep
from labcal.wording import clipped, listed


@runtime_checkable  # so that tests can check annotations
class MethodCase(Protocol):
    """A case of several methods; a dataclass."""

    @property
    def key(self) -> str:
        """The name of its result file, without the ending."""

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods that are measured."""


C = TypeVar("C", bound=MethodCase)
F = TypeVar("F", bound=BaseModel)


@dataclass(frozen=True)
class MethodWork(Generic[C, F]):
    """The work of a case.

    Attributes
    ----------
    function : callable
        As of `sweep`.
    result_type : type
        What it returns: a model with `methods`, a row for each method.
    row_type : type
        The model of a row: `method`, and `reason` where there are no figures.
    """

    function: Callable[[C], F]
    result_type: type[F]
    row_type: type[BaseModel]


def sweep_methods(
    cases: Sequence[C], work: MethodWork[C, F], folder: Path, executor: Executor, progress: Progress
) -> list[CaseOutcome[F]]:
    """Return the outcomes of cases as `sweep` does; only the rows of a method that ends its process are lost.

    A case with such methods that no process could do is measured again in parts: the methods of labcal
    together, and each of the user's alone. So a method that ends its process has that as its reason, and the
    others have their figures.

    Parameters
    ----------
    cases : sequence of MethodCase
        All with the same methods.
    work : MethodWork
    folder : Path
        Where the files of results are; those of the parts are in ``<name>-apart-<number>`` beside it.
    executor : Executor
    progress : Progress

    Raises
    ------
    OutputError, DeviceError
        As of `sweep`. Where all cases end their processes, the message names the user's methods.
    """
    methods = cases[0].methods if cases else ()
    own = own_methods(methods)
    parts = _parts(methods, own)
    with _suspected(own):
        outcomes = sweep(cases, work.function, work.result_type, folder, executor, progress)
        failed = [number for number, one in enumerate(outcomes) if own and one.fault is Fault.MACHINE]
        if not failed or len(parts) == 1:
            return outcomes
        found = [
            sweep(
                [_with_methods(cases[number], part) for number in failed],
                work.function,
                work.result_type,
                folder.with_name(f"{folder.name}-apart-{place}"),
                executor,
                progress,
            )
            for place, part in enumerate(parts)
        ]
    for number, *again in zip(failed, *found, strict=True):
        outcomes[number] = _joined(outcomes[number], dict(zip(parts, again, strict=True)), methods, work)
    return outcomes


@contextmanager
def _suspected(own: Sequence[str]) -> Iterator[None]:
    """Name methods of a user's where all processes end."""
    try:
        yield
    except WorkersEndError as error:
        if not own:
            raise
        raise DeviceError(
            f"The first {error.count} cases ended each process that tried them, the last one {error.how}. "
            f"Probably a method of yours does that: {listed(map(clipped, own))}. Mend it, or leave it out."
        ) from error


def _parts(methods: Sequence[str], own: Sequence[str]) -> list[tuple[str, ...]]:
    """Return the methods that are measured together; `hybrid` judges each of a user's."""
    labcals = tuple(name for name in methods if name not in own)
    judge = tuple(name for name in labcals if name == HYBRID)
    return [labcals] * bool(labcals) + [(*judge, name) for name in own]


def _with_methods(case: C, methods: tuple[str, ...]) -> C:
    changed: Any = case  # any dataclass
    made: C = replace(changed, methods=methods)
    return made


def _joined(
    outcome: CaseOutcome[F],
    parts: dict[tuple[str, ...], CaseOutcome[F]],
    methods: Sequence[str],
    work: MethodWork[C, F],
) -> CaseOutcome[F]:
    """Return the outcome of a case that was measured in parts; the first one if no part has a result."""
    done: list[Any] = [one.result for one in parts.values() if one.result is not None]
    if not done:
        return outcome
    rows = {row.method: row for result in reversed(done) for row in result.methods}
    for part, one in parts.items():
        for name in part:
            rows.setdefault(name, work.row_type.model_validate({"method": name, "reason": one.reason}))
    first = [name for name in rows if name not in methods]  # the oracle of a protocol
    joined = done[0].model_copy(update={"methods": tuple(rows[name] for name in (*first, *methods))})
    return CaseOutcome(outcome.key, joined, None, sum(one.seconds for one in parts.values()))
