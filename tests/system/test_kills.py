"""Renders that are killed without warning, resumed by the same command, and end in the same bytes."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from labcal.scene.catalogue import load_scene

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no process groups there")

TINY = (
    "cameras.left.size=[200, 150]",
    "cameras.left.focal_px=219",
    "cameras.left.principal_px=null",
    "cameras.right.size=[200, 150]",
    "cameras.right.focal_px=219",
    "cameras.right.principal_px=null",
    "placement.train=36",
    "spp=2",
)
PICTURES = 2 * (36 + 4)


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.yaml"
    path.write_text(load_scene("webcam-handheld", TINY).to_yaml())
    return path


def start(scene: Path, folder: Path, workers: int) -> subprocess.Popen[bytes]:
    """Start a render in a process group of its own, which its workers are in, too."""
    words = ("render", str(scene), "-o", str(folder), "--workers", str(workers), "--json")
    return subprocess.Popen(
        [sys.executable, "-m", "labcal", *words], start_new_session=True, stdout=subprocess.DEVNULL
    )


def files(folder: Path) -> dict[str, bytes]:
    """Return every file of a shoot but run.json, by path."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != "run.json"
    }


def kill_at_a_random_moment(process: subprocess.Popen[bytes], images: Path, more: int) -> None:
    """Kill a render and its workers some milliseconds after they have made so many more pictures."""
    wanted = len(list(images.glob("[!.]*"))) + more
    while process.poll() is None and len(list(images.glob("[!.]*"))) < wanted:
        time.sleep(0.001)
    time.sleep(np.random.default_rng(wanted).uniform(0.0, 0.02))
    with contextlib.suppress(ProcessLookupError):  # it may have ended by now
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def killed_and_resumed(scene: Path, tmp_path: Path, kills: int, workers: int) -> None:
    """Kill a render again and again, resume it, and compare its bytes with those of one left alone."""
    assert start(scene, tmp_path / "whole", workers).wait() == 0
    expected = files(tmp_path / "whole")
    assert len(expected) == PICTURES + 5
    folder, images = tmp_path / "killed", tmp_path / "killed.unfinished" / "images"
    random = np.random.default_rng(kills)
    counts = [0]
    for left in range(kills, 0, -1):
        most = 2 * (PICTURES - counts[-1]) // (left + 1)  # so that there is something left to do at the end
        kill_at_a_random_moment(start(scene, folder, workers), images, int(random.integers(1, most)))
        counts.append(len(list(images.glob("[!.]*"))))
    assert all(before < after < PICTURES for before, after in pairwise(counts))
    assert start(scene, folder, workers).wait() == 0
    assert files(folder) == expected
    assert sorted(path.name for path in tmp_path.iterdir()) == ["killed", "tiny.yaml", "whole"]


def test_a_render_killed_twice_ends_in_the_same_bytes(scene_file: Path, tmp_path: Path) -> None:
    killed_and_resumed(scene_file, tmp_path, kills=2, workers=1)


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_a_render_killed_ten_times_ends_in_the_same_bytes(
    scene_file: Path, tmp_path: Path, workers: int
) -> None:
    killed_and_resumed(scene_file, tmp_path, kills=10, workers=workers)
