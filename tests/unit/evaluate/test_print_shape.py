"""A print of known shape, in figures, in words, as arrows and as a file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labcal.calibrate.adjustment.dot_freedom import Constrained
from labcal.calibrate.freed_dots import FreedDots
from labcal.errors import InputError
from labcal.evaluate.print_shape import agreement, print_shape
from labcal.report.displacement_picture import draw_displacements
from labcal.report.print_words import print_words
from labcal.targets.grid import DotGrid
from labcal.targets.places import DotPlaces, read_places, write_places

SIGMA = 0.001


@pytest.fixture
def freed(grid: DotGrid) -> FreedDots:
    """Stretched by 2000 ppm, sheared by 1 mrad, bowed by 0.3 mm along x, one dot off by (0.005, 0.002) mm."""
    p, count = grid.points(), grid.count
    away = p - p.mean(axis=0)
    p[:, 0] += 1e-3 * away[:, 0] + 1e-3 * away[:, 1]
    p[:, 1] -= 1e-3 * away[:, 1]
    p[:, 2] = -0.3 * (away[:, 0] / away[:, 0].max()) ** 2
    p[7, :2] += [0.005, 0.002]
    free = np.arange(count) != count - 1
    p[~free] = grid.points()[~free]
    covariance = np.zeros((count, 3, count, 3))
    for number in np.flatnonzero(free):
        covariance[number, :, number] = SIGMA**2 * np.eye(3)
    return FreedDots(grid, p, covariance, np.where(free, 9, 2), free, Constrained.NOTHING)


def test_figures(freed: FreedDots, grid: DotGrid) -> None:
    shape = print_shape(freed)
    assert shape.stretch_ppm.value == pytest.approx(2000.0, abs=20.0)  # the dot that is off pulls a little
    assert shape.shear_mrad.value == pytest.approx(1.0, abs=0.01)
    assert shape.bow_x_mm.value == pytest.approx(0.3, abs=1e-9)
    assert shape.bow_y_mm.value == pytest.approx(0.0, abs=1e-9)
    assert shape.twist_mm.value == pytest.approx(0.0, abs=1e-9)
    x, y = (grid.points()[:-1, :2] - grid.points()[:-1, :2].mean(axis=0)).T
    # Variance of a slope: sigma^2 over the sum of squares, which x and y, nearly orthogonal, share out.
    expected = 1e6 * SIGMA * np.sqrt(1.0 / (x @ x) + 1.0 / (y @ y))
    assert shape.stretch_ppm.sigma == pytest.approx(expected, rel=0.05)
    worst = shape.worst[0]
    assert (worst.col, worst.row) == (2, 1)
    assert worst.dx_mm == pytest.approx(0.005, abs=0.001)
    assert worst.dy_mm == pytest.approx(0.002, abs=0.0005)
    assert worst.sigma_mm == pytest.approx((SIGMA, SIGMA, SIGMA))
    assert shape.kept == ((4, 3),)
    assert shape.sigma_in_plane_mm == pytest.approx(SIGMA * np.sqrt(2))
    assert shape.rms_unexplained_mm < shape.rms_in_plane_mm


def test_words(freed: FreedDots) -> None:
    words = print_words(print_shape(freed))
    assert "declared pitch" in words
    assert "bow along x: +0.3000 ± " in words
    assert "bow along y: " in words
    assert "no more than its uncertainty allows" in words
    assert "too few pictures: (4, 3)" in words
    assert "not told" not in words
    held = print_words(print_shape(replace(freed, constrained=Constrained.STRETCH | Constrained.HEIGHTS)))
    assert "stretch, x over y: not determined by these views" in held
    assert "bow along x: not determined by these views" in held
    assert "kept as declared, since the views do not determine them: heights, stretch" in held


def test_agreement(freed: FreedDots) -> None:
    assert agreement([freed, freed]) == pytest.approx((1.0, 1.0))
    opposite = replace(freed, place=2 * freed.target.points() - freed.place)
    assert agreement([freed, opposite]) == pytest.approx((-1.0, -1.0))
    few = replace(freed, freed=freed.freed & (np.arange(len(freed.place)) < 7))
    assert np.isnan(agreement([freed, few])).all()


def test_arrows(freed: FreedDots) -> None:
    picture = draw_displacements(freed)
    assert picture.startswith(b"\x89PNG")
    assert picture == draw_displacements(freed)
    assert picture != draw_displacements(replace(freed, place=freed.target.points()))


def test_the_file_gives_the_places_back(freed: FreedDots, tmp_path: Path) -> None:
    path = tmp_path / "rig-dots.json"
    places = DotPlaces.of(freed.target, freed.place, freed.own_covariance, freed.pictures, freed.freed)
    write_places(path, places)
    found = read_places(path)
    assert found == places
    np.testing.assert_array_equal(found.points(), freed.place)
    assert [dot.freed for dot in found.dots] == freed.freed.tolist()
    assert found.dots[3].cov_yy == SIGMA**2
    path.write_text(path.read_text().replace('"col":1', '"col":2').replace('"col": 1', '"col": 2'))
    with pytest.raises(InputError, match="each once"):
        read_places(path)
