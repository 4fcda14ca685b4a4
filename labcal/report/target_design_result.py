"""Result of ``labcal target make``: the JSON document, and the table for people."""

from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from labcal.guide.target_design.design import TargetDesign
from labcal.guide.target_design.trial import TriedView
from labcal.report.columns import name_column
from labcal.targets.paper import sheet_size
from labcal.targets.registry import kind_of

_VIEWS = (
    "Take 12 to 25 views over the whole depth, tilted by 25 to 45 degrees to all sides, also at the edges."
)


@dataclass(frozen=True)
class ShippedResult:
    """A shipped target in the JSON document."""

    target: str
    fits: bool
    reasons: tuple[str, ...]
    """Reasons why it does not fit."""
    relative_error: float
    """Expected error of a calibration over that with the design; null where it does not fit."""
    paper: str | None


@dataclass(frozen=True)
class DesignResult:
    """The JSON document of ``labcal target make``."""

    target: str
    kind: str
    file: str | None
    print: str | None
    paper: str
    tiles: tuple[int, int]
    board_mm: tuple[float, float]
    sheet_mm: tuple[float, float]
    dots: int
    description: dict[str, Any]
    """The target, as in its file."""
    part: str
    """The part of the target that limits its size."""
    least_px: float
    """Its size in the picture at the far distance and the greatest tilt."""
    needed_px: float
    growth: float
    """1; more where smaller dots were not found in the drawn pictures."""
    sigma_px: float
    """Largest error (RMS of a coordinate of a dot) over the views."""
    views: tuple[TriedView, ...]
    """Drawn pictures by distance and tilt."""
    best_shipped: str | None
    shipped: tuple[ShippedResult, ...]


def design_result(
    found: TargetDesign,
    file: str | PathLike[str] | None,
    print_file: str | PathLike[str] | None,
) -> DesignResult:
    """Return the JSON document."""
    fitting = [one for one in found.shipped if one.fits]
    return DesignResult(
        target=found.target.name,
        kind=kind_of(found.target).name,
        file=None if file is None else fspath(file),
        print=None if print_file is None else fspath(print_file),
        paper=found.question.paper.name,
        tiles=found.question.tiles,
        board_mm=found.board_mm,
        sheet_mm=sheet_size(found.target),
        dots=found.target.count,
        description=found.target.model_dump(mode="json"),
        part=found.need.part,
        least_px=found.least_px,
        needed_px=found.need.least_px,
        growth=found.growth,
        sigma_px=max(view.sigma_px for view in found.views),
        views=found.views,
        best_shipped=fitting[0].target if fitting else None,
        shipped=tuple(
            ShippedResult(one.target, one.fits, one.reasons, one.relative_error, one.paper)
            for one in found.shipped
        ),
    )


def design_table(result: DesignResult) -> Group:
    """Return the document for people."""
    several = len({view.camera for view in result.views}) > 1
    table = Table(
        *([name_column("camera")] if several else []),
        "distance (mm)",
        "tilt (deg)",
        "square (px)" if result.kind == "charuco" else "dot radius (px)",
        "of picture",
        "found",
        "error (px)",
    )
    for view in result.views:
        table.add_row(
            *([view.camera] if several else []),
            f"{view.distance_mm:g}",
            f"{view.tilt_deg:g}",
            f"{view.size_px:.1f}",
            f"{100.0 * view.picture_share:.0f}%",
            f"{100.0 * view.found / max(1, view.whole):.0f}%",
            f"{view.sigma_px:.4f}",
        )
    parts: list[RenderableType] = [Text(shipped_words(result)), Text(chosen_words(result)), table]
    parts += [Text(why_words(result)), Text(_VIEWS)]
    made = [file for file in (result.file, result.print) if file is not None]
    if result.print is not None:
        parts.append(Text(f"{', '.join(made)}. Print at 100 % and check the ruler."))
    elif made:
        parts.append(Text(f"{made[0]}. Print it: labcal target export {made[0]} -o {result.target}.pdf"))
    return Group(*parts)


def shipped_words(result: DesignResult) -> str:
    """Return which shipped target fits, in words."""
    fitting = [one for one in result.shipped if one.fits]
    if not fitting:
        return "Shipped targets: none fits."
    named = [f"{one.target} ({one.relative_error:.2g} times)" for one in fitting[:3]]
    verb = "fits" if len(named) == 1 else "fit"
    return (
        f"Shipped targets: {', '.join(named)} {verb}; in brackets the expected error over that of the design."
    )


def chosen_words(result: DesignResult) -> str:
    """Return what was chosen, in words."""
    width, height = result.board_mm
    tiles = "" if result.tiles == (1, 1) else f" in {result.tiles[0]} x {result.tiles[1]} tiles"
    sizes = result.description
    if result.kind == "charuco":
        what = f"{sizes['squares'][0]} x {sizes['squares'][1]} squares of {sizes['square_mm']:g} mm"
    else:
        pitch = sizes.get("pitch_x_mm") or sizes.get("pitch_mm")
        what = (
            f"{sizes['cols']} x {sizes['rows']} dots of {sizes['dot_diameter_mm']:g} mm, {pitch:g} mm apart"
        )
    return (
        f"Design {result.target}: {what}; a board of {width:g} mm x {height:g} mm on {result.paper}{tiles}."
    )


def why_words(result: DesignResult) -> str:
    """Return why, in words."""
    limit = (
        f"At the far distance and the greatest tilt the {result.part} is {result.least_px:.1f} px; the "
        f"detector needs {result.needed_px:.3g} px."
    )
    size = (
        " Smaller parts would hold more of them, and a smaller error, but are not found safely."
        if result.least_px < 1.2 * result.needed_px
        else " Smaller parts would be found, too, but would be too many, or too small to print."
    )
    return limit + size
