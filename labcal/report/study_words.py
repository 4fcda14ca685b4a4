"""Words about the study of neurons and layers, for the terminal, the page and the documentation."""

from collections.abc import Sequence

from labcal.report.figures_text import millimetres
from labcal.report.study import StudyCell

NEAR = 1.25
"""A network within this factor of the least error is as good: a laboratory would not notice more."""
_DEPTHS = {1: "one hidden layer", 2: "two", 3: "three"}


def of_each_data(cells: Sequence[StudyCell]) -> dict[str, list[StudyCell]]:
    """Return the networks by their data."""
    groups: dict[str, list[StudyCell]] = {}
    for cell in cells:
        groups.setdefault(cell.data, []).append(cell)
    return groups


def study_sentences(cells: Sequence[StudyCell]) -> list[str]:
    """Return for every kind of data which networks are best, and which is the smallest of the good ones.

    Parameters
    ----------
    cells : sequence of StudyCell
    """
    return [_sentence(data, group) for data, group in of_each_data(cells).items()]


def _sentence(data: str, group: Sequence[StudyCell]) -> str:
    best = {
        layers: min((cell for cell in group if cell.layers == layers), key=_error)
        for layers in sorted({cell.layers for cell in group})
    }
    found = [f"{_DEPTHS[layers]} {_with_network(cell)}" for layers, cell in best.items() if layers in _DEPTHS]
    least = min(group, key=_error)
    good = [cell for cell in group if _error(cell) <= NEAR * _error(least)]
    smallest = min(good, key=lambda cell: (cell.neurons, cell.layers))
    none = f"Without a hidden layer {millimetres(best[0].rmse_mm)} mm RMS. " if 0 in best else ""
    return (
        f"{data[0].upper()}{data[1:]}: {none}Least RMS error with {', '.join(found)}. The fewest neurons "
        f"within {NEAR - 1:.0%} of the least error: {_size(smallest)}."
    )


def _error(cell: StudyCell) -> float:
    return cell.rmse_mm


def _with_network(cell: StudyCell) -> str:
    return f"{millimetres(cell.rmse_mm)} mm (network {cell.network})"


def _size(cell: StudyCell) -> str:
    if not cell.layers:
        return "none, that is, no hidden layer"
    return f"{cell.neurons} in {cell.layers} {'layer' if cell.layers == 1 else 'layers'}"


def range_words(median: str, low: str, high: str) -> str:
    """Return a median with the range of the seeds, or alone where there is no range."""
    return median if low == high else f"{median} ({low} to {high})"


def goal_words(cell: StudyCell) -> str:
    """Return how many seeds reached the goal."""
    return f"{cell.reached} of {cell.seeds}"
