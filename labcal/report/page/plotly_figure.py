"""A space as a figure that plotly's script draws."""

import json
from collections.abc import Iterable

import numpy as np

from labcal.report.error_colours import STOPS
from labcal.report.space import Direction, Space

CAMERAS, TARGET, POINTS, VECTORS = "cameras", "target", "points", "error vectors"
"""Layers, which the page shows and hides."""
_CAMERA_COLOURS = ("var(--ours)", "var(--second)", "var(--good)", "var(--odd)")
Trace = dict[str, object]


def plotly_figure(space: Space) -> str:
    """Return JSON with ``data`` and ``layout``, as plotly takes them, and ``directions``, cameras of it.

    Colours may be variables of the page's style, ``var(--ink)``, which the page replaces.

    Parameters
    ----------
    space : Space
        Thinned out already.
    """
    low, high = space.bounds
    figure = {
        "data": [*_camera_traces(space), *_target_traces(space), *_point_traces(space)],
        "layout": _layout(low, high, space),
        "directions": [
            {**_camera(direction, low, high), "inside": direction.inside} for direction in space.directions
        ],
    }
    return json.dumps(figure, separators=(",", ":"), allow_nan=False)


def layers(space: Space) -> tuple[str, ...]:
    """Return the layers that a space has."""
    drawn = {CAMERAS: space.cameras, TARGET: space.outlines, POINTS: space.points, VECTORS: space.vectors}
    return tuple(name for name, things in drawn.items() if len(things))


def _camera_traces(space: Space) -> list[Trace]:
    traces = []
    for number, (name, lines) in enumerate(space.frusta.items()):
        colour = _CAMERA_COLOURS[number % len(_CAMERA_COLOURS)]
        line = _lines(CAMERAS, lines)
        traces.append({**line, "line": {"color": colour, "width": 4}, "hoverinfo": "skip"})
        x, y, z = _rounded(space.cameras[name].centre)
        traces.append(
            {
                "type": "scatter3d", "mode": "text+markers", "meta": CAMERAS, "x": [x], "y": [y], "z": [z],
                "text": [name], "textposition": "bottom center", "marker": {"size": 4, "color": colour},
                "textfont": {"color": "var(--ink)"},
                "hovertemplate": "camera %{text}<br>%{x}, %{y}, %{z} mm<extra></extra>",
            }
        )  # fmt: skip
    return traces


def _target_traces(space: Space) -> list[Trace]:
    if not space.outlines:
        return []
    return [
        {**_lines(TARGET, space.outlines), "line": {"color": "var(--edge)", "width": 2}, "hoverinfo": "skip"}
    ]


def _point_traces(space: Space) -> list[Trace]:
    if len(space.points) == 0:
        return []
    x, y, z = (_rounded(column) for column in space.points.T)
    marker: dict[str, object] = {"size": 2.5, "color": "var(--ours)"}
    hover = "%{text}<br>%{x}, %{y}, %{z} mm"
    known = len(space.vectors) > 0
    if known:
        marker["color"] = _rounded(space.error_mm, 5)
        marker["colorscale"] = [[i / (len(STOPS) - 1), stop] for i, stop in enumerate(STOPS)]
        marker["colorbar"] = {
            "title": {"text": "error (mm)"}, "thickness": 12, "len": 0.6, "outlinewidth": 0,
        }  # fmt: skip
        hover += "<br>error %{marker.color} mm"
    point: Trace = {
        "type": "scatter3d", "mode": "markers", "meta": POINTS, "x": x, "y": y, "z": z, "marker": marker,
        "text": list(space.labels) or [""] * len(space.points), "hovertemplate": f"{hover}<extra></extra>",
    }  # fmt: skip
    if not known:
        return [point]
    vectors = _lines(VECTORS, np.stack([space.points, space.tips], axis=1))
    return [point, {**vectors, "line": {"color": "var(--second)", "width": 2}, "hoverinfo": "skip"}]


def _lines(layer: str, lines: Iterable[np.ndarray]) -> Trace:
    """Return lines (corners, 3) as one trace, with gaps between them."""
    columns: list[list[float | None]] = [[], [], []]
    for line in lines:
        for column, values in zip(columns, line.T, strict=True):
            column += [*_rounded(values), None]
    x, y, z = columns
    return {"type": "scatter3d", "mode": "lines", "meta": layer, "x": x, "y": y, "z": z}


def _layout(low: np.ndarray, high: np.ndarray, space: Space) -> dict[str, object]:
    extent = high - low
    scene: dict[str, object] = {
        "aspectmode": "manual",
        "aspectratio": dict(zip("xyz", _rounded(extent / extent.max(), 6), strict=True)),
        "dragmode": "orbit",
        "camera": _camera(space.directions[0], low, high),
    }
    for axis, least, most in zip("xyz", _rounded(low), _rounded(high), strict=True):
        scene[f"{axis}axis"] = {
            "title": {"text": f"{axis.upper()} (mm)"}, "range": [least, most], "color": "var(--quiet)",
            "gridcolor": "var(--line)", "zerolinecolor": "var(--line)", "showbackground": False,
        }  # fmt: skip
    return {
        "scene": scene,
        "showlegend": False,
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "font": {"color": "var(--ink)", "size": 12},
    }


def _camera(direction: Direction, low: np.ndarray, high: np.ndarray) -> dict[str, dict[str, float]]:
    """Return a direction in plotly's units: from the middle of the box, its longest side is 1."""
    middle, extent = 0.5 * (low + high), float((high - low).max())
    places = {
        "eye": (direction.eye - middle) / extent,
        "center": (direction.focus - middle) / extent,
        "up": direction.up / np.linalg.norm(direction.up),
    }
    return {name: dict(zip("xyz", _rounded(place, 6), strict=True)) for name, place in places.items()}


def _rounded(values: np.ndarray, digits: int = 4) -> list[float]:
    """Return numbers with so many decimals."""
    found: list[float] = np.round(values, digits).tolist()
    return found
