import numpy as np
import pytest
from moving_board import RATE, TARGET, frame

from labcal.capture.source import Frame, FrameSet
from labcal.capture.target_motion import motion_px
from labcal.targets.catalogue import load_target

TARGET_ = load_target(TARGET)
DISTANCE = 2.2 * (TARGET_.extent_mm[2] - TARGET_.extent_mm[0])


def moment(seconds: float, late_s: float, exposure_us: float | None = None) -> FrameSet:
    """Return a set of two cameras in one place, the second of which is late."""
    times = {"left": seconds, "right": seconds + late_s}
    return FrameSet(
        {
            name: Frame(frame(TARGET_, np.eye(4), when, DISTANCE), when, exposure_us)
            for name, when in times.items()
        }
    )


def test_motion_during_a_set_is_the_speed_of_the_image_times_delay_and_exposure() -> None:
    first, after = moment(0.2, 0.01), moment(0.2 + 1.0 / RATE, 0.01)
    moved = motion_px(first, after, TARGET_)
    assert moved["left"] == 0.0
    # The image at both instants tells the motion over the delay itself.
    true = motion_px(moment(0.2, 0.01), FrameSet({"left": moment(0.2, 0.0).frames["left"]}), TARGET_)
    assert true == {}
    there = moment(0.2, 0.01)
    still = FrameSet({"one": Frame(there.frames["left"].picture, 0.0, 1e4)})
    later = FrameSet({"one": Frame(there.frames["right"].picture, 0.01)})
    over_the_delay = motion_px(still, later, TARGET_)["one"]
    assert moved["right"] == pytest.approx(over_the_delay, rel=0.3)
    assert over_the_delay > 0.5


def test_nothing_is_said_where_the_target_is_not_seen_or_times_are_unknown() -> None:
    blank = FrameSet({"left": Frame(np.full((360, 480), 120, np.uint8), 0.0, 1e4)})
    assert motion_px(blank, blank, TARGET_) == {}
    seen = moment(0.2, 0.0)
    timeless = FrameSet({name: Frame(one.picture) for name, one in seen.frames.items()})
    assert motion_px(timeless, timeless, TARGET_) == {}
