"""Traced pictures of boards: the laboratory stands as the drawn view has it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.boards.april_grid_picture import april_grid_picture
from labcal.bench.boards.board_view import BoardPicture
from labcal.bench.boards.charuco_picture import charuco_picture
from labcal.bench.boards.chessboard_picture import chessboard_picture
from labcal.bench.boards.traced_board import EYE_MM, UNIT_MM, traced_picture, traced_view
from labcal.bench.boards.traced_boards import KINDS, traced_outcome
from labcal.bench.marks.drawn_picture import Cover
from labcal.geometry.poses import transform
from labcal.render.sensor_response import Shot

VIEWS = (chessboard_picture, charuco_picture, april_grid_picture)


@pytest.mark.parametrize("view", VIEWS)
def test_corners_are_where_they_are_drawn(view: Callable[[int, int], BoardPicture]) -> None:
    picture = view(1, 3)
    traced = traced_view(picture)
    places = picture.board.points() * UNIT_MM
    q = traced.camera.camera().project(transform(traced.T_world_target, places)).q
    assert np.allclose(q, picture.corner, rtol=0.0, atol=1e-8)


def test_a_box_hides_what_a_cover_hides() -> None:
    cover = Cover(np.array([200.0, 90.0]), np.array([40.0, 25.0]), 0.4, 0.3)
    picture = replace(chessboard_picture(0, 3), covers=(cover,))
    traced = traced_view(picture)
    (box,) = traced.boxes
    turn = np.radians(box.turn_deg[2])
    R = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    half = 0.5 * np.array(box.size_mm)
    ends = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * half[:2] @ R.T + box.centre_mm[:2]
    front = np.column_stack([ends, np.full(4, box.centre_mm[2] + half[2])])
    assert (front[:, 2] < EYE_MM).all()
    q = traced.camera.camera().project(front).q
    assert np.allclose(cover.distance(q), 0.0, atol=1e-6)
    assert np.allclose(np.linalg.norm(q - cover.middle, axis=1), np.hypot(*cover.half), atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("view", VIEWS)
def test_boards_are_traced_as_they_are_drawn(view: Callable[[int, int], BoardPicture]) -> None:
    picture = view(1, 5)
    traced = traced_picture(picture, Shot(5, "view", "traced"))
    x, y = np.rint(picture.corner[picture.visible]).astype(int).T
    off = [
        (traced[v - 2 : v + 3, u - 2 : u + 3].astype(float) - picture.picture[v - 2 : v + 3, u - 2 : u + 3])
        for u, v in zip(x.tolist(), y.tolist(), strict=True)
    ]
    noise = 255.0 * picture.exposure.noise
    assert abs(float(np.mean(off))) < 0.1 * noise + 0.3
    assert float(np.std(off)) < 1.6 * noise


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_a_traced_board_is_measured(name: str) -> None:
    outcome = traced_outcome(KINDS[name], 0, 3)
    assert outcome.indexed
    assert outcome.wrong == 0
    squares = np.einsum("ni,nij,nj->n", outcome.error, np.linalg.inv(outcome.covariance), outcome.error)
    assert float(squares.mean()) / 2.0 < 3.0
