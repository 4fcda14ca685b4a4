"""The board between the bench and the page: the newest pictures and state one way, wishes the other."""

import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from threading import Condition

from labcal.live.command import Wish
from labcal.live.shown import CameraShown, Shown

MOST_WISHES = 16
"""Wishes that wait; of more, the oldest are forgotten."""


class Board:
    """The state of the page now. Only the newest of everything is kept, however slowly it is read.

    The bench writes from its thread, the server reads from its own.
    """

    def __init__(self) -> None:
        self._changed = Condition()
        self._shown, self._state_number = Shown(), 1
        self._pictures: dict[str, tuple[int, bytes]] = {}
        self._wishes: deque[Wish] = deque(maxlen=MOST_WISHES)
        self._page: bytes | None = None
        self.asked_s = time.monotonic()
        """Time of the last request, by the monotonic clock, s."""

    @property
    def shown(self) -> Shown:
        """The state now."""
        return self._shown

    @property
    def state_number(self) -> int:
        """A number that grows with every change of the state."""
        return self._state_number

    def show(self, **changes: object) -> None:
        """Change fields of the state; the others stay.

        Parameters
        ----------
        **changes
            Fields of :class:`~labcal.live.shown.Shown`.
        """
        with self._changed:
            changed = replace(self._shown, **changes)  # type: ignore[arg-type]
            if changed != self._shown:
                self._shown, self._state_number = changed, self._state_number + 1

    def change_cameras(self, changed: Callable[[CameraShown], CameraShown]) -> None:
        """Change what is drawn over each picture, as one step, whoever else changes it meanwhile."""
        with self._changed:
            self.show(cameras=tuple(changed(one) for one in self._shown.cameras))

    def put_picture(self, camera: str, jpeg: bytes) -> None:
        """Show a newer picture of a camera, a whole JPEG file."""
        with self._changed:
            number, _ = self._pictures.get(camera, (0, b""))
            self._pictures[camera] = (number + 1, jpeg)

    def picture(self, camera: str) -> tuple[int, bytes] | None:
        """Return the newest picture of a camera, and its number from 1; None before the first."""
        return self._pictures.get(camera)

    def put_page(self, page: bytes) -> None:
        """Show the page of the calibrated rig, whole HTML."""
        self._page = page

    @property
    def page(self) -> bytes | None:
        """The page of the calibrated rig."""
        return self._page

    def wish(self, wish: Wish) -> None:
        """Ask the bench for something."""
        with self._changed:
            self._wishes.append(wish)
            self._changed.notify_all()

    def next_wish(self, timeout_s: float) -> Wish | None:
        """Return the oldest wish; None if there is none for so long."""
        with self._changed:
            if not self._wishes:
                self._changed.wait(timeout_s)
            return self._wishes.popleft() if self._wishes else None
