"""Letters, logos and rulers beside a grid of equal dots, drawn a step away from it."""

from collections.abc import Callable

import cv2
import numpy as np
import pytest

from labcal.detect.detector import detect_dots
from labcal.detect.flags import Refusal
from labcal.targets.grid import DotGrid

STEP, RADIUS, FINE = 52.0, 15.0, 4
GRID = DotGrid(
    name="plain", cols=8, rows=6, pitch_x_mm=12, pitch_y_mm=12, dot_diameter_mm=7, rings=None, margin_mm=12
)
SKEW = np.array([[0.97, -0.13], [0.10, 0.92]]) * STEP
BEGIN = np.array([180.0, 120.0])
Draw = Callable[[np.ndarray, np.ndarray, int], None]


def place(col: float, row: float) -> np.ndarray:
    """Return where a node is drawn, px; row 0 at the top."""
    return BEGIN + SKEW @ [col, row]


def picture(cols: int, rows: int, mark: Draw | None = None, nodes: np.ndarray | None = None) -> np.ndarray:
    """Return a grid of dots, with a mark drawn at further nodes."""
    size = (720, 560)
    canvas = np.full((size[1] * FINE, size[0] * FINE), 220, dtype=np.uint8)
    shape = np.round(np.linalg.svd(SKEW)[1] / STEP * RADIUS * FINE * 16).astype(int)
    for col in range(cols):
        for row in range(rows):
            disc(canvas, place(col, row), int(shape.mean()) // 16)
    for number, node in enumerate(np.zeros((0, 2)) if nodes is None else nodes):
        assert mark is not None
        mark(canvas, place(*node), number)
    soft = cv2.GaussianBlur(cv2.resize(canvas, size, interpolation=cv2.INTER_AREA), (0, 0), 0.7)
    return np.clip(soft + np.random.default_rng(3).normal(0, 1.5, soft.shape), 0, 255).astype(np.uint8)


def disc(canvas: np.ndarray, at: np.ndarray, radius: int) -> None:
    middle = (int(((at[0] + 0.5) * FINE - 0.5) * 16), int(((at[1] + 0.5) * FINE - 0.5) * 16))
    cv2.circle(canvas, middle, radius * 16, 30, -1, cv2.LINE_AA, 4)


def letter(canvas: np.ndarray, at: np.ndarray, number: int) -> None:
    x, y = (at * FINE).astype(int)
    cv2.putText(canvas, "OQ8D60CG"[number % 8], (x - 46, y + 46), 0, 5.0, 30, 16, cv2.LINE_AA)


def ring(canvas: np.ndarray, at: np.ndarray, number: int) -> None:  # noqa: ARG001 -- as of letters
    cv2.circle(canvas, tuple((at * FINE).astype(int)), int(RADIUS * FINE), 30, 16, cv2.LINE_AA)


def logo(canvas: np.ndarray, at: np.ndarray, number: int) -> None:  # noqa: ARG001 -- as of letters
    middle = tuple((at * FINE).astype(int))
    cv2.ellipse(canvas, middle, (int(1.4 * RADIUS * FINE), int(0.8 * RADIUS * FINE)), 25, 0, 360, 30, -1)


def tick(canvas: np.ndarray, at: np.ndarray, number: int) -> None:  # noqa: ARG001 -- as of letters
    x, y = (at * FINE).astype(int)
    cv2.line(canvas, (x, y - 50), (x, y + 50), 30, 14, cv2.LINE_AA)


@pytest.mark.parametrize("mark", [letter, ring, logo, tick], ids=["letters", "rings", "logos", "ruler"])
@pytest.mark.parametrize("side", ["below", "above", "left", "right"])
def test_what_is_a_step_beside_the_grid_is_no_line_of_it(mark: Draw, side: str) -> None:
    every = np.arange(8 if side in ("below", "above") else 6, dtype=float)
    beside = {"below": 6.0, "above": -1.0, "left": -1.0, "right": 8.0}[side]
    across = np.full(len(every), beside)
    nodes = np.stack([every, across] if side in ("below", "above") else [across, every], axis=-1)
    nodes = nodes[[2]] if mark is logo else nodes
    dots = detect_dots(picture(8, 6, mark, nodes), GRID)
    assert dots.refusal is None
    assert int(dots.ok.sum()) == 48
    wanted = np.array([place(col, 5 - row) for col, row in dots.index[dots.ok]])
    assert np.abs(dots.position[dots.ok] - wanted).max() < 0.1


@pytest.mark.parametrize(("cols", "rows"), [(9, 6), (8, 7)])
def test_a_line_of_dots_beyond_the_grid_is_told_with_what_was_seen(cols: int, rows: int) -> None:
    dots = detect_dots(picture(cols, rows), GRID)
    assert dots.refusal is Refusal.AMBIGUOUS
    assert dots.why.startswith(f"{cols} columns and {rows} rows of dots were seen between x = ")
    assert "px; the target has 8 and 6." in dots.why


def dot(canvas: np.ndarray, at: np.ndarray, number: int) -> None:  # noqa: ARG001 -- as of letters
    disc(canvas, at, int(np.linalg.svd(SKEW)[1].mean() / STEP * RADIUS * FINE))


BESIDE = [
    np.array([[8.0, 1.0], [8.0, 4.0]]),
    np.array([[-1.0, 0.0], [-1.0, 5.0]]),
    np.array([[2, 6], [3, 6], [6, 6.0]]),
]


@pytest.mark.parametrize("nodes", BESIDE)
def test_discs_a_step_beside_the_grid_on_bare_paper_are_no_line_of_it(nodes: np.ndarray) -> None:
    dots = detect_dots(picture(8, 6, dot, nodes), GRID)
    assert dots.refusal is None
    assert int(dots.ok.sum()) == 48


@pytest.mark.parametrize("grey", [40, 120, 200])
def test_two_dots_beyond_the_grid_still_speak_of_a_larger_print_where_its_line_is_hidden(grey: int) -> None:
    def cover(canvas: np.ndarray, at: np.ndarray, number: int) -> None:  # noqa: ARG001 -- as of letters
        corners = [place(*q) for q in ((7.5, 1.5), (9.3, 1.5), (9.3, 6.5), (7.5, 6.5))]
        cv2.fillPoly(canvas, [np.round(np.array(corners) * FINE).astype(int)], grey)

    dots = detect_dots(picture(9, 6, cover, np.zeros((1, 2))), GRID)
    assert dots.refusal is Refusal.AMBIGUOUS
    assert "dots beyond them" in dots.why
