from pathlib import Path

import cv2
import numpy as np
import pytest
from moving_board import TARGET, frame, two_videos, write_video

from labcal.capture.addresses import Address
from labcal.capture.settings import SourceSettings
from labcal.capture.source import opened
from labcal.capture.video import Videos, videos_together
from labcal.capture.video_file import VideoFile
from labcal.capture.video_offset import offset_frames
from labcal.errors import InputError
from labcal.targets.catalogue import load_target

TARGET_ = load_target(TARGET)
DISTANCE = 2.2 * (TARGET_.extent_mm[2] - TARGET_.extent_mm[0])


class Steps:
    """Counts what is reported."""

    def __init__(self) -> None:
        self.started: list[tuple[str, int]] = []
        self.steps = 0

    def start(self, label: str, total: int, done: int = 0) -> None:
        assert done == 0
        self.started.append((label, total))

    def advance(self, steps: int = 1) -> None:
        self.steps += steps


@pytest.mark.parametrize("offset", [3.0, pytest.param(-2.4, marks=pytest.mark.slow)])
def test_the_offset_between_two_videos_is_found_to_a_fraction_of_a_frame(
    tmp_path: Path, offset: float
) -> None:
    left, right = two_videos(tmp_path, offset, 30)
    files, progress = (VideoFile(left), VideoFile(right)), Steps()
    assert offset_frames(*files, TARGET_, progress) == pytest.approx(offset, abs=0.2)
    assert progress.started == [("time offset of right.avi", 60)]
    assert progress.steps == 60


def test_a_target_that_stands_still_tells_no_offset(tmp_path: Path) -> None:
    still = [frame(TARGET_, np.eye(4), 0.3, DISTANCE)] * 30
    paths = [VideoFile(write_video(tmp_path / f"{name}.avi", still)) for name in "ab"]
    with pytest.raises(InputError, match="moves too little"):
        offset_frames(*paths, TARGET_)


def videos(folder: Path, count: int = 60, every: int | None = None, offset: float = 0.0) -> Videos:
    """Return two videos whose frames are noise with their number in it, the sharpest in the middle."""
    random = np.random.default_rng(1)
    pictures = []
    for number in range(count):
        picture = np.kron(random.integers(0, 2, (9, 12)), np.full((40, 40), 1)).astype(np.uint8) * 90 + 60
        pictures.append(picture if number % 25 == 11 else cv2.GaussianBlur(picture, (0, 0), 2.5))
    for name in ("left", "right"):
        write_video(folder / f"{name}.avi", pictures)
    addresses = [Address("video", str(folder / f"{name}.avi"), name) for name in ("left", "right")]
    return Videos(addresses, [0.0, offset], every)


def numbers(source: Videos) -> list[tuple[int, int]]:
    found = []
    with opened(source):
        while (taken := source.trigger()) is not None:
            left, right = taken.frames["left"].number, taken.frames["right"].number
            assert left is not None
            assert right is not None
            found.append((left, right))
    return found


def test_frames_are_taken_regularly_with_their_partners(tmp_path: Path) -> None:
    assert numbers(videos(tmp_path, 60, 20, 3.0)) == [(0, 3), (20, 23), (40, 43)]
    assert numbers(videos(tmp_path, 60, 20, -3.0)) == [(20, 17), (40, 37)]


def test_the_sharpest_of_each_second_is_taken(tmp_path: Path) -> None:
    assert numbers(videos(tmp_path, 60))[:2] == [(11, 11), (36, 36)]


def test_a_second_trigger_right_after_gives_the_following_frames(tmp_path: Path) -> None:
    with opened(videos(tmp_path, 60, 20)) as source:
        source.trigger()
        after = source.follow()
        assert after is not None
        assert {frame.number for frame in after.frames.values()} == {1}


def test_what_is_no_video_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "a.mp4").write_bytes(b"no video")
    with pytest.raises(InputError, match=r"a\.mp4 is not a video"):
        VideoFile(tmp_path / "a.mp4")
    with pytest.raises(InputError, match="no video"):
        VideoFile(tmp_path / "b.mp4")


def test_an_offset_is_needed_where_no_target_is_named(tmp_path: Path) -> None:
    addresses = [Address("video", str(tmp_path / name), name) for name in ("a", "b", "c")]
    with pytest.raises(InputError, match="Name it"):
        videos_together(addresses[:2], None, SourceSettings())
    with pytest.raises(InputError, match="3 are given"):
        videos_together(addresses, None, SourceSettings(video_offset=1.0))
