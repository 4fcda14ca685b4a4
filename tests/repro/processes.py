"""A scheduler and workers of Dask as processes of their own, to kill and to start anew."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

ROOT = Path(__file__).parents[2]
_HIDDEN = """
import sys
class Hidden:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "labcal":
            raise ModuleNotFoundError(f"No module named '{name}'", name=name)
sys.meta_path.insert(0, Hidden())
"""


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def wait_for(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "it took too long"
        time.sleep(0.02)


class DaskProcesses:
    """A cluster at a fixed port of this machine; it ends with the test."""

    def __init__(self, home: Path) -> None:
        self.home = home
        self.port = free_port()
        self.address = f"tcp://127.0.0.1:{self.port}"
        self._started: list[subprocess.Popen[bytes]] = []
        self.scheduler = self.start_scheduler()
        self.workers: list[subprocess.Popen[bytes]] = []

    def start_scheduler(self) -> subprocess.Popen[bytes]:
        """Start a scheduler at the port, and wait until it listens."""
        self.scheduler = self._start("dask_scheduler", "--host", "127.0.0.1", "--port", str(self.port))
        wait_for(self._answers)
        return self.scheduler

    def start_worker(self, *options: str, without_labcal: bool = False) -> subprocess.Popen[bytes]:
        """Start a worker, one process without one that watches it."""
        path = [str(ROOT), str(ROOT / "tests")]
        if without_labcal:
            hiding = self.home / "hiding"
            hiding.mkdir(exist_ok=True)
            (hiding / "sitecustomize.py").write_text(_HIDDEN)
            path = [str(hiding)]
        words = (self.address, "--no-nanny", "--memory-limit", "0", "--local-directory", str(self.home))
        options = options or ("--nthreads", "1")
        process = self._start("dask_worker", *words, *options, path=path)
        self.workers.append(process)
        return process

    def close(self) -> None:
        for process in self._started:
            process.kill()
        for process in self._started:
            process.wait()

    def _answers(self) -> bool:
        with suppress(OSError), socket.create_connection(("127.0.0.1", self.port), timeout=1.0):
            return True
        return False

    def _start(self, module: str, *words: str, path: list[str] | None = None) -> subprocess.Popen[bytes]:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path or [str(ROOT)])}
        log = (self.home / f"{module}-{len(self._started)}.log").open("wb")
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{module}", *words, "--no-dashboard"],
            env=environment, stdout=log, stderr=log, cwd=self.home,
        )  # fmt: skip
        log.close()
        self._started.append(process)
        return process


def kill(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGKILL)
    process.wait()
