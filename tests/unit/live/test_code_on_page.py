"""A capture on the live page whose target the code of its print tells."""

import threading
import time
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path

import pytest
from coded_print import SIZE, photographed
from live_stand_ins import LiveCameras

from labcal.capture.capturing import CaptureRun, capture_shoot
from labcal.capture.guide_settings import GuideSettings
from labcal.capture.preview import Previewed
from labcal.capture.settings import CaptureSettings
from labcal.errors import DeviceError, InputError
from labcal.guide.next_pose.guided_by_code import GuidedByCode
from labcal.live.board import Board
from labcal.live.command import Command, Wish
from labcal.live.diagnoser import Diagnoser
from labcal.live.operator import Operator
from labcal.live.shoot_dots import ShootDots
from labcal.live.shown import Phase
from labcal.run.progress import NoProgress
from labcal.shoot.dataset import open_shoot
from labcal.targets.catalogue import load_target

NAME = "rings-14x10"
"""Its print has a code."""
LONGEST_S = 60.0


def until(board: Board, wanted: Callable[[], bool]) -> None:
    end = time.monotonic() + LONGEST_S
    while not wanted():
        assert time.monotonic() < end, board.shown
        time.sleep(0.01)


def test_the_page_asks_for_the_code_and_goes_on_with_the_target_that_it_tells(tmp_path: Path) -> None:
    cameras = LiveCameras({"left": [photographed(NAME, None), photographed(NAME, 1)]})
    cameras.turning = False
    folder, board, source = tmp_path / "shoot", Board(), Previewed(cameras)
    dots = ShootDots(folder, None)
    operator = Operator(board, source, None, lambda: True)
    operator.keep_dots(dots, Diagnoser(dots, lambda found: board.show(findings=found)))
    guide = GuidedByCode(GuideSettings(), 1)
    operator.guide_by(guide)
    run = CaptureRun("capture test", None, (), CaptureSettings(), None, guide, attendant=operator)

    def work() -> None:
        with closing(operator), suppress(DeviceError):  # which ends the test
            capture_shoot(source, folder, run, NoProgress())

    thread = threading.Thread(target=work)
    thread.start()
    until(board, lambda: board.shown.request == "Show the printed code")
    assert board.shown.guided
    assert "square code" in board.shown.hint
    board.wish(Wish(Command.TAKE))
    until(board, lambda: any("no code of a print is read" in fault.lower() for fault in board.shown.faults))
    with pytest.raises(InputError, match="Show the code"):
        dots.all()
    cameras.at = 1
    board.wish(Wish(Command.AUTO))  # by itself, since the code is read for a while
    until(board, lambda: board.shown.views == 2)
    until(board, lambda: board.shown.phase is Phase.AIM and board.shown.request != "Show the printed code")
    assert open_shoot(folder).target == load_target(NAME)
    until(board, lambda: board.shown.cameras[0].found and len(board.shown.cameras[0].dots) > 100)
    until(board, lambda: board.shown.still)
    board.wish(Wish(Command.BY_HAND))
    until(board, lambda: not board.shown.auto)
    assert board.shown.views == 2  # the target is where the view with the code was taken
    assert len(dots.all()[1]) == 2
    assert board.shown.cameras[0].size == SIZE
    cameras.unplugged = True
    thread.join(20.0)
