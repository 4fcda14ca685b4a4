"""Words on the reliability of each method, computed from the figures."""

from collections.abc import Callable, Iterable, Sequence

from labcal.bench.distortion.checks import HYBRID_LIMIT
from labcal.bench.distortion.result import FAR, DistortionResult, FamilyFigures
from labcal.wording import counted

NEAR = HYBRID_LIMIT
"""Times the oracle's error: as good as the pixels allow."""
_THOUSAND = 1000.0


def trust_entries(result: DistortionResult) -> list[tuple[str, str]]:
    """Return for each method, in the order of the plan, what its figures say.

    Parameters
    ----------
    result : DistortionResult

    Notes
    -----
    The rules. A method is *near* the oracle in a family up to the strength at which, and below which, every
    cell has a figure and none more than `NEAR` times the oracle's error; it is *far* from `FAR` times on.
    Only cells with enough training points count. Coverage is right between 0.93 and 0.97.
    """
    entries = []
    for method in result.plan.methods:
        within = [one for one in result.families if one.method == method]
        outside = [one for one in result.outside if one.method == method]
        entries.append((method, " ".join(_sentences(within, outside))))
    return entries


def _sentences(within: Sequence[FamilyFigures], outside: Sequence[FamilyFigures]) -> Iterable[str]:
    if not _worst(within):
        yield "It has no figures within the trained volume; the table of reasons is in results.csv."
        return
    near, far = reach_words(within, NEAR), reach_words(within, FAR)
    yield f"At most {NEAR:g} times the oracle's error: {near}."
    if far != near:
        yield f"At most {FAR:g} times: {far}."
    yield f"Worst: {_worst_words(within)}."
    if missing := _total(within, lambda one: one.missing):
        yield f"It has no figure in {missing} of {counted(_total(within, lambda one: one.cells), 'cell')}."
    yield from _coverage_words(within)
    yield from _silence_words(within)
    if _worst(outside):
        yield f"Outside the trained volume the worst is {_worst_words(outside)}."


def reach_words(figures: Sequence[FamilyFigures], limit: float) -> str:
    """Return up to which strength a method keeps within a limit, family by family.

    Parameters
    ----------
    figures : sequence of FamilyFigures
        Of one method.
    limit : float
        Greatest error over the oracle's of all cells.
    """
    groups: dict[str, list[str]] = {}
    for family in dict.fromkeys(one.family for one in figures):
        own = sorted((one for one in figures if one.family == family), key=lambda one: one.strength)
        groups.setdefault(_reach(own, limit), []).append(family)
    every = len({one.family for one in figures})
    words = [f"{_families(families, every)} {reach}" for reach, families in groups.items() if reach]
    return "; ".join(words) if words else "nowhere"


def _reach(own: Sequence[FamilyFigures], limit: float) -> str:
    """Return in words how far the strengths of a family keep within a limit; empty where none does."""
    kept = 0
    while kept < len(own) and own[kept].worst <= limit and not own[kept].missing:
        kept += 1
    if kept == len(own):
        return "at every strength"
    if kept == 0:
        return ""
    last = own[kept - 1].strength
    return f"up to strength {last:g}" if last > 0.0 else "without distortion"


def _families(families: Sequence[str], every: int) -> str:
    return "all families" if len(families) == every > 1 else ", ".join(families)


def _worst(figures: Sequence[FamilyFigures]) -> FamilyFigures | None:
    return max((one for one in figures if one.worst >= 0.0), key=lambda one: one.worst, default=None)


def _worst_words(figures: Sequence[FamilyFigures]) -> str:
    worst = _worst(figures)
    if worst is None:
        return ""
    return f"{worst.worst:.4g} times ({worst.family} at strength {worst.strength:g})"


def _coverage_words(within: Sequence[FamilyFigures]) -> Iterable[str]:
    """Yield whether its ellipsoids can be believed."""
    if not any(one.coverage95 >= 0.0 for one in within):
        yield "It states no covariance."
        return
    cells, wrong = _total(within, lambda one: one.cells), _total(within, lambda one: one.miscovered)
    small = _total(within, lambda one: one.overconfident)
    if not wrong:
        yield "Its 95% ellipsoids hold 93 to 97% of the errors, or a flag warns, in every cell."
        return
    of_cells = f"of {counted(cells, 'cell')}, without a flag"
    if small:
        yield f"Its 95% ellipsoids are too small (fewer than 93% of the errors) in {small} {of_cells}."
    if wrong > small:
        whose = "They" if small else "Its 95% ellipsoids"
        yield f"{whose} are too large (more than 97%) in {wrong - small} {of_cells}."


def _silence_words(within: Sequence[FamilyFigures]) -> Iterable[str]:
    """Yield whether it warns where it is far from the oracle."""
    silent = _total(within, lambda one: one.silent)
    far = any(one.worst > FAR for one in within)
    if silent:
        cells = _total(within, lambda one: one.cells)
        yield (
            f"In {silent} of {counted(cells, 'cell')} it errs by more than {FAR:g} times the oracle without "
            "the flag model-misfit in every seed."
        )
    elif far:
        yield f"Wherever it errs by more than {FAR:g} times the oracle, the flag model-misfit says so."


def _total(figures: Sequence[FamilyFigures], count: Callable[[FamilyFigures], int]) -> int:
    return sum(map(count, figures))


def ratio_words(value: float) -> str:
    """Return an error over the oracle's with as many digits as anybody reads."""
    if value >= _THOUSAND:
        return f"{value:,.0f}"
    return f"{value:.2f}" if value < 10.0 else f"{value:.3g}"  # noqa: PLR2004 -- digits
