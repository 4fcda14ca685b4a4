"""A figure of detections: where the dots are in the pictures, and how sure that is."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure

from labcal.correspond.detections import Detections
from labcal.detect.flags import DotFlag
from labcal.distributions import chi2_quantile
from labcal.errors import InputError, UnknownNameError
from labcal.geometry.covariances import positive_definite

_WANTED = 0.3
"""Of the distance between neighbouring dots: wanted semi-axis of the median ellipse."""
_FACTORS = [m * 10**k for k in range(6) for m in (1, 2, 5)]
_OTHERS = [flag.value for flag in DotFlag if flag is not DotFlag.OK]


def detections_figure(table: Detections, view: str | None, camera: str | None) -> Figure:
    """Draw the dots of some pictures, an axes a camera; see :meth:`Detections.plot`."""
    chosen = _chosen(table, view, camera)
    names = chosen.cameras
    figure = Figure(figsize=(1.0 + 5.5 * len(names), 4.8), layout="constrained")
    for number, name in enumerate(names):
        axes = figure.add_subplot(1, len(names), number + 1)
        lines = chosen.where(chosen.camera == name)
        width, height = lines.picture_size(name)
        single = len(lines.views) == 1
        _draw_dots(axes, lines, 18.0 if single else 5.0)
        title = f"camera {name}, " + (f"view {lines.views[0]}" if single else f"{len(lines.views)} views")
        if single:
            factor = _draw_ellipses(axes, lines)
            title += f"\n95% ellipses enlarged {factor} times" if factor else ""
        axes.set_title(title)
        axes.set_xlim(-0.5, width - 0.5)
        axes.set_ylim(height - 0.5, -0.5)
        axes.set_aspect("equal")
        axes.set_xlabel("x (px)")
        axes.set_ylabel("y (px)")
        axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.14), ncols=2, frameon=False, fontsize="small")
    return figure


def _chosen(table: Detections, view: str | None, camera: str | None) -> Detections:
    """Return the lines of a view and a camera, or of all; raise where there are none."""
    if view is not None and view not in table.views:
        raise UnknownNameError("view", view, table.views)
    if camera is not None and camera not in table.cameras:
        raise UnknownNameError("camera", camera, table.cameras)
    chosen = np.ones(len(table), dtype=bool)
    if view is not None:
        chosen &= table.view == view
    if camera is not None:
        chosen &= table.camera == camera
    if not chosen.any():
        raise InputError("There are no dots to draw in such a picture. Choose another view or camera.")
    return table.where(chosen)


def _draw_dots(axes: Axes, lines: Detections, area: float) -> None:
    """Draw the positions that were measured, and say of each flag how many there are."""
    for number, flag in enumerate([DotFlag.OK.value, *_OTHERS]):
        of_flag = lines.flag == flag
        if of_flag.any():
            seen = lines.position[of_flag & np.isfinite(lines.position).all(axis=1)]
            missing = int(of_flag.sum()) - len(seen)
            label = f"{flag} ({of_flag.sum()}" + (f", {missing} unmeasured)" if missing else ")")
            marker = "o" if flag == DotFlag.OK.value else "X"
            axes.scatter(
                seen[:, 0], seen[:, 1], s=area, marker=marker, color=f"C{number}", label=label, linewidths=0.0
            )


def _draw_ellipses(axes: Axes, lines: Detections) -> int:
    """Draw the 95% confidence ellipses so large that they are seen; return by which factor, 0 for none."""
    stated = lines.where(np.asarray(positive_definite(lines.covariance)))
    if len(stated) < 2:  # noqa: PLR2004 -- neighbours
        return 0
    variances, vectors = np.linalg.eigh(stated.covariance)
    semi_axes = np.sqrt(chi2_quantile(0.95, 2) * variances)
    most = _WANTED * _spacing(stated) / float(np.median(semi_axes[:, 1]))
    factor = max((k for k in _FACTORS if k <= most), default=1)
    longest = vectors[:, :, 1]
    axes.add_collection(
        EllipseCollection(
            2.0 * factor * semi_axes[:, 1],
            2.0 * factor * semi_axes[:, 0],
            np.degrees(np.arctan2(longest[:, 1], longest[:, 0])),
            units="xy",
            offsets=stated.position,
            offset_transform=axes.transData,
            facecolors="none",
            edgecolors="0.3",
            linewidths=0.8,
        )
    )
    return factor


def _spacing(lines: Detections) -> float:
    """Return the median distance of a dot to its nearest neighbour, px."""
    between = np.linalg.norm(lines.position[:, None] - lines.position[None], axis=-1)
    np.fill_diagonal(between, np.inf)
    return float(np.median(between.min(axis=1)))
