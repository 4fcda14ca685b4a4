"""Files of cases: the result of each, or the reason for having none, with hashes of what it depends on."""

from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from threading import BoundedSemaphore
from types import TracebackType
from typing import Generic, Literal

from pydantic import BaseModel, ConfigDict, JsonValue
from pydantic_core import from_json, to_json

from labcal.errors import InputError
from labcal.run.case import C, CaseOutcome, Fault, R
from labcal.run.code_version import code_version
from labcal.run.content_hash import content_hash
from labcal.run.made import make_folder
from labcal.run.outputs import write_file

WRITERS = 8
"""Threads that write files: they wait for the disk, which writes several files as fast as one."""
MOST_WAITING = 256
"""Files that wait to be written, at most."""


class CaseRecord(BaseModel):
    """The content of a file, but for the result."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-case"] = "labcal-case"
    format_version: Literal[1] = 1
    key: str
    case_sha256: str
    """Of the case, the function that does it, and the type of its result."""
    version: str
    code_sha256: str
    seconds: float
    reason: str | None = None
    fault: Fault | None = None
    result: JsonValue = None


class CaseFiles(Generic[C, R]):
    """The files of all cases, ``<key>.json``, in a folder; a context manager that ends when all are written.

    Parameters
    ----------
    folder : Path
        Made where it is missing.
    cases : sequence of Case
        Their keys differ.
    work : callable
        The function that does a case.
    result_type : type
        The pydantic model that it returns.

    Raises
    ------
    InputError
        Two cases have one key.
    InputTypeError
        The content of a case has no hash (see `content_hash`).
    """

    def __init__(
        self, folder: Path, cases: Sequence[C], work: Callable[[C], R], result_type: type[R]
    ) -> None:
        self._digests = {case.key: content_hash((case, work, result_type)) for case in cases}
        if len(self._digests) < len(cases):
            twice = next(key for key, count in Counter(case.key for case in cases).items() if count > 1)
            raise InputError(f"Two cases are named '{twice}', and each result needs a file of its own.")
        make_folder(folder)
        self._folder = folder
        self._result_type = result_type
        self._writers = ThreadPoolExecutor(WRITERS, "labcal-case-file")
        self._room = BoundedSemaphore(MOST_WAITING)
        self._failure: BaseException | None = None

    def __enter__(self) -> "CaseFiles[C, R]":
        """Begin."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Wait until all files are written; raise the first error of writing, unless there is another."""
        self._writers.shutdown()
        if error is None and self._failure is not None:
            raise self._failure

    def kept(self, key: str) -> CaseOutcome[R] | None:
        """Return the outcome of an earlier run.

        None if there is none, an incomplete one, one of another case or other code, or a failure of the
        machine: those are done again.
        """
        try:
            content = (self._folder / f"{key}.json").read_bytes()
            record = CaseRecord.model_validate(from_json(content))
            if (record.key, record.case_sha256, record.code_sha256) != (
                key, self._digests[key], code_version().sha256,
            ) or record.fault is Fault.MACHINE:  # fmt: skip
                return None
            result = None if record.reason is not None else self._result(to_json(record.result))
        except (FileNotFoundError, ValueError):  # of JSON and of pydantic, too
            return None
        return CaseOutcome(key, result, record.reason, record.seconds, record.fault)

    def keep(self, key: str, text: str, seconds: float) -> CaseOutcome[R]:
        """Write the result of a case, and return it as it will be read.

        Parameters
        ----------
        key : str
        text : str
            The result as JSON.
        seconds : float

        Raises
        ------
        OutputError
            An earlier file could not be written.
        """
        outcome = CaseOutcome(key, self._result(text.encode()), None, seconds)
        self._write(outcome, text)
        return outcome

    def keep_reason(self, outcome: CaseOutcome[R]) -> CaseOutcome[R]:
        """Write the outcome of a case without a result, and return it; see :meth:`keep`."""
        self._write(outcome, "null")
        return outcome

    def _result(self, text: bytes) -> R:
        return self._result_type.model_validate_json(text)

    def _write(self, outcome: CaseOutcome[R], result: str) -> None:
        """Let a thread write a file."""
        if self._failure is not None:
            raise self._failure
        code = code_version()
        record = CaseRecord(
            key=outcome.key,
            case_sha256=self._digests[outcome.key],
            version=code.version,
            code_sha256=code.sha256,
            seconds=outcome.seconds,
            reason=outcome.reason,
            fault=outcome.fault,
        )
        head = record.model_dump_json(indent=1, exclude={"result"}).removesuffix("\n}")
        path = self._folder / f"{outcome.key}.json"
        self._room.acquire()
        future = self._writers.submit(write_file, path, f'{head},\n "result": {result}\n}}\n', force=True)
        future.add_done_callback(self._written)

    def _written(self, future: "Future[None]") -> None:
        self._room.release()
        error = future.exception()
        if error is not None and self._failure is None:
            self._failure = error
