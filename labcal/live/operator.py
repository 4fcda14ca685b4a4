"""The attendant of a capture on the live page: waits for wishes, and shows what is seen meanwhile."""

import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

from labcal.capture.advice import Advice, Advisor
from labcal.capture.attendant import DropView
from labcal.capture.preview import Previewed
from labcal.capture.source import FrameSet
from labcal.evaluate.verdict.of_calibration import GOOD_VIEWS
from labcal.live.board import Board
from labcal.live.command import Command, Wish
from labcal.live.diagnoser import Diagnoser
from labcal.live.looking import Look, Looker
from labcal.live.picture import small_jpeg
from labcal.live.shoot_dots import ShootDots
from labcal.live.shown import CameraShown, Phase, ViewShown, places_shown
from labcal.targets.catalogue import AnyTarget

PERIOD_S = 0.09
"""Least time between two live pictures."""
FINISH = "Press Finish and calibrate; more views do no harm"
AWAITED = "Waiting for the next pictures: take them with the cameras' own program"
NO_MORE = "The recording has no more pictures: press Finish and calibrate"


class Operator:
    """Takes sets when the page asks for it, or when the target is still.

    Parameters
    ----------
    board : Board
    source : Previewed
        Open while :meth:`wait` is called.
    target : AnyTarget or None
        None where it is not known: then its code is looked for, until a view tells it; see
        :meth:`keep_dots`.
    finish : callable
        Called when the page asks for the end; False where the capture has to go on.
    phrase : callable
        Turns a message of the library into the reader's words.
    """

    def __init__(
        self,
        board: Board,
        source: Previewed,
        target: AnyTarget | None,
        finish: Callable[[], bool],
        phrase: Callable[[str], str] = str,
    ) -> None:
        self._board, self._source, self._finish, self._phrase = board, source, finish, phrase
        self._looker = Looker(target, self._looked)
        self._advisor: Advisor | None = None
        self._follow: Callable[[Advice], None] | None = None
        self._judging: Future[Advice | None] | None = None
        self._dots: ShootDots | None = None
        self._diagnoser: Diagnoser | None = None
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="live-advice")
        self._look: Look | None = None
        self._advice: Advice | None = None
        self._auto = source.waits  # the other program says when
        self._begun = False

    def guide_by(self, advisor: Advisor, follow: Callable[[Advice], None] | None = None) -> None:
        """Let an advisor say what to take next; each advice is also given to `follow`."""
        self._advisor, self._follow = advisor, follow

    def keep_dots(self, dots: ShootDots, diagnoser: Diagnoser | None = None) -> None:
        """Find the dots of each view that enters the shoot once, for advice, calibration and diagnosis."""
        self._dots, self._diagnoser = dots, diagnoser

    def close(self) -> None:
        """End what runs beside."""
        self._looker.stop()
        if self._diagnoser is not None:
            self._diagnoser.stop()
        self._pool.shutdown(wait=False, cancel_futures=True)

    def wait(self, request: str, views: tuple[str, ...]) -> bool | DropView:
        """Show live pictures until a set is wanted; False where the page asks for the end."""
        if not self._begun:
            self._begin(views)
        phase = Phase.AIM if self._judging is None else Phase.TAKE
        self._board.show(phase=phase, views=len(views), taken=self._remembered(views))
        while True:
            began = time.monotonic()
            self._take_advice(request)
            pictures = self._look_at_bench()
            wish = self._board.next_wish(max(0.0, PERIOD_S - (time.monotonic() - began)))
            command = None if wish is None else wish.command
            if command is Command.FINISH and self._wants_end():
                return False
            if command in {Command.AUTO, Command.BY_HAND}:
                self._auto = command is Command.AUTO
                self._board.show(auto=self._auto)
            if wish is not None and command is Command.DROP and wish.view in views:
                return self._drop(wish)
            ready = pictures is not None and self._judging is None
            if ready and (command is Command.TAKE or (self._auto and self._is_time())):
                self._board.show(phase=Phase.TAKE)
                return True

    def _look_at_bench(self) -> FrameSet | None:
        """Show what the cameras see; None where there is nothing to take."""
        pictures = self._source.peek()
        if pictures is None:
            self._board.show(request=NO_MORE, hint="", ended=True, enough=True)
            return None
        self._board.show(notice="" if pictures.frames else self._phrase(" ".join(pictures.refusals)))
        if not pictures.frames:
            return None
        self._show(pictures)
        return pictures

    def _drop(self, wish: Wish) -> DropView:
        """Let what is being judged end, since it may be this view."""
        self._board.show(phase=Phase.TAKE)
        if self._judging is not None:
            self._judging.result()
            self._judging = None
        return DropView(wish.view)

    def dropped(self, view: str) -> None:
        """Forget a view that has left the shoot."""
        taken = tuple(one for one in self._board.shown.taken if one.name != view)
        self._board.show(views=len(taken), taken=taken, faults=(), error="")
        if self._dots is not None:
            self._dots.forget(view)
        self._looker.left()
        if self._advisor is not None or self._diagnoser is not None:
            self._judging = self._pool.submit(self._after_drop, view)

    def heard(self, taken: FrameSet, view: str | None, reasons: tuple[str, ...]) -> None:
        """Tell the page what became of a set, and have it judged."""
        self._show(taken)
        if view is None:
            self._board.show(faults=tuple(f"Not taken: {reason}." for reason in reasons))
            return
        now = (*self._board.shown.taken, ViewShown(view))
        self._board.show(views=len(now), taken=now, faults=())
        self._looker.took()
        self._look = None
        if self._advisor is not None or self._dots is not None:
            self._judging = self._pool.submit(self._judge, taken, view)

    def _judge(self, taken: FrameSet, view: str) -> Advice | None:
        """Find the dots of a view, and judge it by them; in a thread of its own."""
        if self._dots is not None:
            found = self._dots.of_view(view)
            self._learn_target()
            frames = {
                name: replace(frame, dots=found[name].dots if name in found else None)
                for name, frame in taken.frames.items()
            }
            taken = replace(taken, frames=frames)
        if self._diagnoser is not None:
            self._diagnoser.look()
        if self._advisor is None:
            return None
        self._advisor.judge(taken, view)
        return self._advisor.advise()

    def _learn_target(self) -> None:
        """Look for the target of the shoot."""
        target = None if self._dots is None else self._dots.target
        if target is not None:
            self._looker.learn(target)

    def _after_drop(self, view: str) -> Advice | None:
        if self._diagnoser is not None:
            self._diagnoser.look()
        if self._advisor is None:
            return None
        self._advisor.forget(view)
        return self._advisor.advise()

    def _remembered(self, views: tuple[str, ...]) -> tuple[ViewShown, ...]:
        """Return the views for the page, with what was said of each."""
        known = {one.name: one for one in self._board.shown.taken}
        return tuple(known.get(view, ViewShown(view)) for view in views)

    def _begin(self, views: tuple[str, ...]) -> None:
        """Say which cameras there are, and begin to look."""
        self._begun = True
        cameras = tuple(CameraShown(one.name, one.size) for one in self._source.describe())
        self._board.show(cameras=cameras, auto=self._auto, guided=self._asks)
        if views:
            self._learn_target()
        self._looker.start()
        if self._diagnoser is not None:
            self._diagnoser.start()
        if self._advisor is not None:
            self._judging = self._pool.submit(self._advisor.advise)
        if self._diagnoser is not None and views:
            self._pool.submit(self._diagnoser.look)

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
        if not self._source.live:
            return True
        if self._look is None:
            return False
        return self._look.still and self._look.away

    @property
    def _asks(self) -> bool:
        """Return whether poses are asked for; a recording is as it is."""
        follows = self._source.live or self._source.waits or self._follow is not None
        return self._advisor is not None and follows

    def _take_advice(self, request: str) -> None:
        """Show the advice where there is a new one, else the plain request."""
        if self._judging is None:
            if self._advisor is None and not self._board.shown.ended:
                self._board.show(request=AWAITED if self._source.waits else request)
            return
        if not self._judging.done():
            self._board.show(phase=Phase.TAKE)
            return
        advice = self._judging.result()
        self._judging = None
        if advice is None:
            self._board.show(phase=Phase.AIM)
            return
        self._advice = advice
        if self._follow is not None:
            self._follow(advice)
        words, _, hint = _sentence(advice.words).partition(". ")
        cameras = tuple(
            replace(
                one,
                outline=places_shown(advice.outlines.get(one.name)) if self._asks else (),
                coverage=tuple(
                    tuple(int(count) for count in row) for row in advice.coverage.get(one.name, ())
                ),
            )
            for one in self._board.shown.cameras
        )
        faults = tuple(_sentence(fault) for fault in advice.faults)
        taken = self._board.shown.taken
        self._board.show(
            taken=(*taken[:-1], replace(taken[-1], remarks=faults)) if taken and faults else taken,
            phase=Phase.AIM,
            request=words if self._asks or advice.done else request,
            hint=FINISH if advice.done else hint if self._asks else "",
            cameras=cameras,
            reached_mm=advice.reached_mm,
            wanted_mm=advice.wanted_mm,
            faults=faults,
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
        self._looker.see(pictures)

    def _looked(self, look: Look) -> None:
        """Draw what was found; called from the looker's thread."""
        self._look = look
        self._board.change_cameras(
            lambda one: replace(
                one, dots=places_shown(look.dots.get(one.name)), found=look.found.get(one.name, one.found)
            )
        )
        self._board.show(still=look.still)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"
