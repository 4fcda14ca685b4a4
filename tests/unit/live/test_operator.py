"""The attendant of a capture on the live page: takes what the page wishes, and shows what is seen."""

import json
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from live_stand_ins import LiveCameras
from moving_board import TARGET, frame

from labcal.capture.advice import Advice
from labcal.capture.capturing import Captured, CaptureRun, capture_shoot
from labcal.capture.preview import Previewed
from labcal.capture.settings import CaptureSettings
from labcal.capture.source import CameraInfo, Frame, FrameSet
from labcal.errors import DeviceError
from labcal.live.board import Board
from labcal.live.command import Command, Wish
from labcal.live.operator import AWAITED, NO_MORE, Operator
from labcal.live.shown import Phase
from labcal.run.progress import NoProgress
from labcal.shoot.dataset import open_shoot
from labcal.targets.catalogue import load_target

LONGEST_S = 20.0
PLACES = 3


def until(board: Board, wanted: Callable[[], bool]) -> None:
    end = time.monotonic() + LONGEST_S
    while not wanted():
        assert time.monotonic() < end, board.shown
        time.sleep(0.01)


@pytest.fixture(scope="module")
def scenes() -> dict[str, list[np.ndarray]]:
    target = load_target(TARGET)
    right = np.eye(4)
    right[0, 3] = -20.0
    distance = 2.4 * (target.extent_mm[2] - target.extent_mm[0])
    return {
        name: [frame(target, T, 0.8 * k, distance) for k in range(PLACES)]
        for name, T in (("left", np.eye(4)), ("right", right))
    }


class Bench:
    """A capture in a thread, whose page is the test."""

    def __init__(self, folder: Path, cameras: LiveCameras, views: int | None = None) -> None:
        self.board, self.cameras, self.finished = Board(), cameras, 0
        self.allows = True
        source = Previewed(cameras)
        target = load_target(TARGET)
        self.operator = Operator(self.board, source, target, self._finish)
        run = CaptureRun(
            "capture test", target, (), CaptureSettings(views=views), None, attendant=self.operator
        )
        self.outcome: Captured | Exception | None = None

        def work() -> None:
            try:
                self.outcome = capture_shoot(source, folder, run, NoProgress())
            except DeviceError as error:
                self.outcome = error
            finally:
                self.operator.close()

        self.thread = threading.Thread(target=work)

    def _finish(self) -> bool:
        self.finished += 1
        return self.allows

    def start(self) -> None:
        self.thread.start()
        until(self.board, lambda: self.board.shown.phase is Phase.AIM)

    def take(self) -> None:
        views = self.board.shown.views
        self.board.wish(Wish(Command.TAKE))
        until(self.board, lambda: self.board.shown.views > views)

    def end(self) -> Captured:
        self.board.wish(Wish(Command.FINISH))
        self.thread.join(LONGEST_S)
        assert isinstance(self.outcome, Captured)
        return self.outcome


@pytest.fixture
def bench(tmp_path: Path, scenes: dict[str, list[np.ndarray]]) -> Iterator[Bench]:
    cameras = LiveCameras(scenes)
    cameras.turning = False
    made = Bench(tmp_path / "shoot", cameras)
    made.start()
    yield made
    cameras.unplugged = True
    made.thread.join(LONGEST_S)


def test_pictures_and_dots_are_shown_while_nothing_is_taken(bench: Bench) -> None:
    until(bench.board, lambda: all(one.found for one in bench.board.shown.cameras))
    newest = bench.board.picture("left")
    assert newest is not None
    assert newest[1].startswith(b"\xff\xd8")
    left = bench.board.shown.cameras[0]
    assert (left.name, left.size) == ("left", (480, 360))
    assert len(left.dots) >= 11 * 8
    assert bench.board.shown.views == 0


def test_views_are_taken_when_they_are_wished_for_and_the_end_too(bench: Bench) -> None:
    for _ in range(PLACES):
        bench.take()
        bench.cameras.at += 1
    captured = bench.end()
    assert len(captured.shoot.views()) == PLACES
    assert bench.finished == 1


def test_the_end_is_refused_before_there_are_enough_views(bench: Bench) -> None:
    bench.take()
    bench.board.wish(Wish(Command.FINISH))
    until(bench.board, lambda: "At least 3 views" in bench.board.shown.error)
    assert bench.finished == 0
    bench.take()


def test_the_capture_goes_on_where_the_views_cannot_be_calibrated(bench: Bench) -> None:
    bench.allows = False
    for _ in range(PLACES):
        bench.take()
    bench.board.wish(Wish(Command.FINISH))
    until(bench.board, lambda: bench.finished == 1)
    bench.take()
    bench.allows = True
    assert len(bench.end().shoot.views()) == PLACES + 1


def test_a_still_target_is_taken_by_itself_once_at_each_place(bench: Bench) -> None:
    bench.board.wish(Wish(Command.AUTO))
    until(bench.board, lambda: bench.board.shown.views == 1)
    time.sleep(1.5)
    assert bench.board.shown.views == 1
    bench.cameras.at += 1
    until(bench.board, lambda: bench.board.shown.views == 2)
    bench.board.wish(Wish(Command.BY_HAND))
    until(bench.board, lambda: not bench.board.shown.auto)
    bench.cameras.at += 1
    time.sleep(1.5)
    assert bench.board.shown.views == 2


def test_a_moving_target_is_not_taken_by_itself(bench: Bench) -> None:
    bench.cameras.turning = True
    bench.board.wish(Wish(Command.AUTO))
    time.sleep(2.0)
    assert bench.board.shown.views == 0


def test_a_refused_set_is_told_and_does_not_end_the_capture(bench: Bench) -> None:
    bench.cameras.exposure_us = 1e6  # the target moves while it lasts
    bench.cameras.turning = True
    for _ in range(7):
        bench.board.show(faults=())
        bench.board.wish(Wish(Command.TAKE))
        until(bench.board, lambda: any("the target moved" in fault for fault in bench.board.shown.faults))
    assert bench.board.shown.views == 0


def test_an_unplugged_camera_ends_the_capture_and_keeps_the_views(bench: Bench) -> None:
    bench.take()
    bench.cameras.unplugged = True
    bench.thread.join(LONGEST_S)
    assert isinstance(bench.outcome, DeviceError)
    assert "1 view taken before is in" in str(bench.outcome)


def test_the_capture_ends_after_the_number_of_views_that_is_asked_for(
    tmp_path: Path, scenes: dict[str, list[np.ndarray]]
) -> None:
    cameras = LiveCameras(scenes)
    cameras.turning = False
    bench = Bench(tmp_path / "shoot", cameras, views=2)
    bench.start()
    bench.take()
    bench.board.wish(Wish(Command.TAKE))
    bench.thread.join(LONGEST_S)
    assert isinstance(bench.outcome, Captured)
    assert len(bench.outcome.shoot.views()) == 2


class Recording(LiveCameras):
    """The same pictures as a recording, which ends."""

    live = False

    def trigger(self) -> FrameSet | None:  # type: ignore[override]
        return None if self.at == PLACES else super().trigger()

    def follow(self) -> None:  # type: ignore[override]
        return None


def test_a_recording_shows_what_comes_next_and_says_when_there_is_no_more(
    tmp_path: Path, scenes: dict[str, list[np.ndarray]]
) -> None:
    bench = Bench(tmp_path / "shoot", Recording(scenes))
    bench.start()
    bench.board.wish(Wish(Command.AUTO))
    until(bench.board, lambda: bench.board.shown.ended)
    assert bench.board.shown.request == NO_MORE
    assert bench.board.shown.enough
    assert len(bench.end().shoot.views()) == PLACES
    assert bench.cameras.taken == PLACES


class Adviser:
    """Gives fixed advice, and notes what it judges."""

    def __init__(self) -> None:
        self.judged: list[str] = []

    def begin(self, cameras: tuple[CameraInfo, ...]) -> None:
        pass

    def judge(self, taken: FrameSet, view: str) -> tuple[str, ...]:
        assert set(taken.frames) == {"left", "right"}
        self.judged.append(view)
        return ()

    def forget(self, view: str) -> None:
        self.judged.remove(view)

    def advise(self) -> Advice:
        count = len(self.judged)
        return Advice(
            words=f"closer, pose {count}. It helps",
            outlines={"left": np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]])},
            T_world_target=None,
            reached_mm=1.0 / (count + 1),
            calibration_mm=None,
            wanted_mm=0.5,
            faults=("the exposure is short",) if count else (),
            sizes={"left": (480, 360), "right": (480, 360)},
            coverage={"left": np.full((2, 3), count)},
            lacks=("the corners",),
            views=count,
            done=count >= 2,
        )


def test_the_advice_is_shown_and_each_view_is_judged(
    tmp_path: Path, scenes: dict[str, list[np.ndarray]]
) -> None:
    cameras, adviser = LiveCameras(scenes), Adviser()
    cameras.turning = False
    bench = Bench(tmp_path / "shoot", cameras)
    followed: list[Advice] = []
    bench.operator.guide_by(adviser, followed.append)
    bench.start()
    until(bench.board, lambda: bench.board.shown.request == "Closer, pose 0")
    shown = bench.board.shown
    assert (shown.hint, shown.reached_mm, shown.wanted_mm) == ("It helps", 1.0, 0.5)
    assert shown.cameras[0].outline == ((0.0, 0.0), (9.0, 0.0), (9.0, 9.0))
    assert shown.cameras[1].outline == ()
    for number in (1, 2, 3):
        bench.take()
        until(bench.board, lambda: bench.board.shown.request == f"Closer, pose {number}")  # noqa: B023
    assert bench.board.shown.enough
    assert bench.board.shown.faults == ("The exposure is short",)
    assert bench.board.shown.cameras[0].coverage == ((3, 3, 3), (3, 3, 3))
    assert len(followed) == 4
    bench.end()
    assert adviser.judged == ["view-001", "view-002", "view-003"]


def images(folder: Path) -> list[str]:
    return sorted(path.name for path in (folder / "images").iterdir())


def test_views_are_taken_out_and_the_shoot_is_whole(bench: Bench, tmp_path: Path) -> None:
    folder = tmp_path / "shoot"
    for _ in range(3):
        bench.take()
    bench.board.wish(Wish(Command.DROP, "view-002"))
    until(bench.board, lambda: [one.name for one in bench.board.shown.taken] == ["view-001", "view-003"])
    assert [view.name for view in open_shoot(folder).views()] == ["view-001", "view-003"]
    until(bench.board, lambda: "view-002_left.png" not in images(folder))
    bench.board.wish(Wish(Command.DROP, "view-002"))  # a second browser presses the same button
    bench.board.wish(Wish(Command.DROP, "view-003"))
    until(bench.board, lambda: bench.board.shown.views == 1)
    bench.take()
    bench.take()
    captured = bench.end()
    assert [view.name for view in captured.shoot.views()] == ["view-001", "view-002", "view-003"]
    assert len(images(folder)) == 6
    record = json.loads((folder / "capture.json").read_text(encoding="utf-8"))
    assert sorted({one["view"] for one in record["pictures"]}) == ["view-001", "view-002", "view-003"]
    assert record["dropped"] == []


def test_pictures_leave_after_the_manifest_has_forgotten_them(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A kill at the moment of each deletion leaves a shoot whose pictures are all there."""
    folder, seen, unlink = tmp_path / "shoot", list[bool](), Path.unlink
    bench.take()
    bench.take()

    def watched(path: Path, missing_ok: bool = False) -> None:  # noqa: FBT001, FBT002 -- as pathlib has it
        if path.suffix == ".png":
            shoot = open_shoot(folder)
            named = [image for view in shoot.views() for image in view.images.values()]
            seen.append(all((folder / image).is_file() for image in named))
        unlink(path, missing_ok=missing_ok)

    monkeypatch.setattr(Path, "unlink", watched)
    bench.board.wish(Wish(Command.DROP, "view-001"))
    until(bench.board, lambda: bench.board.shown.views == 1)
    assert seen == [True, True]


def test_an_advisor_forgets_a_view_that_is_taken_out(
    tmp_path: Path, scenes: dict[str, list[np.ndarray]]
) -> None:
    cameras, adviser = LiveCameras(scenes), Adviser()
    cameras.turning = False
    bench = Bench(tmp_path / "shoot", cameras)
    bench.operator.guide_by(adviser)
    bench.start()
    for number in (1, 2):
        until(bench.board, lambda: bench.board.shown.phase is Phase.AIM)
        bench.take()
        until(bench.board, lambda: bench.board.shown.request == f"Closer, pose {number}")  # noqa: B023
    bench.board.wish(Wish(Command.DROP, "view-001"))
    until(bench.board, lambda: bench.board.shown.request == "Closer, pose 1")
    assert adviser.judged == ["view-002"]
    cameras.unplugged = True
    bench.thread.join(LONGEST_S)


class Tethered(Recording):
    """Pictures that another program delivers: none so far, and it is late."""

    waits = True
    delivered = False

    def peek(self) -> FrameSet:
        if self.unplugged:
            raise DeviceError("The folder is gone.")
        if not self.delivered:
            return FrameSet({}, refusals=("No new picture came for 5 s.",))
        return FrameSet({name: Frame(pictures[0]) for name, pictures in self.scenes.items()}, "first")

    def trigger(self) -> FrameSet | None:  # type: ignore[override]
        taken, self.delivered = self.peek(), False
        return taken


def test_the_page_stays_usable_while_another_program_delivers_nothing(
    tmp_path: Path, scenes: dict[str, list[np.ndarray]]
) -> None:
    cameras = Tethered(scenes)
    bench = Bench(tmp_path / "shoot", cameras)
    bench.start()
    until(bench.board, lambda: bench.board.shown.notice == "No new picture came for 5 s.")
    assert bench.board.shown.request == AWAITED
    assert bench.board.shown.auto
    bench.board.wish(Wish(Command.TAKE))  # nothing to take, and nothing blocks
    bench.board.wish(Wish(Command.BY_HAND))
    until(bench.board, lambda: not bench.board.shown.auto)
    bench.board.wish(Wish(Command.AUTO))
    cameras.delivered = True
    until(bench.board, lambda: [one.name for one in bench.board.shown.taken] == ["first"])
    cameras.unplugged = True
    bench.thread.join(LONGEST_S)
