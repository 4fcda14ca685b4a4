"""Checks of chessboards, ChArUco boards and AprilGrids on traced pictures, as on drawn ones."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

import numpy as np

from labcal.bench.boards.april_grid_picture import april_grid_picture
from labcal.bench.boards.april_grids import april_grid_outcome
from labcal.bench.boards.board_checks import board_checks
from labcal.bench.boards.board_outcome import BoardOutcome
from labcal.bench.boards.board_view import BoardPicture
from labcal.bench.boards.charuco_picture import charuco_picture
from labcal.bench.boards.charucos import EDGES, charuco_outcome
from labcal.bench.boards.chessboard_picture import chessboard_picture
from labcal.bench.boards.chessboards import WEIGHTED, chessboard_outcome
from labcal.bench.boards.traced_board import SquareBoard, traced_picture
from labcal.bench.groups import Bench, Findings
from labcal.render.sensor_response import Shot
from labcal.report.bench import Check, Figure
from labcal.rng import generator

PICTURES, QUICK_PICTURES = 100, 6
"""Of each board."""
STREAM = "traced"
"""Views of traced pictures are others than those of the drawn ones of the same seed."""


Picture = TypeVar("Picture", bound=BoardPicture[SquareBoard])


@dataclass(frozen=True)
class TracedKind(Generic[Picture]):
    """A kind of board: its views, how their pictures are judged, and what its second bound is."""

    view: Callable[[int, int], Picture]
    outcome: Callable[[Picture, np.random.Generator], BoardOutcome]
    second: str


KINDS: Mapping[str, TracedKind[Any]] = {
    "chessboards": TracedKind(chessboard_picture, chessboard_outcome, WEIGHTED),
    "AprilGrids": TracedKind(april_grid_picture, april_grid_outcome, WEIGHTED),
    "ChArUco boards": TracedKind(charuco_picture, charuco_outcome, EDGES),
}


def traced_board_findings(bench: Bench) -> Findings:
    """Return the checks of every kind of board on traced pictures, with OpenCV's corners beside."""
    count = QUICK_PICTURES if bench.quick else PICTURES
    checks: list[Check] = []
    figures: list[Figure] = []
    bench.progress.start("traced boards", count * len(KINDS))
    for name, kind in KINDS.items():
        outcomes = []
        for number in range(count):
            outcomes.append(traced_outcome(kind, number, bench.seed))
            bench.progress.advance()
        found = board_checks(f"{count} traced pictures of {name}", outcomes, kind.second)
        checks += found.checks
        figures += found.references
    return Findings(checks, figures)


def traced_outcome(kind: TracedKind[Picture], number: int, seed: int) -> BoardOutcome:
    """Trace one picture of a board, detect it, and compare with the truth.

    Parameters
    ----------
    kind : TracedKind
    number : int
        Of the picture.
    seed : int
    """
    view = kind.view(number, seed)
    shot = Shot(seed, f"{type(view.board).__name__}-{number}", STREAM)
    picture = replace(view, picture=traced_picture(view, shot))
    return kind.outcome(picture, generator(seed, "bench boards", STREAM, shot.view))
