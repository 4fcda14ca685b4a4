"""Signed distances from the edges of a print, against circles and squares."""

import numpy as np
import pytest

from labcal.targets.catalogue import load_target
from labcal.targets.ink_distance import InkDistance, ink_distance


def places(field: InkDistance) -> tuple[np.ndarray, np.ndarray]:
    y, x = np.mgrid[: field.distance.shape[0], : field.distance.shape[1]] * field.step_mm
    return x + field.origin[0], y + field.origin[1]


def test_a_dot_is_a_circle() -> None:
    target = load_target("coded-8x6")
    field = ink_distance(target)
    x, y = places(field)
    for centre in target.points()[[0, 13, 47], :2]:
        inside = 2.5 - np.hypot(x - centre[0], y - centre[1])
        near = np.abs(inside) < 2.0 * field.step_mm
        assert near.sum() > 200
        assert np.abs(field.distance[near] - inside[near]).max() < 2e-4


def test_squares_and_modules_of_a_charuco_board_are_filled() -> None:
    target = load_target("charuco-12x9")
    field = ink_distance(target)

    def at(q: np.ndarray) -> np.ndarray:
        col, row = np.rint((q - field.origin) / field.step_mm).astype(int).T
        return field.distance[row, col]

    corners = target.points()[:, :2]
    assert np.abs(at(corners)).max() < 1e-6  # places are points of the grid, and on edges
    signs = at(corners + np.array([1.0, 1.0])) * at(corners + np.array([-1.0, 1.0]))
    assert (signs < 0.0).all()  # neighbours of a corner are black and white


@pytest.mark.parametrize("name", ["coded-8x6", "rings-14x10"])
def test_the_inked_area_is_that_of_the_artwork(name: str) -> None:
    target = load_target(name)
    field = ink_distance(target)
    share = np.clip(0.5 + field.distance / field.step_mm, 0.0, 1.0).sum() * field.step_mm**2
    radii = 0.5 * target.outer_diameters_mm()
    discs = np.pi * (radii**2).sum()
    if name == "coded-8x6":  # black sectors of 48 rings from 2 to 3 radii, and numbers beside them
        from labcal.targets.coded_dots import CodedDots  # noqa: PLC0415
        from labcal.targets.ring_codes import code_book  # noqa: PLC0415

        assert isinstance(target, CodedDots)
        book = code_book(target.code)
        black = sum(book.word(int(mark)).mean() for mark in target.marks())
        sectors = black * np.pi * 2.5**2 * (9.0 - 4.0)
        assert share == pytest.approx(discs + sectors, rel=0.03)
        assert share > discs + sectors
    else:
        holes = len(target.ring_indices) * np.pi * (0.5 * target.ring_inner_diameter_mm) ** 2
        assert share == pytest.approx(discs - holes, rel=1e-3)
