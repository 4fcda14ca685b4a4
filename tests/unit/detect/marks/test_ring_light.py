"""Centres of soft coded dots: neither their own ring nor a slope of the light moves them."""

import numpy as np
import pytest

from labcal.bench.marks.drawn_picture import Exposure, area_centre, drawn, tilted
from labcal.detect.edge_fit import fit_edges
from labcal.detect.grey import grey_picture
from labcal.detect.marks.coded_dots import find_coded_dots
from labcal.detect.marks.round_dots import round_spots, surrounded_reach
from labcal.detect.settings import DEFAULTS
from labcal.targets.coded_dots import RING_INNER, RING_OUTER
from labcal.targets.ring_codes import RingCode, code_book

CODE = RingCode.RING_23
CIRCLE = np.stack([np.cos(np.linspace(0, 2 * np.pi, 720, endpoint=False)),
                   np.sin(np.linspace(0, 2 * np.pi, 720, endpoint=False))], axis=-1)  # fmt: skip


def soft(mark: int, blur: float, gradient: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return a picture of one mark of 9 px radius, nearly without noise, and the true centroid of its dot."""
    word = code_book(CODE).word(mark)

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        rho = np.hypot(x, y)
        sector = np.floor((0.3 - np.arctan2(y, x) / (2 * np.pi)) * len(word)).astype(int) % len(word)
        return np.where((rho < 1.0) | ((rho > RING_INNER) & (rho < RING_OUTER) & word[sector]), 1.0, 0.0)

    H = tilted(np.radians(30.0), 0.4, 0.0, 600.0 / 9.0, 600.0)
    H = np.array([[1.0, 0.0, 64.2], [0.0, 1.0, 59.7], [0.0, 0.0, 1.0]]) @ H
    exposure = Exposure((130, 120), H, blur, np.array(gradient), 1e-3)
    return drawn(exposure, ink, (), np.random.default_rng(mark)), area_centre(exposure.seen(CIRCLE))


@pytest.mark.parametrize("mark", [3, 40, 90])
def test_black_sectors_do_not_pull_a_soft_dot(mark: int) -> None:
    picture, true = soft(mark, 2.6, (0.0, 0.0))
    grey = grey_picture(picture)
    spots = round_spots(grey, DEFAULTS, DEFAULTS.mark.max_texture_share)
    plain = fit_edges(grey, spots, np.zeros(len(spots.centre)), surrounded_reach(DEFAULTS))
    as_it_is = np.nanmin(np.linalg.norm(plain.centre - true, axis=1))
    found = find_coded_dots(picture, CODE)
    (place,) = found.position[found.ok]
    assert np.linalg.norm(place - true) < 0.015
    assert as_it_is > 0.02


def test_a_slope_of_the_light_does_not_move_a_soft_dot() -> None:
    picture, true = soft(57, 2.2, (0.004, -0.003))
    found = find_coded_dots(picture, CODE)
    (place,) = found.position[found.ok]
    assert np.linalg.norm(place - true) < 0.012  # the slope times the variance of the blur is 0.025 px


def test_an_outline_is_as_large_as_printed_however_soft() -> None:
    radii = []
    for blur in (0.6, 2.2):
        picture, _ = soft(57, blur, (0.0, 0.0))
        found = find_coded_dots(picture, CODE)
        radii.append(float(np.linalg.det(found.outline[found.ok][0])) ** 0.25)
    assert radii[0] == pytest.approx(9.0 * np.cos(np.radians(30.0)) ** 0.5, rel=0.01)
    assert radii[1] == pytest.approx(radii[0], rel=0.01)
