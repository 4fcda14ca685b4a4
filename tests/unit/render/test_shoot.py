import os
from pathlib import Path

import pytest

from labcal.errors import DeviceError
from labcal.render.picture import Job
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.run.made import SCRAP
from labcal.run.progress import NoProgress
from labcal.scene.catalogue import load_scene


class Counted:
    def __init__(self) -> None:
        self.done = 0

    def start(self, label: str, total: int, done: int = 0) -> None:
        pass

    def advance(self, steps: int = 1) -> None:
        self.done += steps


def drawn(job: Job) -> float:
    """Stand in for the renderer."""
    job.path.write_bytes(job.path.name.encode())
    return 0.0


def drawn_but_for_one(job: Job) -> float:
    if "left" in job.path.name:
        (job.path.parent / f"{SCRAP}{job.path.name}").touch()
        os._exit(9)
    return drawn(job)


def test_a_picture_that_ends_its_process_is_named_and_the_others_are_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, folder = load_scene("webcam-plane"), tmp_path / "shoot"
    settings, counted = RenderSettings(views=1, workers=2), Counted()
    monkeypatch.setattr("labcal.run.pool.TRIES_WITH_OTHERS", 1)  # fewer processes to wait for
    monkeypatch.setattr("labcal.render.shoot.render_picture", drawn_but_for_one)
    with pytest.raises(
        DeviceError, match=r"1 of 2 pictures .*_left\.jpg \(with exit status 9\).*smaller pictures"
    ):
        render_shoot(scene, folder, settings, counted)
    assert counted.done == 1
    made = [path.name for path in (tmp_path / "shoot.unfinished" / "images").glob("[!.]*")]
    assert len(made) == 1
    assert made[0].endswith("_right.jpg")
    (tmp_path / "shoot.unfinished" / "images" / made[0]).write_bytes(b"")  # as a power cut may leave it
    monkeypatch.setattr("labcal.render.shoot.render_picture", drawn)
    render_shoot(scene, folder, settings, NoProgress())
    images = sorted((folder / "images").iterdir())  # and no scrap of the process that was ended
    assert [path.name.partition("_")[2] for path in images] == ["left.jpg", "right.jpg"]
    assert [path.read_text() for path in images] == [path.name for path in images]
