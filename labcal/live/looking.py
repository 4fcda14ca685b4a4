"""The search for the target in live pictures, beside the work of taking them."""

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pixels
from labcal.capture.source import FrameSet
from labcal.capture.target_motion import MOST_PX
from labcal.detect.codes.reading import read_codes
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.targets.catalogue import AnyTarget

USUAL_S = 0.033
"""Time that a set takes where its cameras do not tell their exposure."""
STILL_S = 0.6
"""It has to be still for so long."""
AWAY = 0.03
"""After a view, the target has to move by this share of the picture's width before the next one is taken by
itself."""


@dataclass(frozen=True)
class Look:
    """Dots found in one set of pictures."""

    dots: Mapping[str, Pixels]
    """Dots found, by camera, px, shape (n, 2)."""
    found: Mapping[str, bool]
    """True for cameras in which the dots were named; before the target is known, in which a code was read."""
    still: bool
    """The target was found in all pictures, and moves so little that a set would not be refused for it;
    before it is known, its code has been read for a while."""
    away: bool
    """It is somewhere else than in the last view."""


class Looker:
    """Looks for the target in the newest set of pictures, in a thread of its own; sets between are left out.

    Parameters
    ----------
    target : AnyTarget or None
        None where it is not known: then its code is looked for.
    report : callable
        Called from the thread with each look.
    """

    def __init__(self, target: AnyTarget | None, report: Callable[[Look], None]) -> None:
        self._target, self._report = target, report
        self._waiting: FrameSet | None = None
        self._changed = threading.Condition()
        self._stopped = False
        self._before: tuple[float, dict[str, Pixels]] | None = None
        self._still_since: float | None = None
        self._epoch = 0
        self._taken: dict[str, Pixels] = {}
        self._place_lost = False  # a view was taken while the dots could not be named yet
        self._newest: dict[str, Pixels] = {}
        self._thread = threading.Thread(target=self._run, name="live-looker", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End, after the look that is under way."""
        with self._changed:
            self._stopped = True
            self._changed.notify_all()

    def learn(self, target: AnyTarget) -> None:
        """Look for this target from now on, unless one is known."""
        if self._target is None:
            self._target, self._still_since = target, None
            self._place_lost = self._epoch > 0

    def see(self, pictures: FrameSet) -> None:
        """Give the newest pictures; those before that were not looked at are forgotten."""
        with self._changed:
            self._waiting = pictures
            self._changed.notify_all()

    def took(self) -> None:
        """Remember where the target is: a view of it was taken there."""
        self._taken, self._still_since = dict(self._newest), None
        self._epoch += 1

    def left(self) -> None:
        """Forget where the last view was taken: it has left the shoot."""
        self._taken, self._still_since = {}, None
        self._epoch += 1

    def _run(self) -> None:
        while True:
            with self._changed:
                while self._waiting is None and not self._stopped:
                    self._changed.wait()
                if self._stopped:
                    return
                pictures, self._waiting = self._waiting, None
            if pictures is not None:
                target = self._target
                look = self._look_for_code(pictures) if target is None else self._look(pictures, target)
                self._report(look)

    def _look_for_code(self, pictures: FrameSet) -> Look:
        now, epoch = time.monotonic(), self._epoch
        found = {name: len(read_codes(one.picture).prints) == 1 for name, one in pictures.frames.items()}
        return Look({}, found, self._lasts(now, epoch, steady=any(found.values())), away=True)

    def _look(self, pictures: FrameSet, target: AnyTarget) -> Look:
        now, epoch = time.monotonic(), self._epoch
        dots = {name: detect_dots(frame.picture, target) for name, frame in pictures.frames.items()}
        found = {name: one.indexed for name, one in dots.items()}
        numbered = {name: _numbered(one, target) for name, one in dots.items() if one.indexed}
        speed = np.inf
        if self._before is not None and all(found.values()) and found:
            then, before = self._before
            speed = max(_step(before.get(name), numbered[name]) for name in numbered) / max(now - then, 1e-3)
        self._before = (now, numbered)
        self._newest = numbered
        if self._place_lost and numbered:
            self._taken, self._place_lost = numbered, False
        still = self._lasts(now, epoch, steady=speed * _lasted_s(pictures) <= MOST_PX)
        widths = {name: frame.picture.shape[1] for name, frame in pictures.frames.items()}
        away = not self._taken or any(
            _step(self._taken.get(name), places) > AWAY * widths[name] for name, places in numbered.items()
        )
        places = {name: one.position[np.isfinite(one.position).all(axis=1)] for name, one in dots.items()}
        return Look(places, found, still, away)

    def _lasts(self, now: float, epoch: int, *, steady: bool) -> bool:
        """Return whether it has been steady for long enough, and no view was taken during this look."""
        if not steady:
            self._still_since = None
        elif self._still_since is None:
            self._still_since = now
        still = self._still_since is not None and now - self._still_since >= STILL_S
        return still and epoch == self._epoch


def _lasted_s(pictures: FrameSet) -> float:
    """Return how long a set takes: its exposure, and the time between its first picture and its last."""
    exposures = [frame.exposure_us for frame in pictures.frames.values() if frame.exposure_us is not None]
    return (1e-6 * max(exposures) if exposures else USUAL_S) + (pictures.skew_s or 0.0)


def _numbered(dots: PictureDots, target: AnyTarget) -> Pixels:
    """Return places by number, NaN where a dot was not found."""
    col, row = dots.index.T
    known = dots.has_id & (col >= 0) & (col < target.cols) & (row >= 0) & (row < target.rows)
    places = np.full((target.count, 2), np.nan)
    places[row[known] * target.cols + col[known]] = dots.position[known]
    return places


def _step(before: Pixels | None, after: Pixels) -> float:
    """Return the median distance of dots that are in both; infinite where none is."""
    if before is None:
        return float("inf")
    steps = np.hypot(*(after - before).T)
    return float(np.median(steps[np.isfinite(steps)])) if np.isfinite(steps).any() else float("inf")
