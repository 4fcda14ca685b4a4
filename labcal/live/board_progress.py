"""Progress of long work, on the live page."""

from labcal.live.board import Board


class BoardProgress:
    """A receiver of progress that shows it on a board.

    Parameters
    ----------
    board : Board
    """

    def __init__(self, board: Board) -> None:
        self._board = board
        self._label, self._done, self._total = "", 0, 0

    def start(self, label: str, total: int, done: int = 0) -> None:
        """Begin a piece of work."""
        self._label, self._done, self._total = f"{label[:1].upper()}{label[1:]}", done, total
        self._show()

    def advance(self, steps: int = 1) -> None:
        """Report steps as done."""
        self._done += steps
        self._show()

    def _show(self) -> None:
        self._board.show(work=(self._label, self._done, self._total))
