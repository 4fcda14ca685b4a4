import threading
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.capture.addresses import Address
from labcal.capture.folder import FolderSource
from labcal.capture.settings import SourceSettings
from labcal.capture.several import SeveralWaiting
from labcal.capture.source import Source, opened
from labcal.capture.watch import WatchedFolder
from labcal.errors import DeviceError, InputError

SETTINGS = SourceSettings(timeout_s=5.0, cameras="_0=left,_1=right")


def png(value: int) -> bytes:
    done, data = cv2.imencode(".png", np.full((24, 32), value, np.uint8))
    assert done
    return data.tobytes()


def watching(folder: Path, settings: SourceSettings = SETTINGS) -> Source:
    return WatchedFolder(Address("watch", str(folder)), settings)


def meanwhile(work: Callable[[], None]) -> threading.Thread:
    thread = threading.Thread(target=work)
    thread.start()
    return thread


def test_new_pictures_are_taken_and_half_written_ones_are_waited_for(tmp_path: Path) -> None:
    (tmp_path / "old_0.png").write_bytes(png(1))
    whole, other = png(7), png(9)

    def drop() -> None:
        (tmp_path / "a_1.png").write_bytes(other)
        with (tmp_path / "a_0.png").open("wb") as file:
            file.write(whole[:40])
            file.flush()
            time.sleep(0.6)  # longer than a file must stand still
            file.write(whole[40:])

    with opened(watching(tmp_path)) as source:
        thread = meanwhile(drop)
        taken = source.trigger()
        thread.join()
    assert taken is not None
    assert taken.view == "a"
    assert taken.skew_s is None  # files tell when they were copied, 0.6 s apart, not when pictures were taken
    assert [int(frame.picture[0, 0]) for frame in taken.frames.values()] == [7, 9]
    assert [frame.encoded.data for frame in taken.frames.values() if frame.encoded] == [whole, other]


def test_a_wait_in_vain_names_what_is_missing(tmp_path: Path) -> None:
    settings = SourceSettings(timeout_s=0.5, cameras="_0=left,_1=right")
    with opened(watching(tmp_path, settings)) as source:
        (tmp_path / "a_1.png").write_bytes(png(1))
        (tmp_path / "b_0.png").write_bytes(png(1)[:40])
        with pytest.raises(DeviceError, match=r"Not whole: b_0\.png.*a: left"):
            source.trigger()


def test_there_must_be_a_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no folder"):
        watching(tmp_path / "nowhere").open()


def test_a_look_does_not_wait_and_tells_of_a_program_that_has_stopped(tmp_path: Path) -> None:
    settings = SourceSettings(timeout_s=0.4, cameras="_0=left,_1=right")
    source = WatchedFolder(Address("watch", str(tmp_path)), settings)
    with opened(source):
        nothing = source.peek()
        assert (dict(nothing.frames), nothing.refusals) == ({}, ())
        (tmp_path / "a_0.png").write_bytes(png(1))
        end = time.monotonic() + 10.0
        while not (late := source.peek()).refusals:
            assert time.monotonic() < end
            time.sleep(0.02)
        assert "a: right" in late.refusals[0]
        (tmp_path / "a_1.png").write_bytes(png(2))
        while not (seen := source.peek()).frames:
            assert time.monotonic() < end
            time.sleep(0.02)
        assert (seen.view, seen.refusals) == ("a", ())
        taken = source.trigger()
        assert taken is not None
        assert taken.view == "a"
        assert not source.peek().frames


def test_two_watched_folders_are_looked_at_together(tmp_path: Path) -> None:
    folders = [tmp_path / name for name in ("left", "right")]
    for folder in folders:
        folder.mkdir()
    made = [WatchedFolder(Address("watch", str(one), one.name), SourceSettings()) for one in folders]
    source = SeveralWaiting(made)
    with opened(source):
        (folders[0] / "a.png").write_bytes(png(1))
        end = time.monotonic() + 0.6
        while time.monotonic() < end:
            assert not source.peek().frames
            time.sleep(0.02)
        (folders[1] / "a.png").write_bytes(png(2))
        while not (seen := source.peek()).frames:
            assert time.monotonic() < end + 10.0
            time.sleep(0.02)
        assert (set(seen.frames), seen.view) == ({"left", "right"}, "a")


@pytest.mark.parametrize("kind", ["folder", "watch"])
def test_pictures_of_a_stated_form_enter_a_shoot_as_they_are_measured(tmp_path: Path, kind: str) -> None:
    """The file does not tell its form, so that the shoot gets the picture and not the file."""
    values = np.arange(24, dtype=np.uint8).reshape(4, 6)
    settings = SourceSettings(timeout_s=5.0, cameras="_0=left,_1=right", raw="Mono8:6x4")

    def drop() -> None:
        for name in ("a_0.raw", "a_1.raw"):
            (tmp_path / name).write_bytes(values.tobytes())

    address = Address(kind, str(tmp_path))
    if kind == "folder":
        drop()
        source: Source = FolderSource(address, settings.cameras, settings.raw)
    else:
        source = WatchedFolder(address, settings)
    with opened(source):
        if kind == "watch":
            drop()
        taken = source.trigger()
    assert taken is not None
    assert list(taken.frames) == ["left", "right"]
    for frame in taken.frames.values():
        assert frame.encoded is None
        np.testing.assert_array_equal(frame.picture, values)
