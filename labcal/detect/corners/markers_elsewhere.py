"""The reason why the markers in a picture do not place a board: other ids, another board, too few of them."""

from itertools import pairwise

from labcal.detect.corners.marker_places import markers_in_place
from labcal.detect.corners.seen_markers import SeenMarkers
from labcal.detect.flags import Refusal
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.charuco import CharucoBoard
from labcal.wording import counted, listed

_RANGES_SHOWN = 8


def why_not_in_place(seen: SeenMarkers, board: CharucoBoard, settings: CornerSettings) -> tuple[Refusal, str]:
    """Return why no two markers place the board, and a sentence on those that are seen.

    Parameters
    ----------
    seen : SeenMarkers
        All of the board's dictionary.
    board : CharucoBoard
    settings : CornerSettings
    """
    if len(seen.number) == 0:
        return Refusal.NO_MARKERS, ""
    last = board.first_id + board.marker_count - 1
    numbers = sorted(set(seen.number.tolist()))
    detail = ids_read("Marker", numbers, str(board.dictionary), (board.first_id, last))
    first = _first_id(seen, board, settings)
    if first is not None:
        return Refusal.OTHER_IDS, f"{detail} They fit the board with first_id: {first}."
    own = len(seen.on(board).number)
    if own == 0 and len(numbers) == 1:
        return Refusal.NO_MARKERS, f"{detail} One marker alone may be read by chance."
    if own < len(seen.number) - own:
        return Refusal.OTHER_IDS, detail
    if own >= settings.other_board_markers:
        return Refusal.OTHER_BOARD, detail
    read = (
        f"{counted(own, 'marker')} of the board's {board.marker_count} {'was' if own == 1 else 'were'} read."
    )
    if own > 1:
        read += (
            " They do not agree where the board is, or are too far from each other to tell: the corners of "
            "the squares between them, or another marker beside one of them, must be seen."
        )
    return Refusal.MARKERS_UNREADABLE, read


def _first_id(seen: SeenMarkers, board: CharucoBoard, settings: CornerSettings) -> int | None:
    """Return the only first id with which the markers are in place on the board; None if there is none."""
    lowest, highest = int(seen.number.min()), int(seen.number.max())
    first = max(0, highest - board.marker_count + 1)
    last = min(lowest, board.dictionary.size - board.marker_count)
    fitting: dict[int, int] = {}
    for number in range(first, last + 1):
        other = board.model_copy(update={"first_id": number})
        placed = len(markers_in_place(seen, other, settings).number)
        if placed:
            fitting[number] = placed
    most = [number for number, placed in fitting.items() if placed == max(fitting.values())]
    return most[0] if len(most) == 1 else None


def ids_read(noun: str, numbers: list[int], dictionary: str, own: tuple[int, int]) -> str:
    """Return a sentence on the ids that were read in a picture, and those that the target has.

    Parameters
    ----------
    noun : str
        Of one of them.
    numbers : list of int
        Sorted, each once.
    dictionary : str
    own : (int, int)
        First and last one of the target.
    """
    words = f"{noun} {_ranges(numbers)} of {dictionary} was"
    if len(numbers) > 1:
        words = f"{noun}s {_ranges(numbers)} of {dictionary} were"
    return f"{words} read; the target has {own[0]} to {own[1]}."


def ids_read_again(noun: str, numbers: list[int]) -> str:
    """Return a sentence on ids, sorted, that were read at two places.

    Parameters
    ----------
    noun : str
        Of one of them.
    numbers : list of int
    """
    return f"{noun}s {_ranges(numbers)} were read twice, at different places."


def _ranges(numbers: list[int]) -> str:
    """Return sorted numbers as ranges in words: ``3, 7 to 9``."""
    starts = [numbers[0], *(after for before, after in pairwise(numbers) if after > before + 1)]
    ends = [*(before for before, after in pairwise(numbers) if after > before + 1), numbers[-1]]
    words = [str(a) if a == b else f"{a} to {b}" for a, b in zip(starts, ends, strict=True)]
    return listed(words, _RANGES_SHOWN)
