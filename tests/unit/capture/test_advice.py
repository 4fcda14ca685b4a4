from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from capture_stand_ins import StandIn, frame_set

from labcal.capture.advice import Advice
from labcal.capture.advice_text import advice_text, summary
from labcal.capture.capturing import CaptureRun, capture_shoot
from labcal.capture.guide_settings import GuideSettings
from labcal.capture.settings import CaptureSettings
from labcal.capture.source import CameraInfo, FrameSet
from labcal.errors import DeviceError, InputError
from labcal.run.progress import NoProgress


def advice(views: int, *, done: bool = False) -> Advice:
    outline = np.array([[100.0, 100.0], [500.0, 120.0], [480.0, 400.0], [90.0, 380.0]])
    coverage = np.zeros((6, 8), dtype=np.int64)
    coverage[2:4, 3:5] = 7
    return Advice(
        words="Done: reached" if done else "Closer, in the lower left of the picture of camera left",
        outlines={"left": outline, "right": outline}, T_world_target=None,
        reached_mm=0.123, calibration_mm=0.1, wanted_mm=0.05, faults=("camera left: blurred",),
        coverage={"left": coverage, "right": coverage}, lacks=("no dots yet in the upper left",),
        views=views, done=done, sizes={"left": (640, 480), "right": (640, 480)},
    )  # fmt: skip


class Counting:
    """An advisor that is content after some views."""

    def __init__(self, enough: int) -> None:
        self.enough, self.judged, self.cameras = enough, list[str](), list[str]()

    def begin(self, cameras: tuple[CameraInfo, ...]) -> None:
        self.cameras = [one.name for one in cameras]

    def judge(self, taken: FrameSet, view: str) -> tuple[str, ...]:
        assert set(taken.frames) == set(self.cameras)
        self.judged.append(view)
        return ()

    def forget(self, view: str) -> None:
        self.judged.remove(view)

    def advise(self) -> Advice:
        return advice(len(self.judged), done=len(self.judged) >= self.enough)


def test_a_guided_capture_ends_when_its_advisor_is_content_and_shows_every_advice(tmp_path: Path) -> None:
    advisor, shown, asked = Counting(2), list[bool](), list[str]()
    settings = CaptureSettings(interval_s=0.0)
    run = CaptureRun("capture", None, (), settings, asked.append, advisor, lambda one: shown.append(one.done))
    sets = [frame_set("left", "right") for _ in range(5)]
    captured = capture_shoot(StandIn(sets), tmp_path / "shoot", run, NoProgress())
    assert advisor.judged == ["view-001", "view-002"]
    assert [view.name for view in captured.shoot.views()] == advisor.judged
    assert shown == [False, False, True]
    assert len(asked) == 2
    assert "lower left" in asked[0]
    assert captured.advice is not None
    assert captured.advice.done


def test_a_guided_capture_that_was_interrupted_knows_the_views_before(tmp_path: Path) -> None:
    settings, folder = CaptureSettings(interval_s=0.0), tmp_path / "shoot"
    first = CaptureRun("capture", None, (), settings, None, Counting(3))
    sets = [frame_set("left", "right"), DeviceError("camera left was unplugged.")]
    with pytest.raises(DeviceError):
        capture_shoot(StandIn(sets), folder, first, NoProgress())
    advisor = Counting(3)
    again = CaptureRun("capture", None, (), settings, None, advisor)
    capture_shoot(StandIn([frame_set("left", "right") for _ in range(5)]), folder, again, NoProgress())
    assert advisor.judged == ["view-001", "view-002", "view-003"]


def test_the_text_of_an_advice_fits_80_columns_and_draws_the_outline() -> None:
    lines = advice_text(advice(3)).splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[0] == "! camera left: blurred"
    assert "expected 3-D error 0.123 mm" in lines[1]
    assert any("Closer, in the lower left" in line for line in lines)
    assert sum(line.count("#") for line in lines) > 40
    assert sum(line.count("o") for line in lines if line.startswith("|")) > 4
    assert "not reached" in summary(advice(3))
    assert summary(advice(3, done=True)) == "Done: reached."


def test_an_error_is_stated_from_four_views_on_and_of_one_camera_across_its_line_of_sight() -> None:
    few = replace(advice(3), reached_mm=None, calibration_mm=None)
    assert "the expected error is stated from 4 views on" in advice_text(few).replace("\n", " ")
    one = replace(advice(5), sizes={"left": (640, 480)}, shape_mm=None)
    assert "expected error across the line of sight 0.123 mm" in advice_text(one).replace("\n", " ")
    pair = replace(advice(5), shape_mm=0.05)
    assert "of shape and size alone 0.05 mm" in advice_text(pair).replace("\n", " ")


@pytest.mark.parametrize("wrong", [{"wanted_mm": 0.0}, {"wanted_mm": float("nan")}, {"volume_mm": (1.0, 2.0)},
                                   {"volume_mm": (1.0, 2.0, -3.0)}])  # fmt: skip
def test_lengths_that_are_none_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(InputError):
        GuideSettings(**wrong)  # type: ignore[arg-type]
