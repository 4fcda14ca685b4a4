"""Reproducibility: same bytes for the same seed, with more workers, and after kills and resumptions."""

import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from labcal.report.bench import Check, at_most
from labcal.rng import generator
from labcal.run.bound_program import bound_to_this_process
from labcal.run.progress import Progress

SCENE = "still-volume"
SPP = 4
KILLS = 10
LONGEST_S = 600.0


def reproducibility_checks(seed: int, progress: Progress) -> list[Check]:
    """Return the number of files of a shoot that differ from those of the first run.

    Parameters
    ----------
    seed : int
        Draws the moments at which a run is killed, too.
    progress : Progress
        Notified of every run.
    """
    progress.start("same bytes", 4)
    checks = []
    with TemporaryDirectory() as name:
        home = Path(name)
        began = time.perf_counter()
        _render(home / "first", 1)
        seconds = time.perf_counter() - began
        first = _digests(home / "first")
        progress.advance()
        for what, workers in (("again", 1), ("with 2 workers", 2)):
            _render(home / what, workers)
            checks.append(at_most(f"files that differ {what}", _differing(first, home / what), 0))
            progress.advance()
        kills = _render_killed(home / "killed", seconds, seed)
        text = f"files that differ after {KILLS} kills"
        checks.append(at_most(text, _differing(first, home / "killed"), 0))
        checks.append(at_most(f"kills missing of {KILLS}", KILLS - kills, 0))
        progress.advance()
    return checks


def _command(folder: Path, workers: int) -> list[str]:
    """Return the command that renders the shoot."""
    options = ["--spp", str(SPP), "--workers", str(workers), "--quiet"]
    return bound_to_this_process(
        [sys.executable, "-m", "labcal", "render", SCENE, "-o", str(folder), *options]
    )


def _render(folder: Path, workers: int) -> None:
    """Render the shoot in a process of its own."""
    # The command is this program in this interpreter.
    subprocess.run(_command(folder, workers), check=True, capture_output=True, timeout=LONGEST_S)  # noqa: S603


def _render_killed(folder: Path, seconds: float, seed: int) -> int:
    """Start the shoot repeatedly, kill it at random moments, finally let it finish; return the kills."""
    random = generator(seed, "bench kills")
    kills = 0
    for _ in range(KILLS):
        # The command is this program in this interpreter; its group has its workers, too.
        process = subprocess.Popen(  # noqa: S603
            _command(folder, 2), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        try:
            process.wait(timeout=random.uniform(0.1, 0.6) * seconds)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            kills += 1
        else:
            break
    if not folder.exists():
        _render(folder, 2)
    return kills


def _digests(folder: Path) -> dict[str, str]:
    """Return the digest of every file except ``run.json``, which holds times."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != "run.json"
    }


def _differing(first: dict[str, str], folder: Path) -> int:
    """Return the number of files that differ."""
    other = _digests(folder)
    return sum(first.get(name) != other.get(name) for name in {*first, *other})
