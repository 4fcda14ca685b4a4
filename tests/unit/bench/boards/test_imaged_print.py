"""Drawn pictures of prints through a lens: places where the truth says, calibrations by the detector."""

import numpy as np
import pytest

from labcal.bench.boards.imaged_print import DrawnPrint
from labcal.bench.solve.board_set import BOARDS, PAIR, board_poses
from labcal.detect.detector import detect_dots
from labcal.render.sensor_response import Shot
from labcal.rng import generator
from labcal.scene.photometry import Photometry
from labcal.targets.catalogue import load_target


@pytest.mark.parametrize("board", ["chessboard", "marked chessboard"])
def test_drawn_corners_are_measured_where_they_are(board: str) -> None:
    target = load_target(BOARDS[board])
    camera = PAIR.cameras()[1]
    print_, linear = DrawnPrint.of(target), Photometry(format="png", bits=16, tone_curve="linear")
    squares = []
    for number, T in enumerate(board_poses(target, 3, generator(3, "test"))):
        seen = print_.seen(camera, T, linear, Shot(3, f"view-{number}", "right"))
        dots = detect_dots(seen.picture, target)
        assert dots.indexed
        place = dots.index[dots.ok, 1] * target.cols + dots.index[dots.ok, 0]
        off = dots.position[dots.ok] + seen.corner - seen.places[place]
        squares.append(np.einsum("ni,nij,nj->n", off, np.linalg.inv(dots.covariance[dots.ok]), off))
    mean = float(np.concatenate(squares).mean()) / 2.0
    assert mean == pytest.approx(1.0, abs=0.35)  # a wrong place by a tenth of a pixel gives more than 50
