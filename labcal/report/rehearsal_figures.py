"""Figures of the page of a rehearsal: the map, the recommended poses, the number of views."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from labcal.geometry.poses import transform
from labcal.guide.rehearsal.map_figure import map_figure
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.report.error_colours import ERROR_COLOURS
from labcal.report.inline_svg import LINE, OURS, QUIET, SECOND, TEXT, inline_svg, page_style
from labcal.report.page_axes import plain_axes
from labcal.report.target_outline import target_outline

_COLUMNS = 6
_MOST_POSES = 36


def map_svg(found: Rehearsal) -> str:
    """Return the map of the expected error as SVG."""
    with page_style():
        figure = map_figure(found.forecast, ERROR_COLOURS)
        return inline_svg(figure, "map", "Expected errors in three slices of the working volume")


def views_svg(found: Rehearsal) -> str:
    """Return the error by number of views as SVG."""
    with page_style():
        figure = Figure(figsize=(9.4, 3.4), layout="constrained")
        axes = figure.add_subplot()
        counts = [one.views for one in found.counts]
        axes.plot(counts, [one.rms_mm for one in found.counts], "o-", color=OURS.drawn, markersize=4)
        axes.plot(len(found.views), found.rms_mm, "o", color=SECOND.drawn, markersize=8, label="planned")
        axes.set_xlabel("views")
        axes.set_ylabel("expected RMS error (mm)")
        axes.set_ylim(bottom=0.0)
        axes.legend(frameon=False)
        plain_axes(axes)
        return inline_svg(figure, "views", "Expected error by number of views")


def poses_svg(found: Rehearsal) -> str:
    """Return the target in the recommended poses, as each picture of the first camera will show it."""
    camera = found.rig.camera(next(iter(found.rig.cameras)))
    outline, dots = target_outline(found.plan.target), found.plan.target.points()
    views = found.views[:_MOST_POSES]
    rows = -(-len(views) // _COLUMNS)
    width, height = camera.size
    with page_style():
        figure = Figure(figsize=(9.4, 9.4 / _COLUMNS * (height / width + 0.14) * rows), layout="constrained")
        panels = np.ravel(figure.subplots(rows, _COLUMNS, squeeze=False))
        for axes in panels:
            axes.axis("off")
        for number, (axes, T) in enumerate(zip(panels, views, strict=False), start=1):
            edge = camera.project(transform(T, outline))
            axes.add_patch(Rectangle((-0.5, -0.5), width, height, fill=False, edgecolor=LINE.drawn))
            axes.add_patch(Polygon(edge.q[edge.ok], fill=False, edgecolor=OURS.drawn, linewidth=1.2))
            first = camera.project(transform(T, dots[0])).q
            axes.plot(*first, "o", color=SECOND.drawn, markersize=3)
            axes.set_xlim(-0.5, width - 0.5)
            axes.set_ylim(height - 0.5, -0.5)
            axes.set_aspect("equal")
            axes.set_title(f"{number}: {tilt_deg(T):.0f}°", fontsize=8.0, color=QUIET.drawn)
        figure.suptitle("", color=TEXT.drawn)
        return inline_svg(figure, "poses", "The target in each recommended view, in the first camera")


def tilt_deg(T_first_target: np.ndarray) -> float:
    """Return the angle between the target's normal and the line to the first camera, degrees."""
    towards = -T_first_target[:3, 3]
    cosine = float(T_first_target[:3, 2] @ towards / np.linalg.norm(towards))
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
