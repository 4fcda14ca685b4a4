"""Dots that blur makes run into each other, or that are hardly wider than their edge."""

from functools import cache

import numpy as np
import pytest

from labcal.bench.marks.drawn_picture import Exposure, drawn, tilted
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.settings import DetectSettings
from labcal.targets.grid import DotGrid

PLAIN = {"name": "dense", "cols": 9, "rows": 7, "pitch_x_mm": 15.0, "pitch_y_mm": 15.0, "rings": None}


def grid(diameter: float) -> DotGrid:
    return DotGrid(**PLAIN, dot_diameter_mm=diameter, margin_mm=15.0)  # type: ignore[arg-type]


def exposure(target: DotGrid, blur_radii: float) -> Exposure:
    """Return a camera right above the middle of a grid, 1.5 px a millimetre."""
    H = tilted(0.0, 0.0, 0.1, 400.0 / 1.5, 400.0)
    x, y = target.points()[:, :2].mean(axis=0)
    H = (
        np.array([[1.0, 0, 129.3], [0, 1.0, 104.8], [0, 0, 1.0]])
        @ H
        @ np.array([[1, 0, -x], [0, 1, -y], [0, 0, 1]])
    )
    return Exposure((260, 210), H, 0.75 * blur_radii * target.dot_diameter_mm, np.zeros(2), 0.01)


@cache
def picture(diameter: float, blur_radii: float) -> np.ndarray:
    target = grid(diameter)
    places = target.points()[:, :2]

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        i, j = (np.clip(np.round(a / 15.0), 0, n) for a, n in ((x, 8), (y, 6)))
        return np.asarray(np.hypot(x - 15.0 * i, y - 15.0 * j) < diameter / 2, dtype=float)

    assert np.allclose(ink(*places.T), 1.0)
    return drawn(exposure(target, blur_radii), ink, (), np.random.default_rng(4))


def squares(dots: PictureDots, target: DotGrid, blur_radii: float) -> tuple[float, float]:
    """Return the mean normalised squares, a coordinate, of outermost dots and of the others."""
    how = exposure(target, blur_radii)
    seen = how.seen(target.points()[:, :2])
    at = dots.position[dots.ok]
    nearest = np.argmin(((at[:, None] - seen) ** 2).sum(axis=-1), axis=1)
    off, inverse = at - seen[nearest], np.linalg.inv(dots.covariance[dots.ok])
    each = np.einsum("ni,nij,nj->n", off, inverse, off) / 2
    col, row = nearest % 9, nearest // 9
    outer = (col % 8 == 0) | (row % 6 == 0)
    return float(each[outer].mean()), float(each[~outer].mean())


@pytest.mark.parametrize(("diameter", "blur_radii"), [(10.5, 0.3), (10.5, 0.4)])
def test_outermost_dots_are_not_drawn_towards_their_neighbours(diameter: float, blur_radii: float) -> None:
    target = grid(diameter)
    dots = detect_dots(picture(diameter, blur_radii), target)
    assert dots.ok.sum() == target.count
    outer, inner = squares(dots, target, blur_radii)
    assert outer < 1.7
    assert inner < 1.7
    alone = DetectSettings(edge={"neighbour_rounds": 0})  # type: ignore[arg-type]
    assert squares(detect_dots(picture(diameter, blur_radii), target, alone), target, blur_radii)[0] > 2.0


def test_dots_hardly_wider_than_their_edges_are_blurred() -> None:
    target = grid(8.0)
    dots = detect_dots(picture(8.0, 0.55), target)
    assert dots.refusal is Refusal.NO_USABLE_DOTS
    assert list(dots.flag).count(DotFlag.BLURRED) == target.count
