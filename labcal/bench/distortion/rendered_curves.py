"""Errors through pictures over the strength of distortion: a curve for each method."""

from collections.abc import Sequence

from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.curves import error_figure, svg_text


def rendered_figures(summaries: Sequence[CellSummary]) -> dict[str, str]:
    """Return an SVG text by name for every family that has a figure through pictures."""
    drawn: dict[str, str] = {}
    for family in dict.fromkeys(one.cell.family for one in summaries):
        own = [one for one in summaries if one.cell.family == family and one.over_oracle > 0.0]
        if own:
            title = f"{family}, rendered"
            drawn[f"rendered-{family}.svg"] = svg_text(error_figure(own, title), title)
    return drawn


def rendered_notes(summaries: Sequence[CellSummary]) -> list[str]:
    """Return which cells have no pictures or no figures, and why, for people."""
    notes: dict[str, None] = {}
    for one in summaries:
        if not one.over_oracle >= 0.0:
            cell = f"{one.cell.family} {one.cell.strength:g}, rendered"
            whole = all(other.reasons == one.reasons for other in summaries if other.cell == one.cell)
            name = cell if whole else f"{cell}, {one.method}"
            notes[f"{name}: {'; '.join(one.reasons)}"] = None
    return list(notes)
