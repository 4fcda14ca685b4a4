"""Drawn pictures of prints through a lens: places where the truth says, calibrations by the detector."""

import numpy as np
import pytest

from labcal.bench.boards.imaged_print import DrawnPrint
from labcal.bench.solve.board_poses import BOARDS, PAIR, board_poses
from labcal.detect.detector import detect_dots
from labcal.geometry.poses import transform
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


def test_a_lens_blurs_before_the_sensor_takes_its_samples() -> None:
    # Sampled sharp and blurred then, these corners are off by 0.008 px.
    target, camera = load_target(BOARDS["chessboard"]), PAIR.cameras()[0]
    sensor = Photometry(
        format="png", bits=16, adc_bits=16, tone_curve="linear", full_well_e=1e9, read_noise_e=0.0
    )
    T = board_poses(target, 1, generator(4, "test"))[0]
    seen = DrawnPrint.of(target).seen(camera, T, sensor, Shot(4, "view", "left"))
    dots = detect_dots(seen.picture, target)
    assert dots.indexed
    off = dots.position[dots.ok] + seen.corner - seen.places[dots.index[dots.ok] @ [1, target.cols]]
    assert float(np.sqrt((off**2).sum(axis=1).mean())) < 0.002


def test_all_corners_of_a_noise_free_picture_are_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    # Drawn coarsely, residuals are 0.0003 to 0.0006 of the step by where edges run: nothing lies in squares.
    monkeypatch.setattr("labcal.bench.boards.imaged_print._FINER", 4)
    target, camera = load_target(BOARDS["chessboard"]), PAIR.cameras()[0]
    sensor = Photometry(
        format="png", bits=16, adc_bits=16, tone_curve="linear", full_well_e=1e9, read_noise_e=0.0
    )
    T = board_poses(target, 3, generator(0, "x"))[0]
    seen = DrawnPrint.of(target).seen(camera, T, sensor, Shot(1, "view", "left"))
    assert detect_dots(seen.picture, target).ok.all()


def test_places_of_dots_are_their_centroids() -> None:
    target, camera = load_target(BOARDS["dots"]), PAIR.cameras()[1]
    T = board_poses(target, 1, generator(5, "test"))[0]
    seen = DrawnPrint.of(target).seen(camera, T, Photometry(format="png"), Shot(5, "view", "right"))
    centre = camera.project(transform(T, target.points())).q
    off = np.linalg.norm(seen.places - centre, axis=1)
    assert 1e-3 < float(off.max()) < 0.2
