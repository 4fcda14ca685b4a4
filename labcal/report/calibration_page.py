"""The page of ``labcal calibrate``: the verdict, the rig in space, residuals, pictures."""

import numpy as np

from labcal.calibrate.calibration import Calibration
from labcal.calibrate.displacement_figure import displacement_figure
from labcal.calibrate.eccentricity import centred
from labcal.calibrate.freed_dots import FreedDots
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.errors import InputError
from labcal.evaluate.verdict.calibration_evidence import calibration_evidence, target_places
from labcal.evaluate.verdict.of_calibration import calibration_verdict
from labcal.geometry.poses import transform
from labcal.report.calibrate_result import CalibrateResult, calibrate_result
from labcal.report.inline_svg import inline_svg, page_style
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Section
from labcal.report.page.download import Download, table_download
from labcal.report.page.part import Part
from labcal.report.page.photograph import Photograph
from labcal.report.page.prose import Prose, Terms
from labcal.report.page.space_view import SpaceView
from labcal.report.page.statement import Statement
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.page_maker import PageMaker
from labcal.report.print_words import print_words
from labcal.report.residual_map import residual_magnification, residual_map
from labcal.report.space import Space
from labcal.report.target_outline import target_outline
from labcal.report.view_residuals import view_residuals
from labcal.run.tables import table_text
from labcal.targets.catalogue import AnyTarget
from labcal.wording import counted

_SHOWN_OUTLIERS = 20
_PAIR = 2


def calibration_page(made: Calibration, detections: Detections, target: AnyTarget, maker: PageMaker) -> Page:
    """Return the page of a calibration from dots of a target.

    Parameters
    ----------
    made : Calibration
    detections : Detections
        What it was made from; pictures that they name and that can be read are shown.
    target : AnyTarget
    maker : PageMaker
    """
    found = made.found
    result = calibrate_result(made, detections, target)
    verdict = calibration_verdict(calibration_evidence(made, target))
    names = list(found.rig.cameras)
    sections = [
        Section("In space", [SpaceView("space", _space(found, detections, target), _IN_SPACE)]),
        Section("Residuals", [Prose((_RESIDUALS,)), Beside(tuple(_residual_parts(found)))]),
        Section("Cameras", [_camera_table(result)]),
        Section("Pictures", [Prose((_PICTURES,)), Beside(tuple(_photographs(found, detections)))]),
    ]
    further = _further(result)
    if found.freed is not None:
        further.insert(0, _print_chart(found.freed))
    if further:
        sections.append(Section("Further figures", further))
    return Page(
        title=f"Calibration of {', '.join(names)}",
        heading=f"Calibration of {', '.join(names)}",
        lead=f"{counted(len(found.views), 'view')} of {target.name}, held in the hand; lens {made.lens}.",
        sections=sections,
        provenance=maker.provenance,
        opening=[Statement(verdict, maker.phrase), *maker.notes(made.warnings)],
    )


_IN_SPACE = (
    "Cameras with their fields of view, the target in every view, and its dots where the rays of all cameras "
    "meet. An error vector leads from there to where the adjustment places the dot."
)
_RESIDUALS = (
    "A residual is the predicted minus the measured position of a dot. Thin lines are single dots, which "
    "show noise. A thick arrow is the mean of its cell: noise averages out there, so that thick arrows that "
    "point the same way as their neighbours show a wrong lens or a bent print."
)
_PICTURES = (
    "Of each camera the picture with the largest RMS residual, with its dots in green and residuals in red."
)


def _space(found: HandheldCalibration, detections: Detections, target: AnyTarget) -> Space:
    """Return the rig, the target in all views, and its dots with their errors where two cameras saw them."""
    cameras = {name: found.rig.camera(name) for name in found.rig.cameras}
    outline = target_outline(target)
    outlines = [transform(T, outline) for T in found.T_world_target]
    if len(cameras) < _PAIR:
        return Space(cameras, outlines, target_places(found, target))
    matches = match(found.entering(detections), tuple(cameras))
    if found.disagreement is None and len(matches):
        try:
            matches, _ = centred(list(cameras.values()), matches, target)
        except InputError:  # points are nowhere near a target
            matches = matches.where(np.zeros(len(matches), dtype=bool))
    met = triangulate(list(cameras.values()), matches.q, matches.covariance)
    dots = target.points() if found.freed is None else found.freed.place
    of_view = dict(zip(found.views, found.T_world_target, strict=True))
    numbers = matches.index[:, 1] * target.cols + matches.index[:, 0]
    placed = np.array(
        [
            transform(of_view[view], dots[i])
            for view, i in zip(matches.view.tolist(), numbers.tolist(), strict=True)
        ]
    ).reshape(-1, 3)
    labels = [
        f"{view}, dot {col}, {row}" for view, (col, row) in zip(matches.view, matches.index, strict=True)
    ]
    ok = met.ok
    labels = [label for label, good in zip(labels, ok.tolist(), strict=True) if good]
    return Space(cameras, outlines, met.point[ok], placed[ok] - met.point[ok], labels)


def _residual_parts(found: HandheldCalibration) -> list[Part]:
    """Return the residuals of each camera over its picture, and by view."""
    of, names = found.residuals, list(found.rig.cameras)
    parts: list[Part] = []
    widest = max(record.size[0] for record in found.rig.cameras.values())
    times = residual_magnification(of.residual[~of.outlier], widest)
    for number, name in enumerate(names):
        mine = of.camera == number
        size = found.rig.cameras[name].size
        svg = residual_map(name, of.q[mine], of.residual[mine], of.outlier[mine], size, times)
        outliers = int(of.outlier[mine].sum())
        crosses = f"; {counted(outliers, 'outlier')} as crosses" if outliers else ""
        caption = f"{name}: residuals of {int(mine.sum()) - outliers} dots over the picture{crosses}."
        parts.append(Chart(f"residuals-{name}", svg, caption, _residual_file(found, number)))
    rms = of.rms_px(len(names), len(found.views))
    svg = view_residuals(found.views, tuple(names), rms, found.rms_px)
    parts.append(
        Chart(
            "views",
            svg,
            "RMS residual of every picture. One that stands out was moved, blurred, or is not of this rig.",
        )
    )
    return parts


def _residual_file(found: HandheldCalibration, number: int) -> Download:
    """Return the residuals of a camera as a table."""
    of, name = found.residuals, list(found.rig.cameras)[number]
    rows = np.flatnonzero(of.camera == number)
    columns = (
        [found.views[view] for view in of.view[rows].tolist()],
        *np.round(of.q[rows].T, 4).tolist(),
        *np.round(of.residual[rows].T, 4).tolist(),
        of.outlier[rows].astype(int).tolist(),
    )
    header = ("view", "x_px", "y_px", "residual_x_px", "residual_y_px", "outlier")
    return table_download(f"residuals-{name}.csv", header, columns)


def _camera_table(result: CalibrateResult) -> PageTable:
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


def _photographs(found: HandheldCalibration, detections: Detections) -> list[Part]:
    """Return the worst picture of each camera."""
    of = found.residuals
    rms = of.rms_px(len(found.rig.cameras), len(found.views))
    parts: list[Part] = []
    for number, name in enumerate(found.rig.cameras):
        if not np.isfinite(rms[number]).any():
            continue
        worst = int(np.nanargmax(rms[number]))
        view = found.views[worst]
        rows = np.flatnonzero((of.camera == number) & (of.view == worst))
        mine = (detections.view == view) & (detections.camera == name)
        path = str(detections.image[mine][0])
        parts.append(
            Photograph(f"picture-{name}", path, of.q[rows], of.residual[rows], f"{view}, camera {name}")
        )
    return parts


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


def _further(result: CalibrateResult) -> list[Part]:
    """Return tables of what not every calibration has."""
    parts: list[Part] = []
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
            [one.view, one.camera, f"{one.col}, {one.row}", f"{one.off_px[0]:+.2f}", f"{one.off_px[1]:+.2f}"]
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
