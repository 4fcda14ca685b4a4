"""Corners of tags on drawn pictures whose truth is exact."""

from pathlib import Path
from typing import cast

import numpy as np
import pytest

from labcal.bench.groups import Bench
from labcal.bench.marks.tags import DICTIONARY, tag_findings, tag_picture
from labcal.detect.corners.corner_kernel import WEDGE, pattern_values
from labcal.detect.corners.corner_model import CornerPixels, linearise
from labcal.detect.marks.picture_marks import MarkFlag
from labcal.detect.marks.tags import find_tags, tag_name
from labcal.run.progress import Progress
from labcal.targets.charuco import MarkerDictionary


class Nobody:
    """A progress that nobody watches."""

    def start(self, _what: str, _count: int) -> None:
        """Do nothing."""

    def advance(self) -> None:
        """Do nothing."""


def test_a_dictionary_is_named_as_people_name_it() -> None:
    assert tag_name(MarkerDictionary.DICT_APRILTAG_36H11) == "apriltag-36h11"
    assert tag_name(MarkerDictionary.DICT_ARUCO_ORIGINAL) == "aruco-original"
    assert tag_name(MarkerDictionary.DICT_5X5_100) == "aruco-5x5-100"
    assert len({tag_name(one) for one in MarkerDictionary}) == len(MarkerDictionary)


def test_corners_err_by_less_than_half_of_what_opencvs_do_and_stated_sigmas_hold(tmp_path: Path) -> None:
    bench = Bench(quick=True, seed=1, folder=tmp_path, progress=cast("Progress", Nobody()))
    found = tag_findings(bench)
    assert [check.ok for check in found.checks] == [True, True]
    compared = next(figure for figure in found.references if "compared" in figure.name)
    assert compared.value is not None
    assert compared.value > 150


def test_every_corner_is_near_its_own_place_or_has_a_reason() -> None:
    picture = tag_picture(3, 0)
    marks = find_tags(picture.picture, DICTIONARY)
    assert marks.ok.sum() > 20
    for point, place, flag in zip(marks.point, marks.position, marks.flag, strict=True):
        if flag is MarkFlag.OK:
            assert np.linalg.norm(place - picture.corners[point]) < 0.5
        else:
            assert np.isnan(place).all()


def test_a_corner_at_the_frame_is_cut_and_a_covered_one_is_not_measured() -> None:
    whole = tag_picture(3, 0)
    first = find_tags(whole.picture, DICTIONARY)
    k = int(np.flatnonzero(first.ok)[0])
    covered = whole.picture.copy()
    x, y = np.rint(first.position[k]).astype(int)
    covered[y - 2 : y + 3, x - 2 : x + 3] = 120
    again = find_tags(covered, DICTIONARY)
    assert first.point[k] not in {p for p, ok in zip(again.point, again.ok, strict=True) if ok}


@pytest.mark.parametrize("picture", [np.zeros((0, 0), np.uint8), np.full((60, 80), 7, np.uint8)])
def test_a_picture_of_nothing_holds_no_tags(picture: np.ndarray) -> None:
    assert find_tags(picture, DICTIONARY).point == ()


def test_the_wedge_is_a_blurred_quadrant_with_the_derivatives_of_its_formula() -> None:
    y, x = np.mgrid[-6:7, -6:7].astype(float)
    offset = np.stack([x.ravel(), y.ravel()])
    mask = np.ones(x.shape, bool)
    state = np.array([0.3, -0.2, 0.2, 1.5, 0.9, 1.1, 100.0, 60.0, 0.01, -0.005])
    window = CornerPixels(mask, offset, np.zeros(offset.shape[1]), np.ones(2), WEDGE)
    at = linearise(state, window)
    for k in range(len(state)):
        step = np.zeros(len(state))
        step[k] = 1e-6
        up, down = (linearise(state + sign * step, window).residual for sign in (1, -1))
        np.testing.assert_allclose(at.jacobian[k], (down - up) / 2e-6, atol=2e-5)
    # Square, the edges' blurs are independent: deep inside -1, far outside 1, and a half of it on an edge.
    u = np.array([[5.0, -5.0, 0.0, 0.0], [5.0, 5.0, 5.0, 0.0]])
    np.testing.assert_allclose(pattern_values(u, 0.0, np.ones(2), WEDGE), [-1.0, 1.0, 0.0, 0.5], atol=1e-5)
