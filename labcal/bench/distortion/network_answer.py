"""The answer to "should I use a network?", computed from the results by rules."""

from collections.abc import Iterable, Sequence

import numpy as np

from labcal.bench.distortion.case import Cell, Measured
from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.winners import paired_ratios
from labcal.estimators.registry import method_entries
from labcal.wording import counted, listed

MARGIN = 1.05
"""Errors that differ by less count as the same."""
_NETWORKS = "labcal.estimators.networks."


def network_methods(methods: Sequence[str]) -> list[str]:
    """Return the methods of a plan that are networks of labcal's."""
    entries = method_entries()
    return [name for name in methods if name in entries and entries[name].where.startswith(_NETWORKS)]


def network_answer(summaries: Sequence[CellSummary]) -> list[str]:
    """Return sentences for people; none where networks cannot be compared with other methods.

    Notes
    -----
    The rules, for points within the trained volume. In a cell, the best network (least median error over the
    seeds) is compared with the best other method, seed by seed on the same data. A network is *better* where
    its error is smaller by more than `MARGIN` in every seed, *worse* where it is larger by more than that in
    every seed, else *as good*. The answer is "yes" where networks are better in most cells, "no" where they
    are better in none, else "only" with the families and strengths in which they are better. The same is
    said of methods that assume a lens model: in how many cells with distortion the best network beats
    `bundle`.
    """
    within = [one for one in summaries if one.measured == Measured.WITHIN]
    networks = set(network_methods(sorted({one.method for one in within})))
    judged = [found for cell in _by_cell(within) if (found := _compared(cell, networks)) is not None]
    if not judged:
        return []
    better = [one for one in judged if one.network_over_other < 1.0 and one.decided]
    worse = [one for one in judged if one.network_over_other > 1.0 and one.decided]
    factor = float(np.median([one.network_over_other for one in judged]))
    ground = (
        f"of {counted(len(judged), 'cell')} the best network has the smaller error in {len(better)}, the "
        f"larger in {len(worse)}; its error is {factor:.3g} times that of the best other method in the median"
    )
    if 2 * len(better) > len(judged):
        verdict = "Yes"
    elif better:
        verdict = f"Only where it is better: {listed(_places(better))}"
    else:
        verdict = "No"
    sentences = [f"{verdict}: {ground}."]
    return sentences + _beside_bundle(within, networks)


class _Compared:
    """The best network of a cell beside the best other method."""

    def __init__(self, network: CellSummary, other: CellSummary) -> None:
        ratios = paired_ratios(network, other)
        self.cell = network.cell
        self.network_over_other = float(np.median(ratios)) if len(ratios) else float("nan")
        above, below = (ratios > MARGIN).all(), (ratios < 1.0 / MARGIN).all()
        self.decided = bool(len(ratios) and (above or below))


def _by_cell(summaries: Iterable[CellSummary]) -> list[list[CellSummary]]:
    """Return the summaries with a figure, those of a cell together."""
    cells: dict[Cell, list[CellSummary]] = {}
    for one in summaries:
        if one.over_oracle >= 0.0:
            cells.setdefault(one.cell, []).append(one)
    return list(cells.values())


def _compared(cell: Sequence[CellSummary], networks: set[str]) -> _Compared | None:
    own = [one for one in cell if one.method in networks]
    others = [one for one in cell if one.method not in networks]
    if not own or not others:
        return None
    return _Compared(min(own, key=_error), min(others, key=_error))


def _error(summary: CellSummary) -> float:
    return summary.over_oracle


def _places(compared: Sequence[_Compared]) -> list[str]:
    """Return families with the strengths at which networks are better."""
    strengths: dict[str, set[float]] = {}
    for one in compared:
        strengths.setdefault(one.cell.family, set()).add(one.cell.strength)
    return [f"{family} {'/'.join(f'{s:g}' for s in sorted(own))}" for family, own in strengths.items()]


def _beside_bundle(summaries: Sequence[CellSummary], networks: set[str]) -> list[str]:
    pairs = []
    for cell in _by_cell(one for one in summaries if one.cell.strength > 0.0):
        own = [one for one in cell if one.method in networks]
        bundle = [one for one in cell if one.method == "bundle"]
        if own and bundle:
            pairs.append(_Compared(min(own, key=_error), bundle[0]))
    if not pairs:
        return []
    better = [one for one in pairs if one.decided and one.network_over_other < 1.0]
    where = f" ({listed(_places(better))})" if better else ""
    count = f"{len(better)} of {counted(len(pairs), 'cell')}"
    compared = f"in {count} with distortion{where}."
    return [
        f"Compared with bundle adjustment, which assumes a lens model, the best network is better {compared}"
    ]
