"""The page of ``labcal compare``: differences and budgets over the pictures and over the volume."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from labcal.evaluate.comparison.lens_difference import LensDifference
from labcal.evaluate.comparison.rig_comparison import (
    CameraComparison,
    RigComparison,
    distance_text,
    volume_columns,
)
from labcal.evaluate.comparison.volume_difference import VolumeDifference
from labcal.evaluate.comparison.without_motion import RemainingDifference
from labcal.report.compare_result import chance_words, compare_result, comparison_words
from labcal.report.difference_map import difference_map
from labcal.report.error_map import error_map
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Section
from labcal.report.page.download import table_download
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.page_maker import PageMaker
from labcal.wording import listed

_HIGHEST = 98.0
"""Percentile of lengths within the supported region at which colours end, times :data:`_ROOM`."""
_ROOM = 1.5

_LENSES = (
    "A pixel of the first calibration is a ray; the point on it at the stated distance is projected by the "
    "second calibration, after the motion of the camera that explains most of the difference: that motion is "
    "common to all finite distances, and a rotation at infinity. Lines surround the dots of the first "
    "calibration (solid) and of the second (dashed): outside, lenses are extrapolated. The expected errors "
    "are standard deviations of the 2-D length by each calibration's covariance, after the same motion."
)
_VOLUME = (
    "Points that both rigs triangulate from the same pixels, after one motion of the world. The expected "
    "errors are those of shape and size by each calibration; noise of pixels is common to both and does not "
    "count."
)
_OVER = "from the front, from above and from the side"


def comparison_page(found: RigComparison, maker: PageMaker) -> Page:
    """Return the page of a comparison."""
    result = compare_result(found)
    sections = [Section("Figures", [_table(found)])]
    if found.volume is not None:
        sections.append(Section("Over the volume", _volume_parts(found.volume)))
    maps: list[Part] = [Prose((_LENSES,))]
    for camera in found.cameras:
        maps += _camera_parts(camera)
    sections.append(Section("Over the pictures", maps))
    return Page(
        title="Comparison of two calibrations",
        heading="Comparison of two calibrations",
        lead=f"Cameras {listed(result.cameras)}. {comparison_words(found)}",
        sections=sections,
        provenance=maker.provenance,
        opening=maker.notes(found.warnings),
    )


def _table(found: RigComparison) -> PageTable:
    """Return all figures."""
    rows = []
    for camera in found.cameras:
        lenses = f"{camera.one.camera.lens}, {camera.other.camera.lens}"
        rows += [
            [camera.name, lenses, distance_text(part), *_cells(part.remaining, ".4f"), "px"]
            for part in camera.differences
        ]
    if found.volume is not None:
        rows.append(["volume", MISSING, MISSING, *_cells(found.volume.remaining, ".5f"), "mm"])
    columns = [
        Column("", Side.LEFT), Column("lenses", Side.LEFT), Column("at (mm)"), Column("RMS"),
        Column("largest"), Column("expected, first", meaning="RMS by the errors of the first calibration"),
        Column("expected, second"), Column("unit", Side.LEFT),
    ]  # fmt: skip
    caption = "Differences within the region that both calibrations supported."
    if not np.isnan(found.p_value):
        caption += f" Chance of larger ones between independent calibrations: {chance_words(found.p_value)}."
    return PageTable("differences", caption, columns, rows)


def _cells(r: RemainingDifference, form: str) -> list[str]:
    values = (r.rms, r.largest, r.expected_rms(r.one), r.expected_rms(r.other))
    return [MISSING if np.isnan(value) else format(value, form) for value in values]


def _volume_parts(found: VolumeDifference) -> list[Part]:
    """Return the displacements over the volume, and what both rigs expect."""
    r, columns = found.remaining, volume_columns(found)
    data = table_download("volume.csv", list(columns), [column.tolist() for column in columns.values()])
    parts: list[Part] = [
        Prose((_VOLUME,)),
        Chart("volume-map", error_map(found.point, r.length, "volume-map"),
              f"Length of the displacement, {_OVER}.", data),
    ]  # fmt: skip
    for which, of in (("first", r.one), ("second", r.other)):
        if of is not None:
            svg = error_map(found.point, r.expected(of), f"budget-{which}")
            caption = f"Expected error by the {which} calibration, {_OVER}."
            parts.append(Chart(f"budget-{which}", svg, caption))
    return parts


def _camera_parts(camera: CameraComparison) -> list[Part]:
    """Return the maps of one camera: the difference at each distance, and both budgets at the middle one."""
    outlines = [camera.one.outline, camera.other.outline]
    size, main = camera.one.camera.size, camera.main
    r = main.remaining
    near = [part for part in camera.differences if np.isfinite(part.distance_mm[0])]
    most = _end_of_colours(near or camera.differences)
    charts: list[Part] = []
    for part in camera.differences:
        name = f"{camera.name}-{distance_text(part)}"
        end = most if np.isfinite(part.distance_mm[0]) else _end_of_colours([part])
        svg = difference_map(name, part.q, part.remaining.length, size, outlines, end)
        charts.append(Chart(name, svg, f"{camera.name}: difference at {_at(part)}."))
    for which, of in (("first", r.one), ("second", r.other)):
        if of is not None:
            charts.append(_budget(camera, which, r.expected(of), most))
    return [Beside(tuple(charts))]


def _end_of_colours(parts: Sequence[LensDifference]) -> float:
    """Return where the colours of maps end, px, by the lengths within the supported region."""
    lengths = [part.remaining.length[part.remaining.tested] for part in parts]
    return _ROOM * float(np.percentile(np.concatenate(lengths), _HIGHEST))


def _budget(camera: CameraComparison, which: str, expected: Float64[np.ndarray, " n"], most: float) -> Chart:
    """Return the map of the errors that one calibration expects of itself."""
    name, main = f"{camera.name}-budget-{which}", camera.main
    outline = [camera.one.outline if which == "first" else camera.other.outline]
    svg = difference_map(name, main.q, expected, camera.one.camera.size, outline, most)
    return Chart(name, svg, f"{camera.name}: expected error by the {which} calibration at {_at(main)}.")


def _at(part: LensDifference) -> str:
    """Return the distance of a difference with its unit."""
    return f"{distance_text(part)} mm" if np.isfinite(part.distance_mm[0]) else "infinity"
