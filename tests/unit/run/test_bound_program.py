import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from labcal.run.bound_program import bound_to_this_process

PARENT = """
import subprocess, sys
from labcal.run.bound_program import bound_to_this_process
code = "import os, sys, time; open(sys.argv[1], 'w').write(str(os.getpid())); time.sleep(60)"
subprocess.run(bound_to_this_process([sys.executable, "-c", code, sys.argv[1]]))
"""


def test_a_tied_program_says_and_returns_what_it_would() -> None:
    code = "import sys; print(sys.argv[1:], sys.stdin.read()); sys.exit(7)"
    command = bound_to_this_process([sys.executable, "-c", code, "a b", "c"])
    done = subprocess.run(command, input="d", capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (7, "['a b', 'c'] d\n")


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux can")
def test_a_tied_program_ends_with_the_process_that_started_it(tmp_path: Path) -> None:
    note = tmp_path / "number"
    with subprocess.Popen([sys.executable, "-c", PARENT, str(note)]) as parent:
        while not (note.exists() and note.read_text()):
            time.sleep(0.01)
        parent.send_signal(signal.SIGKILL)
    child = int(note.read_text())
    deadline = time.monotonic() + 10
    while is_alive(child) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not is_alive(child)


def is_alive(process: int) -> bool:
    """Tell whether a process is there and not a zombie that nobody has buried."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False
