import threading
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.capture.addresses import Address
from labcal.capture.settings import SourceSettings
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
