"""The attendant of a capture on the live page: waits for wishes, and shows what is seen meanwhile."""

import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

from labcal.arrays import Pixels
from labcal.capture.advice import Advice, Advisor
from labcal.capture.preview import Previewed
from labcal.capture.source import FrameSet
from labcal.evaluate.verdict.of_calibration import GOOD_VIEWS
from labcal.live.board import Board
from labcal.live.command import Command
from labcal.live.looking import Look, Looker
from labcal.live.picture import small_jpeg
from labcal.live.shown import CameraShown, Phase
from labcal.targets.catalogue import AnyTarget

PERIOD_S = 0.09
"""Least time between two live pictures."""
FINISH = "Press Finish and calibrate; more views do no harm"
NO_MORE = "The recording has no more pictures: press Finish and calibrate"


class Operator:
    """Takes sets when the page asks for it, or when the target is still.

    Parameters
    ----------
    board : Board
    source : Previewed
        Open while :meth:`wait` is called.
    target : AnyTarget or None
        None where it is not known: then nothing is looked for in the pictures.
    finish : callable
        Called when the page asks for the end; False where the capture has to go on.
    """

    def __init__(
        self, board: Board, source: Previewed, target: AnyTarget | None, finish: Callable[[], bool]
    ) -> None:
        self._board, self._source, self._finish = board, source, finish
        self._looker = None if target is None else Looker(target, self._looked)
        self._advisor: Advisor | None = None
        self._follow: Callable[[Advice], None] | None = None
        self._judging: Future[Advice] | None = None
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="live-advice")
        self._look: Look | None = None
        self._advice: Advice | None = None
        self._auto = False
        self._begun = False

    def guide_by(self, advisor: Advisor, follow: Callable[[Advice], None] | None = None) -> None:
        """Let an advisor say what to take next; each advice is also given to `follow`."""
        self._advisor, self._follow = advisor, follow

    def close(self) -> None:
        """End what runs beside."""
        if self._looker is not None:
            self._looker.stop()
        self._pool.shutdown(wait=False, cancel_futures=True)

    def wait(self, request: str, views: int) -> bool:
        """Show live pictures until a set is wanted; False where the page asks for the end."""
        if not self._begun:
            self._begin()
        self._board.show(phase=Phase.AIM, views=views)
        while True:
            began = time.monotonic()
            self._take_advice(request)
            pictures = self._source.peek()
            if pictures is None:
                self._board.show(request=NO_MORE, hint="", ended=True, enough=True)
            else:
                self._show(pictures)
            wish = self._board.next_wish(max(0.0, PERIOD_S - (time.monotonic() - began)))
            if wish is Command.FINISH and self._wants_end():
                return False
            if wish in {Command.AUTO, Command.BY_HAND}:
                self._auto = wish is Command.AUTO
                self._board.show(auto=self._auto)
            ready = pictures is not None and self._judging is None
            if ready and (wish is Command.TAKE or (self._auto and self._is_time())):
                self._board.show(phase=Phase.TAKE)
                return True

    def heard(self, taken: FrameSet, view: str | None, reasons: tuple[str, ...]) -> None:
        """Tell the page what became of a set, and have it judged."""
        self._show(taken)
        if view is None:
            self._board.show(faults=tuple(f"Not taken: {reason}." for reason in reasons))
            return
        self._board.show(views=self._board.shown.views + 1, faults=())
        if self._looker is not None:
            self._looker.took()
            self._look = None
        if self._advisor is not None:
            self._judging = self._pool.submit(_judged, self._advisor, taken, view)

    def _begin(self) -> None:
        """Say which cameras there are, and begin to look."""
        self._begun = True
        cameras = tuple(CameraShown(one.name, one.size) for one in self._source.describe())
        self._board.show(cameras=cameras)
        if self._looker is not None:
            self._looker.start()
        if self._advisor is not None:
            self._judging = self._pool.submit(self._advisor.advise)

    def _wants_end(self) -> bool:
        """Finish where there is enough to finish with."""
        shown = self._board.shown
        if shown.views < shown.least_views:
            self._board.show(error=f"At least {shown.least_views} views are needed before the end.")
            return False
        if self._judging is not None:
            self._judging.result()
        done = self._finish()
        if not done:
            self._board.show(phase=Phase.AIM)
        return done

    def _is_time(self) -> bool:
        """Return whether a view is to be taken by itself."""
        if self._advice is not None and self._advice.done:
            return False
        if not self._source.live or self._look is None:
            return not self._source.live
        return self._look.still and self._look.away

    def _take_advice(self, request: str) -> None:
        """Show the advice where there is a new one, else the plain request."""
        if self._judging is None:
            if self._advisor is None and not self._board.shown.ended:
                self._board.show(request=request)
            return
        if not self._judging.done():
            self._board.show(phase=Phase.TAKE)
            return
        advice = self._advice = self._judging.result()
        self._judging = None
        if self._follow is not None:
            self._follow(advice)
        words, _, hint = _sentence(advice.words).partition(". ")
        asks = self._source.live or self._follow is not None  # a recording does as it likes
        cameras = tuple(
            replace(
                one,
                outline=_places(advice.outlines.get(one.name)) if asks else (),
                coverage=tuple(
                    tuple(int(count) for count in row) for row in advice.coverage.get(one.name, ())
                ),
            )
            for one in self._board.shown.cameras
        )
        self._board.show(
            phase=Phase.AIM,
            request=words if asks or advice.done else request,
            hint=FINISH if advice.done else hint if asks else "",
            cameras=cameras,
            reached_mm=advice.reached_mm,
            wanted_mm=advice.wanted_mm,
            faults=tuple(_sentence(fault) for fault in advice.faults),
            lacks=advice.lacks,
            enough=advice.done or (advice.wanted_mm is None and advice.views >= GOOD_VIEWS),
            error="",
        )

    def _show(self, pictures: FrameSet) -> None:
        """Put live pictures on the page, and look for the target in them."""
        for name, frame in pictures.frames.items():
            self._board.put_picture(name, small_jpeg(frame.picture))
        sizes = {name: frame.size for name, frame in pictures.frames.items()}
        if any(one.size != sizes.get(one.name, one.size) for one in self._board.shown.cameras):
            self._board.change_cameras(lambda one: replace(one, size=sizes.get(one.name, one.size)))
        if self._looker is not None:
            self._looker.see(pictures)

    def _looked(self, look: Look) -> None:
        """Draw what was found; called from the looker's thread."""
        self._look = look
        self._board.change_cameras(
            lambda one: replace(
                one, dots=_places(look.dots.get(one.name)), found=look.found.get(one.name, one.found)
            )
        )
        self._board.show(still=look.still)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"


def _judged(advisor: Advisor, taken: FrameSet, view: str) -> Advice:
    advisor.judge(taken, view)
    return advisor.advise()


def _places(points: Pixels | None) -> tuple[tuple[float, float], ...]:
    """Return points for the page, rounded to what can be seen."""
    if points is None:
        return ()
    return tuple((round(float(x), 1), round(float(y), 1)) for x, y in points)
