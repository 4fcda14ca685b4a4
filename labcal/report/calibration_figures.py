"""Figures of a calibration as tables of its page, and what only some calibrations have."""

import numpy as np

from labcal.calibrate.displacement_figure import displacement_figure
from labcal.calibrate.freed_dots import FreedDots
from labcal.report.calibrate_result import CalibrateResult
from labcal.report.expectation_result import expectation_rows, expectation_words, plus_minus
from labcal.report.inline_svg import inline_svg, page_style
from labcal.report.page.chart import Chart
from labcal.report.page.download import Download, table_download
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Terms
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.print_words import print_words
from labcal.run.tables import table_text
from labcal.wording import counted

_SHOWN_OUTLIERS = 20


def camera_table(result: CalibrateResult) -> PageTable:
    """Return the cameras with their standard deviations."""
    columns = [
        Column("camera", Side.LEFT),
        Column("views"),
        Column("dots"),
        Column("RMS alone, px", meaning="Of this camera calibrated alone"),
        Column("RMS in the rig, px"),
        Column("beyond noise, px", meaning="What dots scatter along each axis beyond their covariances"),
        Column("fx, px"),
        Column("fy, px"),
        Column("cx, px"),
        Column("cy, px"),
        Column("lens", Side.WIDE),
    ]
    rows = []
    for name, camera in result.cameras.items():
        (fx, _, cx), (_, fy, cy), _ = camera.K
        sigma = camera.sigma
        figures = zip((fx, fy, cx, cy), (sigma.fx, sigma.fy, sigma.cx, sigma.cy), strict=True)
        lens = f"{camera.lens}: " + ", ".join(f"{k:.4g}" for k in camera.dist)
        rows.append(
            [
                name, str(camera.views), str(camera.dots), f"{camera.rms_px:.4f}",
                f"{camera.rms_in_rig_px:.4f}", f"{camera.scatter_px:.4f}",
                *(f"{value:.2f} ± {one:.2f}" for value, one in figures), lens,
            ]
        )  # fmt: skip
    return PageTable("cameras-table", "Cameras; ± is one standard deviation.", columns, rows)


def expectation_parts(result: CalibrateResult) -> list[Part]:
    """Return baseline, angle and the errors to expect where the target was, by their sources."""
    parts: list[Part] = []
    if result.pairs:
        rows = [
            [f"{one.first}, {one.second}", *(plus_minus(value, sigma) for value, sigma in figures)]
            for one in result.pairs
            for figures in [
                ((one.baseline_mm, one.baseline_sigma_mm), (one.angle_deg, one.angle_sigma_deg)),
            ]
        ]
        columns = [Column("cameras", Side.LEFT), Column("baseline, mm"), Column("angle, degrees")]
        caption = "Distance of the cameras and angle between their axes; ± is one standard deviation."
        parts.append(PageTable("pairs", caption, columns, rows))
    words = expectation_words(result.expected_errors) + "."
    rows = expectation_rows(result.expected_errors)
    if not rows:
        return [*parts, Prose((words,))]
    columns = [
        Column("1 sigma", Side.LEFT),
        Column("by noise, mm"),
        Column("by the calibration, mm"),
        Column("its print alone, mm", meaning="The part by dots that are off on the print"),
        Column("together, mm"),
    ]
    return [*parts, PageTable("expected", words[0].upper() + words[1:], columns, rows)]


def _print_chart(dots: FreedDots) -> Chart:
    """Return the displacements of the dots on the print."""
    with page_style():
        figure = displacement_figure(dots)
        svg = inline_svg(figure, "print", "Displacements of the dots on the print, magnified")
    header = ("col", "row", "dx_mm", "dy_mm", "dz_mm", "freed")
    columns = (
        *dots.target.indices().T.tolist(),
        *np.round(dots.displacement.T, 5).tolist(),
        dots.freed.astype(int).tolist(),
    )
    caption = (
        "Where the dots are on the print, against where they are declared; circles are their uncertainty."
    )
    return Chart("print", svg, caption, table_download("print.csv", header, columns))


def further_parts(result: CalibrateResult, freed: FreedDots | None) -> list[Part]:
    """Return tables and figures that not every calibration has.

    Parameters
    ----------
    result : CalibrateResult
    freed : FreedDots or None
        The dots on the print, where their places were estimated.
    """
    parts: list[Part] = [] if freed is None else [_print_chart(freed)]
    if result.inconsistent is not None:
        rows = [[one.cause, one.why, ", ".join(one.views)] for one in result.inconsistent.causes]
        columns = [Column("likely cause", Side.LEFT), Column("why", Side.WIDE), Column("views", Side.LEFT)]
        parts.append(
            PageTable("causes", "Likely causes of the contradiction, the likeliest first.", columns, rows)
        )
    if result.lens_choice is not None:
        parts.append(_lens_table(result))
    if result.free_dots is not None:
        lines = print_words(result.free_dots.shape).splitlines()
        parts.append(
            Terms(tuple((name.strip(), words) for name, _, words in (one.partition(": ") for one in lines)))
        )
    if result.outliers:
        rows = [
            [one.view, one.camera, one.place(), f"{one.off_px[0]:+.2f}", f"{one.off_px[1]:+.2f}"]
            for one in result.outliers
        ]
        header = ("view", "camera", "dot", "off_x_px", "off_y_px")
        columns = [
            Column("view", Side.LEFT),
            Column("camera", Side.LEFT),
            Column("col, row"),
            Column("off in x, px"),
            Column("off in y, px"),
        ]
        count = counted(result.outlier_count, "outlier")
        caption = f"{count}, measured minus predicted; the largest {_SHOWN_OUTLIERS} at most."
        data = Download("outliers.csv", table_text(header, rows))
        parts.append(PageTable("outliers", caption, columns, rows[:_SHOWN_OUTLIERS], data))
    return parts


def _lens_table(result: CalibrateResult) -> PageTable:
    """Return the lens models that were tried."""
    rows = []
    for trial in result.lens_choice.trials if result.lens_choice is not None else ():
        if trial.refused is not None:
            rows.append([trial.lens, MISSING, MISSING, trial.refused])
            continue
        chosen = result.lens_choice is not None and trial.lens == result.lens_choice.lens
        verdict = "chosen" if chosen else "as good" if trial.as_good else ""
        worse = f"{trial.worse_px2:.2g} ± {trial.chance_px2:.1g}"
        rows.append([trial.lens, f"{trial.held_out_px:.4f}", worse, verdict])
    columns = [
        Column("lens model", Side.LEFT),
        Column("RMS held out, px"),
        Column("worse than the best by, px²"),
        Column("", Side.WIDE),
    ]
    return PageTable("lenses", "Lens models that were tried on views held out.", columns, rows)
