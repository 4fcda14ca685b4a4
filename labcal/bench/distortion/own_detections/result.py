"""Figures of methods on detections of one's own: all views held out together."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict
from rich.table import Table

from labcal.bench.distortion.case import NO_FAULT, Source
from labcal.bench.distortion.figures import CaseFigures, MethodFigures, RegionFigures
from labcal.bench.distortion.own_detections.case import OwnCase
from labcal.bench.distortion.own_detections.measuring import HELD_OUT
from labcal.bench.distortion.pooling import known_median, pooled_coverage
from labcal.report.values import Measured as Figure
from labcal.wording import counted

_NAN = float("nan")
LAYOUT = "views"
"""Arrangement of the training points: as the stage stood."""


class OwnMethod(BaseModel):
    """One method on all views held out."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    method: str
    n: int
    """Dots of the views held out that all cameras measured."""
    predicted: int
    """Dots for which the method gives a place."""
    rmse_mm: Figure
    """Root mean square of the 3-D error against the places that the stage gives."""
    over_best: Figure
    """Over the least error of all methods."""
    stated: int
    covered: int
    coverage95: Figure
    """Share of errors within the stated 95% ellipsoids, which know nothing of errors of the stage."""
    model_misfit: bool | None
    """Every part is flagged so, from training data alone; null where nothing could be said."""
    extrapolated: int
    """Dots outside the volume that was trained on."""
    expected_mm: Figure
    """Expected error, from training data alone; the median of the parts."""
    reasons: tuple[str, ...]
    """Reasons why parts have no figures, each once."""


class OwnResult(BaseModel):
    """All methods on one table of detections."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    held_out: tuple[tuple[str, ...], ...]
    """The views that are held out together, a part a line."""
    trained: int
    """Fewest training points of a part."""
    methods: tuple[OwnMethod, ...]


@dataclass(frozen=True)
class Part:
    """A case, and its figures; with the reason where it has none."""

    case: OwnCase
    figures: CaseFigures


def own_results(parts: Sequence[Part]) -> list[OwnResult]:
    """Return the figures by name of the detections, in the order of the parts."""
    groups: dict[str, list[Part]] = {}
    for part in parts:
        groups.setdefault(part.case.name, []).append(part)
    return [_result(name, group) for name, group in groups.items()]


def own_lines(results: Sequence[OwnResult], header: Sequence[str], seed: int) -> Iterator[list[object]]:
    """Yield lines of ``results.csv``: one for each table of detections and method.

    What is not known of real pixels is nan: the strength, the noise, and the error of exact cameras.

    Parameters
    ----------
    results : sequence of OwnResult
    header : sequence of str
        Columns of ``results.csv``.
    seed : int
    """
    for result in results:
        for one in result.methods:
            cells: dict[str, object] = one.model_dump(exclude={"model_misfit", "reasons", "over_best"})
            cells |= dict.fromkeys(("strength", "noise_px", "beyond_pinhole_px", "pixel_error_px"), _NAN)
            cells |= dict.fromkeys(("oracle_mm", "over_oracle"), _NAN)
            cells |= {"family": result.name, "layout": LAYOUT, "points": result.trained}
            cells |= {"source": str(Source.DETECTIONS), "fault": NO_FAULT, "measured": HELD_OUT}
            cells |= {"seed": seed, "trained": result.trained, "reason": "; ".join(one.reasons)}
            cells["model_misfit"] = "" if one.model_misfit is None else int(one.model_misfit)
            yield [cells.get(column, "") for column in header]


def own_table(result: OwnResult) -> Table:
    """Return the errors of all methods on detections of one's own, for people."""
    parts = len(result.held_out)
    views = sum(map(len, result.held_out))
    how = f"{counted(views, 'view')} held out" + (f", in {parts} parts" if parts > 1 else "")
    table = Table(title=f"Detections {result.name}: {how}")
    table.add_column("method", overflow="fold")
    for column in ("RMS error, mm", "over the best", "coverage", "expected, mm", "extrapolated"):
        table.add_column(column, justify="right")
    for one in result.methods:
        if not one.predicted:
            table.add_row(one.method, "-", "-", "-", "-", "-")
            continue
        cells = [one.method + ("*" if one.model_misfit else ""), f"{one.rmse_mm:.4g}", f"{one.over_best:.2f}"]
        known = ((one.coverage95, ".3f"), (one.expected_mm, ".4g"))
        cells += [format(value, form) if np.isfinite(value) else "-" for value, form in known]
        cells.append(f"{one.extrapolated} of {one.n}")
        table.add_row(*cells)
    reasons = [f"{one.method}: {reason}" for one in result.methods for reason in one.reasons]
    legend = [
        "Against the places that the stage gives, whose own errors are in the figures.",
        "*: flagged model-misfit, from training data alone.",
    ]
    table.caption = "\n".join([*legend, *reasons])
    table.caption_justify = "left"
    return table


def _result(name: str, group: Sequence[Part]) -> OwnResult:
    methods = [_method(method, group) for method in group[0].case.methods]
    best = min((one.rmse_mm for one in methods if one.rmse_mm >= 0.0), default=_NAN)
    return OwnResult(
        name=name,
        held_out=tuple(part.case.held_out for part in group),
        trained=min(part.figures.trained for part in group),
        methods=tuple(
            one.model_copy(update={"over_best": one.rmse_mm / best}) if best > 0.0 else one for one in methods
        ),
    )


def _method(method: str, group: Sequence[Part]) -> OwnMethod:
    own = [_of_part(part, method) for part in group]
    regions = [region for one in own for region in one.regions]
    judged = [one.misfit for one in own if one.reason is None]
    return OwnMethod(
        method=method,
        n=sum(one.n for one in regions),
        predicted=sum(one.predicted for one in regions),
        rmse_mm=_pooled(regions),
        over_best=_NAN,
        stated=sum(one.stated for one in regions),
        covered=sum(one.covered for one in regions),
        coverage95=pooled_coverage(regions),
        model_misfit=None if not judged or None in judged else all(judged),
        extrapolated=sum(one.extrapolated for one in regions),
        expected_mm=known_median([one.expected_mm for one in own]),
        reasons=tuple(dict.fromkeys(one.reason for one in own if one.reason is not None)),
    )


def _of_part(part: Part, method: str) -> MethodFigures:
    if part.figures.reason is not None:
        return MethodFigures(method=method, reason=part.figures.reason)
    return next(one for one in part.figures.methods if one.method == method)


def _pooled(regions: Sequence[RegionFigures]) -> float:
    """Return the RMS error of the points of all parts; NaN of none."""
    known = [one for one in regions if one.predicted]
    count = sum(one.predicted for one in known)
    if not count:
        return _NAN
    return float(np.sqrt(sum(one.predicted * one.rmse_mm**2 for one in known) / count))
