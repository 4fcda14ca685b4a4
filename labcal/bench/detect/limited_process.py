"""A process that measures pictures within limits of time and memory, and is replaced if it ends."""

import multiprocessing
import os
import sys
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Literal

import numpy as np

from labcal.run.parent_watch import end_with_parent
from labcal.run.threads import one_opencv_thread
from labcal.targets.grid import DotGrid

Ending = Literal["result", "reason", "error", "crash", "hang", "memory"]
BYTES_A_KIB = 1024
_WANT_OF_MEMORY = ("takes more memory than there is", "nsufficient memory", "bad_alloc", "annot allocate")
"""In the reason that a picture is refused for: ours, OpenCV's, the C++ library's, the system's."""


@dataclass(frozen=True)
class ProcessResult:
    """The result of one picture."""

    ending: Ending
    words: str
    """The reason, or the error."""
    memory_mib: float
    """The most that the process has needed so far beyond what it needs when idle."""


@dataclass(frozen=True)
class Limits:
    """Limits of one picture."""

    memory_bytes: int
    """Beyond what the process has when idle; more is refused to it by the system, where that can be set."""
    seconds: float
    """After these the process is ended."""


class LimitedProcess:
    """One process that measures pictures, started when it is needed.

    Parameters
    ----------
    target : DotGrid
        What the pictures show.
    first : ndarray of uint8
        A picture of it, which is measured as the process starts: what is compiled then counts as start.
    limits : Limits
    """

    def __init__(self, target: DotGrid, first: np.ndarray, limits: Limits) -> None:
        self.target, self.first, self.limits = target, first, limits
        self._process: multiprocessing.process.BaseProcess | None = None
        self._pipe: Connection | None = None

    def __enter__(self) -> "LimitedProcess":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()

    def measure(self, path: Path) -> ProcessResult:
        """Measure one picture, and return the result or the failure."""
        pipe = self._pipe or self._start()
        try:
            pipe.send(str(path))
            if not pipe.poll(self.limits.seconds):
                self._end()
                return ProcessResult("hang", f"not done after {self.limits.seconds:g} s", 0.0)
            found: ProcessResult = pipe.recv()
        except (EOFError, OSError):  # the other end is gone
            status = self._end()
            return ProcessResult("crash", f"the process ended with {status}", 0.0)
        return found

    def _start(self) -> Connection:
        """Start the process and wait until it is ready."""
        spawn = multiprocessing.get_context("spawn")
        self._pipe, theirs = spawn.Pipe()
        self._process = spawn.Process(
            target=_work, args=(theirs, self.target, self.first, self.limits.memory_bytes), daemon=True
        )
        self._process.start()
        theirs.close()
        self._pipe.recv()  # it says when it is ready
        return self._pipe

    def _end(self) -> int | None:
        """End the process, and return its exit status."""
        status = None
        if self._pipe is not None:
            self._pipe.close()
        if self._process is not None:
            self._process.join(timeout=1.0)
            self._process.kill()
            self._process.join()
            status = self._process.exitcode
        self._pipe, self._process = None, None
        return status


@one_opencv_thread()
def _work(pipe: Connection, target: DotGrid, first: np.ndarray, memory_bytes: int) -> None:
    """Measure pictures until the other end closes."""
    # A spawned process imports what it needs itself.
    from labcal.correspond.measure import measure_picture  # noqa: PLC0415
    from labcal.correspond.sources import Source  # noqa: PLC0415
    from labcal.detect.detector import detect_dots  # noqa: PLC0415

    end_with_parent()
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # the decoders' own words about damaged files
    detect_dots(first, target)
    idle = _peak_bytes()
    _limit_memory(memory_bytes)
    pipe.send(None)
    while True:
        try:
            path = pipe.recv()
        except EOFError:
            return
        ending: Ending
        try:
            found = measure_picture(Source("view", "camera", path, None), target)
            ending, words = ("result", "") if found.indexed else ("reason", found.reason or "")
            if any(sign in words for sign in _WANT_OF_MEMORY):
                ending = "memory"
        except MemoryError as error:
            ending, words = "memory", repr(error)
        except Exception as error:  # noqa: BLE001 -- any exception is what is looked for
            ending, words = "error", repr(error)
        pipe.send(ProcessResult(ending, words, (_peak_bytes() - idle) / BYTES_A_KIB**2))


def _peak_bytes() -> float:
    """Return the peak memory of this process; 0 if the system does not report it."""
    if sys.platform == "win32":
        return 0.0
    import resource  # noqa: PLC0415 -- Windows has none

    peak = float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    return peak if sys.platform == "darwin" else peak * BYTES_A_KIB


def _limit_memory(more_bytes: int) -> None:
    """Limit the memory of this process to its present size plus an allowance, if the system supports it."""
    if sys.platform != "linux":
        return
    import resource  # noqa: PLC0415 -- as above

    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    limit = pages * resource.getpagesize() + more_bytes
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
