"""What a recorder knows of the target that its pictures show."""

from pathlib import Path

import numpy as np
import pytest
from coded_print import SIZE, photographed

from labcal.capture import recorder as module
from labcal.capture.recorder import Recorder
from labcal.capture.source import CameraInfo, Frame, FrameSet
from labcal.run.growing import growing_folder
from labcal.targets.catalogue import load_target

NAME = "rings-14x10"
CAMERAS = (CameraInfo("left", "stand-in", SIZE),)


def test_a_code_is_read_once_and_outlives_its_view(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read, read_codes = list[int](), module.read_codes

    def counted(picture: np.ndarray) -> object:
        read.append(1)
        return read_codes(picture)

    monkeypatch.setattr(module, "read_codes", counted)
    plain = FrameSet({"left": Frame(photographed(NAME, None))})
    coded = FrameSet({"left": Frame(photographed(NAME, 1))})
    shoot = tmp_path / "shoot"

    def interrupted() -> None:
        with growing_folder(shoot, "test", force=False) as folder:
            recorder = Recorder(folder, None, CAMERAS)
            assert recorder.with_target(plain).target is None
            for view, taken in (("view-001", coded), ("view-002", plain)):
                shown = recorder.with_target(taken)
                assert shown.target == load_target(NAME)
                recorder.add(shown, view)
            recorder.drop("view-001")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert len(read) == 2  # the second tells it
    with growing_folder(shoot, "test", force=False) as folder:
        again = Recorder(folder, None, CAMERAS)
        ((view, taken),) = again.recorded()
        assert (view, taken.target) == ("view-002", load_target(NAME))
    assert len(read) == 2
