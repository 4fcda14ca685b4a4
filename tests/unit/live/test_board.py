"""The board keeps the newest of everything, and no more."""

from labcal.live.board import MOST_WISHES, Board
from labcal.live.command import Command, Wish
from labcal.live.shown import Phase


def test_the_number_of_the_state_grows_with_each_change_only() -> None:
    board = Board()
    first = board.state_number
    board.show(phase=Phase.AIM)
    board.show(phase=Phase.AIM)
    assert board.state_number == first + 1


def test_only_the_newest_picture_is_kept() -> None:
    board = Board()
    for number in range(50):
        board.put_picture("left", b"%d" % number)
    assert board.picture("left") == (50, b"49")
    assert board.picture("right") is None


def test_wishes_come_in_order_and_old_ones_are_forgotten() -> None:
    board = Board()
    board.wish(Wish(Command.TAKE))
    board.wish(Wish(Command.FINISH))
    assert [board.next_wish(0.0) for _ in range(3)] == [Wish(Command.TAKE), Wish(Command.FINISH), None]
    for _ in range(1000):
        board.wish(Wish(Command.TAKE))
    assert sum(board.next_wish(0.0) is not None for _ in range(1000)) == MOST_WISHES
