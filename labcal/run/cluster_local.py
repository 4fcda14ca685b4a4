"""A Dask cluster of processes of this machine: a scheduler and workers with one thread each."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from labcal.errors import DeviceError
from labcal.run.bound_program import bound_to_this_process

START_S = 60.0
"""Time within which the scheduler has to be there."""
_END_S = 5.0
_LAST_LINES = 5


@contextmanager
def local_cluster(workers: int) -> Iterator[str]:
    """Start a cluster, yield the address of its scheduler, and end it.

    Its processes end with this one, even if that is killed. They listen on this machine only.

    Parameters
    ----------
    workers : int
        Processes for cases.

    Raises
    ------
    DeviceError
        The cluster cannot be started.
    """
    with TemporaryDirectory(prefix="labcal-cluster-", ignore_cleanup_errors=True) as home:
        file = Path(home, "scheduler.json")
        options = ("--host", "127.0.0.1", "--no-dashboard")
        words = ("distributed.cli.dask_scheduler", *options, "--port", "0", "--scheduler-file", str(file))
        with _program(words, Path(home, "scheduler.log")) as scheduler:
            address = _address_in(file, scheduler, Path(home, "scheduler.log"))
            processes = ("--nworkers", str(workers), "--nthreads", "1", "--memory-limit", "0")
            places = ("--local-directory", home, "--death-timeout", "60")
            workers_words = ("distributed.cli.dask_worker", address, *options, *processes, *places)
            with _program(workers_words, Path(home, "workers.log")):
                yield address


@contextmanager
def _program(words: Sequence[str], log: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Start a module as a program, in a session of its own so that Ctrl-C does not reach it, and end it."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path or str(Path.cwd()) for path in sys.path)}
    with log.open("wb") as handle:
        process = subprocess.Popen(  # noqa: S603 -- words of our own
            bound_to_this_process([sys.executable, "-m", *words]),
            stdin=subprocess.DEVNULL, stdout=handle, stderr=handle, env=environment, start_new_session=True,
        )  # fmt: skip
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _address_in(file: Path, scheduler: subprocess.Popen[bytes], log: Path) -> str:
    """Wait for the file that a scheduler writes, and return its address."""
    deadline = time.monotonic() + START_S
    while time.monotonic() < deadline and scheduler.poll() is None:
        try:
            return str(json.loads(file.read_text())["address"])
        except (FileNotFoundError, ValueError):  # not there yet, or not whole
            time.sleep(0.05)
    said = " ".join(log.read_text(errors="replace").splitlines()[-_LAST_LINES:])
    raise DeviceError(f"No Dask cluster can be started on this machine: {said or 'nothing was said'}.")
