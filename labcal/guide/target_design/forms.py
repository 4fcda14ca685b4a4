"""Targets of each kind by the size that their parts need in the picture."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from labcal.guide.target_design.question import TargetQuestion
from labcal.guide.target_design.room import Room, largest
from labcal.guide.target_design.sight import Sight, least_scale
from labcal.targets.catalogue import AnyTarget
from labcal.targets.charuco import CharucoBoard, MarkerDictionary
from labcal.targets.coded_dots import CodedDots
from labcal.targets.grid import DotGrid, Rings
from labcal.targets.registry import PLAIN
from labcal.targets.ring_codes import RingCode

LEAST_AXIS_PX = 5.0
"""Least minor semi-axis of a dot. All drawn pictures of a webcam are indexed from 4 px on."""
LEAST_CODED_AXIS_PX = 6.0
"""The same of a coded dot, whose ring is read from 5 px on."""
LEAST_MARKER_PX = 18.0
"""Least side of a marker of 7 cells. All drawn pictures of a webcam are read from 14 px on."""
BLUR_SHARE = 0.35
"""Most blur over the minor semi-axis with which the detector was tried."""
DOT_SHARE = 0.6
"""Diameter of a dot over the pitch."""
HOLE_SHARE = 0.42
"""Diameter of a ring's hole over that of the ring."""
LEAST_PRINTED_MM = 1.0
"""Diameter of the smallest dot that an office printer draws round: 24 of its points at 600 dpi."""
MOST_DOTS = 800
"""More make every calibration slow that estimates the places of dots."""
FEWEST = (5, 4)
"""Columns and rows among which three rings have a place."""
_MARGIN_SHARE = 0.75
_MARKER_SHARE = 0.75
_CODED_PITCH = 4.2
"""In diameters of a dot."""
_RING_FIELD = 0.55
"""Share of the picture's shorter side within which the rings are at the near distance."""


@dataclass(frozen=True)
class Need:
    """Least sizes of a target in the picture, with which it is found.

    Parameters
    ----------
    least_px : float
        Least size in the picture of the smallest part: minor semi-axis of a dot, side of a marker.
    part : str
        Name of it.
    feature_mm : callable
        Takes a target; returns the same size of it, mm.
    """

    least_px: float
    part: str
    feature_mm: Callable[[AnyTarget], float]


def need_of(kind: str, blur_px: float) -> Need:
    """Return what the detector needs of targets of a kind."""
    blurred = blur_px / BLUR_SHARE
    if kind == "charuco":
        return Need(LEAST_MARKER_PX, "marker's side", lambda target: getattr(target, "marker_mm", math.nan))
    least = LEAST_CODED_AXIS_PX if kind == "coded-dots" else LEAST_AXIS_PX
    return Need(
        max(least, blurred),
        "dot's minor semi-axis",
        lambda target: 0.5 * getattr(target, "dot_diameter_mm", math.nan),
    )


def farthest_mm(question: TargetQuestion, longer_mm: float) -> float:
    """Return the distance of the far edge of a board at the far distance, tilted the most."""
    return question.far_mm + 0.5 * longer_mm * math.sin(math.radians(question.tilt_max_deg))


def formed(question: TargetQuestion, sights: list[Sight], room: Room, growth: float) -> AnyTarget | None:
    """Return the target with the smallest parts that are found, and as many as there is room for.

    Parameters
    ----------
    question : TargetQuestion
    sights : list of Sight
    room : Room
    growth : float
        Parts are so many times as large as needed.

    Returns
    -------
    AnyTarget or None
        None where there is no room for it.
    """
    scale = least_scale(sights, farthest_mm(question, room.longer_mm), question.tilt_max_deg)
    least_mm = growth * need_of(question.kind, question.photometry.blur_px).least_px / scale
    return _FORMS[question.kind](question, sights, room, least_mm)


def _dots(question: TargetQuestion, sights: list[Sight], room: Room, radius_mm: float) -> AnyTarget | None:
    diameter = max(2.0 * radius_mm, LEAST_PRINTED_MM)
    pitch = _rounded_up(diameter / DOT_SHARE)
    while _count(room, pitch) > MOST_DOTS:
        pitch = _rounded_up(pitch * 1.001 + 1e-9)
    margin = _margin(pitch)
    reach = min(_RING_FIELD * min(sight.width_mm(question.near_mm)) for sight in sights) / pitch
    if reach < min(FEWEST) - 2:
        return None

    def made(cols: int, rows: int) -> AnyTarget | None:
        if cols < min(FEWEST) or rows < min(FEWEST) or max(cols, rows) < max(FEWEST):
            return None
        dot = math.floor(10.0 * DOT_SHARE * pitch + 1e-9) / 10.0
        return DotGrid(
            name=_name(question, cols, rows),
            description=f"{cols} x {rows} dots at {pitch:g} mm with rings, designed {_words(question)}.",
            cols=cols,
            rows=rows,
            pitch_x_mm=pitch,
            pitch_y_mm=pitch,
            dot_diameter_mm=dot,
            ring_outer_diameter_mm=dot,
            ring_inner_diameter_mm=round(HOLE_SHARE * dot, 2),
            rings=rings_among(cols, rows, reach),
            margin_mm=margin,
        )

    return largest(question, _counts(room, pitch, margin), made)


def _coded(question: TargetQuestion, sights: list[Sight], room: Room, radius_mm: float) -> AnyTarget | None:  # noqa: ARG001
    diameter = math.ceil(10.0 * max(2.0 * radius_mm, LEAST_PRINTED_MM) - 1e-9) / 10.0
    pitch = _rounded_up(_CODED_PITCH * diameter)
    margin = round(0.55 * pitch, 2)

    def made(cols: int, rows: int) -> AnyTarget | None:
        if min(cols, rows) < 2 or cols * rows > RingCode.RING_31.size:  # noqa: PLR2004 -- four dots at least
            return None
        code = RingCode.RING_23 if cols * rows <= RingCode.RING_23.size else RingCode.RING_31
        return CodedDots(
            kind="coded-dots",
            name=_name(question, cols, rows),
            description=f"{cols} x {rows} coded dots at {pitch:g} mm, designed {_words(question)}.",
            code=code,
            cols=cols,
            rows=rows,
            pitch_mm=pitch,
            dot_diameter_mm=diameter,
            margin_mm=margin,
        )

    return largest(question, _counts(room, pitch, margin), made)


def _charuco(question: TargetQuestion, sights: list[Sight], room: Room, side_mm: float) -> AnyTarget | None:  # noqa: ARG001
    square = _rounded_up(side_mm / _MARKER_SHARE)
    margin = round(0.5 * square, 2)

    def made(cols: int, rows: int) -> AnyTarget | None:
        if min(cols, rows) < 3:  # noqa: PLR2004 -- the fewest squares
            return None
        dictionary = next((one for one in _DICTIONARIES if one.size >= (cols * rows + 1) // 2), None)
        if dictionary is None:
            return None
        return CharucoBoard(
            kind="charuco",
            name=_name(question, cols, rows),
            description=f"{cols} x {rows} squares of {square:g} mm, designed {_words(question)}.",
            squares=(cols, rows),
            square_mm=square,
            marker_mm=round(_MARKER_SHARE * square, 2),
            dictionary=dictionary,
            margin_mm=margin,
        )

    counts = (int((room.width_mm - 2.0 * margin) / square), int((room.height_mm - 2.0 * margin) / square))
    return largest(question, (min(counts[0], 200), min(counts[1], 200)), made)


_FORMS: Mapping[str, Callable[[TargetQuestion, list[Sight], Room, float], AnyTarget | None]] = {
    PLAIN: _dots,
    "charuco": _charuco,
    "coded-dots": _coded,
}
_DICTIONARIES = (
    MarkerDictionary.DICT_5X5_50,
    MarkerDictionary.DICT_5X5_100,
    MarkerDictionary.DICT_5X5_250,
    MarkerDictionary.DICT_5X5_1000,
)


def rings_among(cols: int, rows: int, reach: float) -> Rings:
    """Return three rings about the middle of a grid, not farther apart than a number of pitches.

    The two arms of their L differ in length, so that either tells its axis.
    """
    most = max(2, int(reach))
    x = min(max(2, round(0.45 * (cols - 1))), most, cols - 2)
    y = min(max(1, round(0.45 * (rows - 1))), most, rows - 2)
    if x == y:
        x, y = (x + 1, y) if x + 1 <= min(most, cols - 2) else (x, y - 1)
    left, low = (cols - 1 - x) // 2, (rows - 1 - y) // 2
    return Rings(origin=(left, low), x=(left + x, low), y=(left, low + y))


def _counts(room: Room, pitch: float, margin: float) -> tuple[int, int]:
    cols, rows = (int((side - 2.0 * margin) / pitch + 1e-9) + 1 for side in (room.width_mm, room.height_mm))
    return cols, rows


def _margin(pitch: float) -> float:
    """Return the bare board around the outermost dots, mm: three quarters of a pitch."""
    step = 0.1 if pitch < 3.0 else 0.5  # noqa: PLR2004 -- as of pitches
    return round(math.ceil(_MARGIN_SHARE * pitch / step - 1e-9) * step, 3)


def _count(room: Room, pitch: float) -> int:
    cols, rows = _counts(room, pitch, _margin(pitch))
    return max(cols, 0) * max(rows, 0)


def _rounded_up(length_mm: float) -> float:
    """Return a length in whole steps: half a mm, a tenth below 3 mm, 5 mm from 60 mm on."""
    step = 0.1 if length_mm < 3.0 else 0.5 if length_mm < 60.0 else 5.0  # noqa: PLR2004 -- of people
    return round(math.ceil(length_mm / step - 1e-9) * step, 3)


def _name(question: TargetQuestion, cols: int, rows: int) -> str:
    if question.name is not None:
        return question.name
    paper = question.paper.name.replace(".", "-")
    tiles = "" if question.tiles == (1, 1) else f"-{question.tiles[0]}by{question.tiles[1]}"
    return f"{paper}{tiles}-{cols}x{rows}"


def _words(question: TargetQuestion) -> str:
    """Return what a target was designed for."""
    sizes = sorted({f"{camera.size[0]} x {camera.size[1]}" for camera in question.cameras.values()})
    near, far = question.near_mm, question.far_mm
    distance = f"{near:g} mm" if near == far else f"{near:g} to {far:g} mm"
    return (
        f"for pictures of {', '.join(sizes)} px at {distance}, tilted up to {question.tilt_max_deg:g} degrees"
    )
