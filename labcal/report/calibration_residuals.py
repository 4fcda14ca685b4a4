"""Residuals of a calibration as parts of its page: over the pictures, by view, and in the worst pictures."""

import numpy as np

from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.correspond.detections import Detections
from labcal.report.page.chart import Chart
from labcal.report.page.download import Download, table_download
from labcal.report.page.part import Part
from labcal.report.page.photograph import Photograph
from labcal.report.residual_map import residual_magnification, residual_map
from labcal.report.view_residuals import view_residuals
from labcal.wording import counted


def residual_parts(found: HandheldCalibration) -> list[Part]:
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


def worst_pictures(found: HandheldCalibration, detections: Detections) -> list[Part]:
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
        path, (width, height) = str(detections.image[mine][0]), detections.size[mine][0].tolist()
        title = f"{view}, camera {name}"
        parts.append(
            Photograph(f"picture-{name}", path, of.q[rows], of.residual[rows], title, (width, height))
        )
    return parts
