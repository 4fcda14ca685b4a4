"""Time and memory that ``labcal measure`` takes for many named points with the full budget."""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from labcal.bench.solve.budget_rigs import KINDS, PairKind
from labcal.bench.solve.budget_set import NOISE_PX, calibrated
from labcal.bench.solve.pair_dots import CAMERAS
from labcal.cameras.rig import Rig
from labcal.correspond.named_pixels import NamedPixels
from labcal.errors import DeviceError
from labcal.report.bench import Check, at_most
from labcal.rng import generator

MILLION, QUICK_POINTS = 1_000_000, 40_000
_PARTS = 4
"""Of so many points a part is measured, too, to see the growth."""
_KIND = "wide"
_MOST_S, _MOST_GIB, _MOST_GROWTH = 30.0, 2.0, 1.3
"""Of a million points; growth is the time of a point over that of a point in the small table."""


def named_points_checks(seed: int, points: int) -> list[Check]:
    """Return the checks of time, memory and growth; other figures than those of a million points are quick.

    Parameters
    ----------
    seed : int
    points : int
        Of the largest table.

    Raises
    ------
    DeviceError
        The command ended with an error.
    """
    kind, count = KINDS[_KIND], points
    random = generator(seed, "bench solve", "named points")
    rig = calibrated(kind, random)
    # Not in the benchmark's own folder, which is unfinished: commands refuse to write into such a one.
    with TemporaryDirectory() as folder:
        used = [_measured(rig, kind, size, random, Path(folder)) for size in (2, count // _PARTS, count)]
    (start_s, _), (small_s, _), (large_s, gib) = used  # what a process costs before it has points
    growth = (large_s - start_s) / max(small_s - start_s, 1e-9) / _PARTS
    name = f"named points, {count} in two cameras, full budget"
    return [
        at_most(f"{name}: time of the processor, s", large_s, _MOST_S),
        at_most(f"{name}: memory, GiB", gib, _MOST_GIB),
        at_most(f"{name}: time of a point over that of one in {count // _PARTS}", growth, _MOST_GROWTH),
    ]


def _measured(
    rig: Rig, kind: PairKind, count: int, random: np.random.Generator, folder: Path
) -> tuple[float, float]:
    """Return the processor's time (s) and the memory (GiB) of the command for so many points."""
    places, table, rig_file = folder / "points.csv", folder / "pixels.csv", folder / "rig.json"
    p = kind.points(count, random)
    q = np.concatenate([camera.project(p).q for camera in kind.cameras()])
    q += NOISE_PX * random.standard_normal(q.shape)
    names = [f"p{number}" for number in range(count)]
    rig.save(rig_file, force=True)
    NamedPixels(["v"] * len(q), np.repeat(CAMERAS, count), names * 2, q).save(table, force=True)
    command = [sys.executable, "-m", "labcal", "measure", str(rig_file), str(table), "-o", str(places)]
    command += ["--pixel-sigma", str(NOISE_PX), "--budget", "full", "--force", "--quiet"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:  # noqa: S603
        message = process.stderr.read() if process.stderr is not None else b""
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 1):  # 1: some pixels lie outside of their pictures by their noise
        raise DeviceError(
            f"'labcal measure' of {count} points ended with an error: {message.decode()[-500:]}"
        )
    unit = 1024**3 if sys.platform == "darwin" else 1024**2
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / unit
