"""Workers that are killed while they render or detect, or whose parent is: same bytes, nobody left."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from labcal.scene.catalogue import load_scene

PROC = Path("/proc")
pytestmark = pytest.mark.skipif(
    not (PROC / "self" / "stat").exists(), reason="processes are looked up in /proc"
)

TINY = (
    *(
        f"cameras.{name}.{key}"
        for name in ("left", "right")
        for key in ("size=[200, 150]", "focal_px=219", "principal_px=null")
    ),
    "placement.train=10",
    "spp=4",
)
WORKERS = 2


@dataclass(frozen=True)
class Command:
    """A command that works for a while, what it made when left alone, and where to put what it makes now."""

    words: tuple[str, ...]
    output: str
    expected: dict[str, bytes]


def run_quietly(*words: str) -> None:
    subprocess.run([sys.executable, "-m", "labcal", *words, "--quiet"], check=True)


def made(path: Path) -> dict[str, bytes]:
    """Return every file of a result but run.json, hidden ones, too, by path."""
    files = [path] if path.is_file() else sorted(path.rglob("*"))
    return {
        file.relative_to(path).as_posix(): file.read_bytes()
        for file in files
        if file.is_file() and file.name != "run.json"
    }


@pytest.fixture(scope="module")
def rendering(tmp_path_factory: pytest.TempPathFactory) -> Command:
    home = tmp_path_factory.mktemp("rendering")
    scene = home / "tiny.yaml"
    scene.write_text(load_scene("webcam-handheld", TINY).to_yaml())
    words = ("render", str(scene), "--workers", str(WORKERS))
    run_quietly(*words, "-o", str(home / "shoot"))
    return Command(words, "shoot", made(home / "shoot"))


@pytest.fixture(scope="module")
def detecting(stage: Path, tmp_path_factory: pytest.TempPathFactory) -> Command:
    home = tmp_path_factory.mktemp("detecting")
    (home / "pictures").mkdir()
    for picture in (stage / "images").iterdir():
        for number in range(10):
            os.link(picture, home / "pictures" / f"{number}-{picture.name}")
    words = (
        "detect",
        str(home / "pictures"),
        "--cameras",
        "_left=left,_right=right",
        "--target",
        "paper-13x10",
    )
    words = (*words, "--workers", str(WORKERS))
    run_quietly(*words, "-o", str(home / "dots.csv"))
    return Command(words, "dots.csv", made(home / "dots.csv"))


def start(command: Command, folder: Path) -> subprocess.Popen[str]:
    """Start a command in a session of its own, to find all of its processes by."""
    words = [*command.words, "-o", str(folder / command.output), "--json"]
    return subprocess.Popen(
        [sys.executable, "-m", "labcal", *words],
        start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def processes(session: int) -> dict[int, str]:
    """Return the command lines of a session's processes that are not over."""
    found = {}
    for entry in PROC.glob("[0-9]*"):
        with contextlib.suppress(OSError):
            state, _, _, of_session, *_ = (entry / "stat").read_text().rpartition(")")[2].split()
            if int(of_session) == session and state not in "ZX":
                found[int(entry.name)] = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()
    return found


def workers(session: int) -> list[int]:
    return sorted(number for number, line in processes(session).items() if "spawn_main" in line)


def wait_for(condition: Callable[[], bool], seconds: float) -> bool:
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.01)
    return True


def started(command: Command, folder: Path, moment_s: float) -> subprocess.Popen[str]:
    """Start a command and wait until some time after all of its workers are there."""
    process = start(command, folder)
    assert wait_for(lambda: len(workers(process.pid)) == WORKERS, 60)
    time.sleep(moment_s)
    assert process.poll() is None
    return process


def same_after_kills(command: Command, folder: Path, kills: int, seed: int) -> None:
    """Kill one worker after the other while a command works, and compare what it makes.

    On a quick machine it may be done before all have been killed; the first one is killed in any case.
    """
    random, killed = np.random.default_rng(seed), 0
    process = start(command, folder)
    for _ in range(kills):
        assert wait_for(lambda: len(workers(process.pid)) == WORKERS or process.poll() is not None, 60)
        time.sleep(random.uniform(0.0, 0.5) if killed else 0.0)
        for worker in random.permutation(workers(process.pid))[:1].tolist():
            with contextlib.suppress(ProcessLookupError):  # its work may be done by now
                os.kill(worker, signal.SIGKILL)
                killed += 1
    assert killed > 0
    _, said = process.communicate(timeout=300)
    assert process.returncode == 0, said
    assert said == ""
    assert made(folder / command.output) == command.expected
    assert [path.name for path in folder.iterdir()] == [command.output]


def test_a_worker_killed_while_it_renders_changes_nothing(rendering: Command, tmp_path: Path) -> None:
    same_after_kills(rendering, tmp_path, kills=1, seed=1)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_workers_killed_while_they_render_change_nothing(
    rendering: Command, seed: int, tmp_path: Path
) -> None:
    same_after_kills(rendering, tmp_path, kills=4, seed=seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_workers_killed_while_they_detect_change_nothing(
    detecting: Command, seed: int, tmp_path: Path
) -> None:
    same_after_kills(detecting, tmp_path, kills=4, seed=seed)


def nobody_left_after(command: Command, folder: Path, moment_s: float, how: signal.Signals) -> int:
    """End the main process alone, see who is still there 2 s later, and return its exit status."""
    process = started(command, folder, moment_s)
    process.send_signal(how)
    status = process.wait(timeout=30)
    assert wait_for(lambda: not processes(process.pid), 2.0), processes(process.pid)
    process.communicate()
    return status


def test_workers_end_when_their_parent_is_killed(rendering: Command, tmp_path: Path) -> None:
    assert nobody_left_after(rendering, tmp_path, 1.0, signal.SIGKILL) == -signal.SIGKILL


@pytest.mark.slow
@pytest.mark.parametrize("moment_s", [0.0, 0.3, 0.6, 0.9])
def test_workers_end_whenever_their_parent_is_killed(
    rendering: Command, detecting: Command, moment_s: float, tmp_path: Path
) -> None:
    for command in (rendering, detecting):
        nobody_left_after(command, tmp_path, moment_s, signal.SIGKILL)


@pytest.mark.parametrize(
    ("how", "status", "word"),
    [("SIGINT", 130, "Interrupted"), pytest.param("SIGTERM", 143, "Terminated", marks=pytest.mark.slow)],
)
def test_an_interrupted_command_leaves_nobody_and_says_one_line(
    rendering: Command, how: str, status: int, word: str, tmp_path: Path
) -> None:
    longer = replace(rendering, words=(*rendering.words, "--spp", "4096"))  # else it may be done before
    process = started(longer, tmp_path, 0.5)
    os.killpg(process.pid, signal.Signals[how])  # as a terminal does: all of them
    out, said = process.communicate(timeout=120)
    assert process.returncode == status
    assert said.splitlines() == [f"error: {word}. The same command again resumes where its output allows it."]
    assert json.loads(out)["error"]["status"] == status
    assert wait_for(lambda: not processes(process.pid), 2.0), processes(process.pid)
    assert [path.name for path in tmp_path.iterdir()] == ["shoot.unfinished"]


@pytest.mark.slow
def test_sigterm_to_the_main_process_alone_leaves_nobody(rendering: Command, tmp_path: Path) -> None:
    assert nobody_left_after(rendering, tmp_path, 0.5, signal.SIGTERM) == 143
