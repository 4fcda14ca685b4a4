"""``bench distortion`` interrupted by Ctrl-C: it resumes, no case is lost or done twice, same bytes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="processors cannot be chosen there"),
]
WORDS = (
    *("bench", "distortion", "--quick", "--set", "families=brown", "--set", "strengths=0,0.4"),
    *("--set", "noise_px=0.1", "--set", "points=60", "--set", "methods=dlt", "--set", "faults=none"),
)
STOPS = (1, 3)
"""Numbers of finished cases at which it is interrupted; there are six."""


def start(output: Path, cores: int) -> subprocess.Popen[str]:
    """Start the command on some of the processors, in a session of its own."""
    some = ",".join(map(str, sorted(os.sched_getaffinity(0))[:cores]))
    code = (
        "import os, signal, sys\n"
        f"os.sched_setaffinity(0, [{some}])\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # not where tests run in the background
        "from labcal.cli import main\n"
        "sys.exit(main(sys.argv[1:]))"
    )
    return subprocess.Popen(
        [sys.executable, "-c", code, *WORDS, "-o", str(output)],
        start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def finished(output: Path) -> dict[str, tuple[int, int]]:
    """Return which cases of an unfinished folder are done, and when and as which file each was written."""
    files = output.with_name(f"{output.name}.unfinished").glob("cases/*.json")
    return {file.name: (file.stat().st_mtime_ns, file.stat().st_ino) for file in files}


def results(output: Path) -> dict[str, bytes]:
    files = [*output.glob("results.*"), output / "index.html", *output.glob("figures/*")]
    return {file.name: file.read_bytes() for file in files}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    output = tmp_path_factory.mktemp("undisturbed") / "out"
    with start(output, 1) as process:
        process.communicate()
    return results(output)


@pytest.mark.parametrize("cores", [1, 2])
def test_it_resumes_where_it_was_interrupted(
    cores: int, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    if len(os.sched_getaffinity(0)) < cores:
        pytest.skip("this machine has one processor")
    output = tmp_path / "out"
    before: dict[str, tuple[int, int]] = {}
    for count in STOPS:
        with start(output, cores) as process:
            deadline = time.monotonic() + 120.0
            while len(finished(output)) < count:
                assert process.poll() is None
                assert time.monotonic() < deadline
                time.sleep(0.01)
            os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all processes
            shown, said = process.communicate(timeout=60.0)
        assert process.returncode == 130
        assert shown == ""
        assert said.splitlines()[1:] == [
            "error: Interrupted. The same command again resumes where its output allows it."
        ]
        kept = finished(output)
        assert count <= len(kept) < 6
        assert before.items() <= kept.items()  # the same files, written once
        before = kept
    inodes = {name: inode for name, (_, inode) in before.items()}
    with start(output, cores) as process:
        process.communicate()
    assert process.returncode in {0, 1}
    assert results(output) == undisturbed
    files = {file.name: file.stat().st_ino for file in output.glob("cases/*.json")}
    assert len(files) == 6
    assert inodes.items() <= files.items()
