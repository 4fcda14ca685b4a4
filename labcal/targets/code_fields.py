"""The fields of a description in a print's QR code, of each of labcal's kinds of targets."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from labcal.errors import InputError
from labcal.targets.april_grid import AprilGrid
from labcal.targets.catalogue import AnyTarget
from labcal.targets.charuco import CharucoBoard, MarkerDictionary, Pattern
from labcal.targets.chessboard import Chessboard, SquareColour
from labcal.targets.coded_dots import CodedDots
from labcal.targets.grid import DotGrid, Layout, Polarity
from labcal.targets.ring_codes import RingCode
from labcal.wording import clipped


@dataclass(frozen=True)
class Form:
    """The form of a kind's fields.

    Attributes
    ----------
    letter : str
        The kind, in the text.
    model : type
        The kind's description.
    fields : callable
        Takes a target of the kind; returns what is between its name and the number of the copy.
    target : callable
        Takes a name and these fields; returns the target, or raises InputError, or a ValidationError of
        pydantic.
    """

    letter: str
    model: type
    fields: Callable[[Any], list[str]]
    target: Callable[[str, Sequence[str]], AnyTarget]


def form_of(target: AnyTarget) -> Form | None:
    """Return the form of a target's fields; None for a kind of a user's."""
    return next((form for form in FORMS.values() if type(target) is form.model), None)


def _grid_fields(grid: DotGrid) -> list[str]:
    rings = grid.rings
    return [
        f"{grid.cols}X{grid.rows}",
        _LETTERS[grid.layout],
        _number(grid.pitch_x_mm),
        _number(grid.pitch_y_mm),
        _number(grid.dot_diameter_mm),
        "" if grid.ring_outer_diameter_mm is None else _number(grid.ring_outer_diameter_mm),
        "" if grid.ring_inner_diameter_mm is None else _number(grid.ring_inner_diameter_mm),
        "" if rings is None else f"{rings.origin[0]}.{rings.origin[1]}.{rings.x[0]}.{rings.y[1]}",
        _LETTERS[grid.polarity],
        _number(grid.margin_mm),
    ]


def _grid(name: str, fields: Sequence[str]) -> DotGrid:
    size, layout, pitch_x, pitch_y, dot, outer, inner, rings, polarity, margin = _so_many(fields, 10)
    cols, rows = _wholes(size, "X", 2)
    marks = None
    if rings:
        col, row, x, y = _wholes(rings, ".", 4)
        marks = {"origin": (col, row), "x": (x, row), "y": (col, y)}
    return DotGrid.model_validate(
        {
            "name": name,
            "layout": _word(layout, Layout),
            "cols": cols,
            "rows": rows,
            "pitch_x_mm": _value(pitch_x),
            "pitch_y_mm": _value(pitch_y),
            "dot_diameter_mm": _value(dot),
            "ring_outer_diameter_mm": _value(outer) if outer else None,
            "ring_inner_diameter_mm": _value(inner) if inner else None,
            "polarity": _word(polarity, Polarity),
            "rings": marks,
            "margin_mm": _value(margin),
        }
    )


def _charuco_fields(board: CharucoBoard) -> list[str]:
    return [
        f"{board.squares[0]}X{board.squares[1]}",
        _number(board.square_mm),
        _number(board.marker_mm),
        _dictionary_word(board.dictionary),
        _LETTERS[board.pattern],
        _number(board.margin_mm),
        *([str(board.first_id)] if board.first_id else []),  # readers of before know boards from 0 on
    ]


def _charuco(name: str, fields: Sequence[str]) -> CharucoBoard:
    further = len(fields) == 7  # noqa: PLR2004 -- the first id, where it is not 0
    size, square, marker, dictionary, pattern, margin, *first = _so_many(fields, 6 + further)
    across, up = _wholes(size, "X", 2)
    return CharucoBoard.model_validate(
        {
            "kind": "charuco",
            "name": name,
            "squares": (across, up),
            "square_mm": _value(square),
            "marker_mm": _value(marker),
            "dictionary": _dictionary(dictionary),
            "pattern": _word(pattern, Pattern),
            "margin_mm": _value(margin),
            "first_id": _wholes(first[0], ".", 1)[0] if first else 0,
        }
    )


def _coded_fields(sheet: CodedDots) -> list[str]:
    return [
        f"{sheet.cols}X{sheet.rows}",
        str(sheet.code.sectors),
        str(sheet.first_mark),
        _number(sheet.pitch_mm),
        _number(sheet.dot_diameter_mm),
        _number(sheet.margin_mm),
    ]


def _coded(name: str, fields: Sequence[str]) -> CodedDots:
    size, sectors, first, pitch, dot, margin = _so_many(fields, 6)
    cols, rows = _wholes(size, "X", 2)
    (first_mark,) = _wholes(first, ".", 1)
    return CodedDots.model_validate(
        {
            "kind": "coded-dots",
            "name": name,
            "code": f"ring-{sectors}" if f"ring-{sectors}" in set(RingCode) else "ring",
            "first_mark": first_mark,
            "cols": cols,
            "rows": rows,
            "pitch_mm": _value(pitch),
            "dot_diameter_mm": _value(dot),
            "margin_mm": _value(margin),
        }
    )


def _chessboard_fields(board: Chessboard) -> list[str]:
    return [
        f"{board.cols}X{board.rows}",
        _number(board.square_mm),
        _LETTERS[board.lower_left],
        ".".join(str(k) for square in board.marks for k in square),
        _number(board.mark_share),
        _number(board.margin_mm),
    ]


def _chessboard(name: str, fields: Sequence[str]) -> Chessboard:
    size, square, lower_left, marks, mark_share, margin = _so_many(fields, 6)
    cols, rows = _wholes(size, "X", 2)
    places = _wholes(marks, ".", 2 * ((marks.count(".") + 1) // 2)) if marks else []
    return Chessboard.model_validate(
        {
            "kind": "chessboard",
            "name": name,
            "cols": cols,
            "rows": rows,
            "square_mm": _value(square),
            "lower_left": _word(lower_left, SquareColour),
            "marks": tuple(zip(places[::2], places[1::2], strict=True)),
            "mark_share": _value(mark_share),
            "margin_mm": _value(margin),
        }
    )


def _april_fields(grid: AprilGrid) -> list[str]:
    return [
        f"{grid.tag_cols}X{grid.tag_rows}",
        _number(grid.tag_mm),
        _number(grid.tag_spacing),
        _dictionary_word(grid.dictionary),
        f"{grid.first_id}.{grid.border_cells}" + ("" if grid.corner_squares else ".0"),
        _number(grid.margin_mm),
    ]


def _april(name: str, fields: Sequence[str]) -> AprilGrid:
    size, tag, spacing, dictionary, print_, margin = _so_many(fields, 6)
    cols, rows = _wholes(size, "X", 2)
    first_id, border, *squares = _wholes(print_, ".", 2 + (print_.count(".") > 1))
    return AprilGrid.model_validate(
        {
            "kind": "aprilgrid",
            "name": name,
            "tag_cols": cols,
            "tag_rows": rows,
            "tag_mm": _value(tag),
            "tag_spacing": _value(spacing),
            "dictionary": _dictionary(dictionary),
            "first_id": first_id,
            "border_cells": border,
            "corner_squares": not squares,
            "margin_mm": _value(margin),
        }
    )


FORMS = {
    form.letter: form
    for form in (
        Form("D", DotGrid, _grid_fields, _grid),
        Form("C", CharucoBoard, _charuco_fields, _charuco),
        Form("K", CodedDots, _coded_fields, _coded),
        Form("B", Chessboard, _chessboard_fields, _chessboard),
        Form("T", AprilGrid, _april_fields, _april),
    )
}
"""The forms by the letter of the kind."""

_W = TypeVar("_W", Layout, Polarity, Pattern, SquareColour)
_LETTERS: dict[Layout | Polarity | Pattern | SquareColour, str] = {
    Layout.SYMMETRIC: "S",
    Layout.ASYMMETRIC: "A",
    Polarity.BLACK_ON_WHITE: "B",
    Polarity.WHITE_ON_BLACK: "W",
    Pattern.CURRENT: "C",
    Pattern.LEGACY: "L",
    SquareColour.BLACK: "B",
    SquareColour.WHITE: "W",
}


def _word(letter: str, words: type[_W]) -> _W:
    """Return the word that a letter stands for."""
    for word in words:
        if _LETTERS[word] == letter:
            return word
    raise InputError(f"It says {clipped(letter)!r} where one of {', '.join(_LETTERS[w] for w in words)} is.")


def _dictionary_word(dictionary: MarkerDictionary) -> str:
    return dictionary.value.removeprefix("DICT_").replace("_", "-").upper()


def _dictionary(word: str) -> MarkerDictionary:
    """Return the set of markers that a word names."""
    known = {_dictionary_word(one): one for one in MarkerDictionary}
    if word not in known:
        raise InputError(f"It names a set of markers {clipped(word)!r}, which OpenCV does not have.")
    return known[word]


def _number(value: float) -> str:
    """Return the shortest digits that give the very same number back."""
    return repr(float(value)).upper().removesuffix(".0").replace("E+", "E")


def _value(text: str) -> float:
    """Return a number without a sign, written out."""
    if not re.fullmatch(r"[0-9]{1,17}(\.[0-9]{1,20})?(E-?[0-9]{1,3})?", text):
        raise InputError(f"It says {clipped(text)!r} where a length is, which has no sign.")
    return float(text)


def _wholes(text: str, between: str, count: int) -> list[int]:
    """Return whole numbers."""
    parts = text.split(between)
    if len(parts) != count or not all(re.fullmatch(r"[0-9]{1,6}", part) for part in parts):
        wanted = "a whole number is" if count == 1 else f"{count} whole numbers are"
        raise InputError(f"It says {clipped(text)!r} where {wanted}.")
    return [int(part) for part in parts]


def _so_many(fields: Sequence[str], count: int) -> Sequence[str]:
    if len(fields) != count:
        raise InputError(f"It has {len(fields)} fields, and its kind has {count}.")
    return fields
