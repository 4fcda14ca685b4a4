"""Cameras from boards on one plate: the rig, the boards' places, and how sure they are."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from labcal.calibrate.calibration import Calibration, calibrated
from labcal.calibrate.handheld import HandheldSettings
from labcal.cameras.camera import Camera
from labcal.correspond.boards_table import on_target
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, inverse, transform
from labcal.targets.board_set import BoardPlace, BoardSet, Mounting
from labcal.targets.catalogue import target_of

SIGMA_PX = 0.05
T_A_B = from_rotation_vector(np.array([0.05, -0.3, 0.1]), np.array([175.0, 12.0, 20.0]))
Sees = Callable[[int, str, str], bool]
"""Whether a board is seen in a view by a camera."""


def board(name: str, first_id: int) -> dict[str, object]:
    return {
        "kind": "charuco",
        "name": name,
        "squares": (7, 5),
        "square_mm": 20.0,
        "marker_mm": 15.0,
        "dictionary": "DICT_4X4_100",
        "first_id": first_id,
    }


PLATE = BoardSet(name="plate", targets=(board("a", 0), board("b", 40)))


def cameras() -> dict[str, Camera]:
    K = np.array([[700.0, 0.0, 322.4], [0.0, 704.0, 237.1], [0.0, 0.0, 1.0]])
    T = from_rotation_vector(np.array([0.02, 0.2, -0.03]), np.array([-160.0, 6.0, 25.0]))
    return {
        "left": Camera(K, "brown-k1k2", np.array([-0.2, 0.05, 0.0, 0.0, 0.0]), np.eye(4), (640, 480)),
        "right": Camera(K, "brown-k1k2", np.array([-0.18, 0.04, 0.0, 0.0, 0.0]), T, (640, 480)),
    }


def plate_poses(rng: np.random.Generator, views: int) -> list[np.ndarray]:
    """Return ``T_world_set`` of views in which the plate is tilted every way."""
    found = []
    for number in range(views):
        azimuth = 2 * np.pi * number / views + rng.uniform(0, 0.5)
        tilt = 0.5 * np.array([np.cos(azimuth), np.sin(azimuth), 0.5 * rng.normal()])
        R = np.diag([1.0, -1.0, -1.0]) @ Rotation.from_rotvec(tilt).as_matrix()
        middle = rng.uniform([-20, -25, 480], [90, 25, 600])
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, middle - R @ np.array([140.0, 40.0, 5.0])
        found.append(T)
    return found


def seen(poses: list[np.ndarray], sees: Sees, rng: np.random.Generator) -> Detections:
    """Return what a perfect detector measures, with noise; each board by its own name and indices."""
    parts = []
    for view, T_world_set in enumerate(poses):
        for name, camera in cameras().items():
            for one, T_set_board in zip(PLATE.targets, (np.eye(4), T_A_B), strict=True):
                if not sees(view, name, one.name):
                    continue
                q = camera.project(transform(T_world_set @ T_set_board, one.points())).q
                q = q + SIGMA_PX * rng.standard_normal(q.shape)
                mine = np.flatnonzero(camera.in_picture(q))
                n = len(mine)
                parts.append(
                    Detections(
                        view=np.full(n, f"v{view:02d}"),
                        camera=np.full(n, name),
                        image=np.full(n, f"v{view:02d}_{name}.png"),
                        size=np.tile(camera.size, (n, 1)),
                        index=one.indices()[mine],
                        has_id=np.full(n, fill_value=True),
                        position=q[mine],
                        covariance=np.tile(SIGMA_PX**2 * np.eye(2), (n, 1, 1)),
                        flag=np.full(n, "ok"),
                        board=np.full(n, one.name),
                    )
                )
    names = list(parts[0].__dataclass_fields__)
    return Detections(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def in_turn(view: int, camera: str, board_name: str) -> bool:
    """Camera 1 sees board A alone and camera 2 board B alone, but in every third view both see both."""
    return view % 3 == 0 or (camera == "left") == (board_name == "a")


def never_shared(_view: int, camera: str, board_name: str) -> bool:
    """Each camera sees a board of its own, always."""
    return (camera == "left") == (board_name == "a")


def made(seed: int, sees: Sees = in_turn, target: BoardSet = PLATE, views: int = 12) -> Calibration:
    rng = np.random.default_rng(seed)
    table = seen(plate_poses(rng, views), sees, rng)
    return calibrated(on_target(table, target), target, "brown-k1k2")


def squares_off(found: Calibration) -> tuple[float, float]:
    """Return the squared distance from the truth in sigmas, of the right camera's pose and of board B's."""
    placed = found.found.boards
    assert placed is not None
    assert placed.places is not None
    place = placed.places[1]
    error = place.T @ inverse(T_A_B)
    turn = Rotation.from_matrix(error[:3, :3]).as_rotvec() / np.array(place.sigma_rotation_rad)
    shift = (place.T - T_A_B)[:3, 3] / np.array(place.sigma_mm)
    right = found.rig.camera("right").T_cam_world
    truth = cameras()["right"].T_cam_world
    of = found.found.fits["right"].sigma
    angles = Rotation.from_matrix(right[:3, :3] @ truth[:3, :3].T).as_rotvec() / of.rotation_rad
    moved = (right - truth)[:3, 3] / of.translation_mm
    return float((angles**2).mean() + (moved**2).mean()) / 2, float((turn**2).mean() + (shift**2).mean()) / 2


def test_cameras_that_see_different_boards_are_calibrated_together() -> None:
    found = made(1)
    assert found.warnings == ()
    assert found.found.rms_px < 1.6 * SIGMA_PX
    assert max(squares_off(found)) < 9.0
    assert found.rig.target is not None
    assert found.rig.target.root["places"][1]["sigma_mm"] is not None  # type: ignore[call-overload,index]


@pytest.mark.slow
def test_the_standard_deviations_are_those_of_the_errors() -> None:
    off = np.array([squares_off(made(seed)) for seed in range(40)])
    # Six squares each, correlated with one another: two degrees of freedom a calibration are left at least.
    low, high = chi2.ppf([1e-3, 1 - 1e-3], 2 * len(off)) / (2 * len(off))
    assert (off.mean(axis=0) > low).all()
    assert (off.mean(axis=0) < high).all()


def test_boards_that_no_picture_links_are_placed_by_the_motion_of_the_plate() -> None:
    found = made(2, never_shared)
    assert found.found.rms_px < 1.6 * SIGMA_PX
    assert max(squares_off(found)) < 9.0


def test_boards_that_nothing_links_are_refused() -> None:
    rng = np.random.default_rng(3)
    poses = plate_poses(rng, 6)
    table = seen(
        poses * 2,
        lambda view, camera, name: never_shared(view, camera, name) and (view < 6) == (name == "a"),
        rng,
    )
    with pytest.raises(InputError, match="do not link camera 'right', board 'b'"):
        calibrated(on_target(table, PLATE), PLATE, "brown-k1k2")


def test_stated_places_are_kept() -> None:
    places = (BoardPlace(T_set_board=np.eye(4).tolist()), BoardPlace(T_set_board=T_A_B.tolist()))
    known = PLATE.model_copy(update={"places": places})
    found = made(4, never_shared, known)
    assert found.found.boards == known
    right = found.rig.camera("right").T_cam_world
    of = found.found.fits["right"].sigma
    off = (right - cameras()["right"].T_cam_world)[:3, 3] / of.translation_mm
    assert np.abs(off).max() < 3.5


def test_boards_that_moved_are_told() -> None:
    rng = np.random.default_rng(5)
    poses = plate_poses(rng, 12)
    table = seen(poses, lambda *_: True, rng)
    shaken = [T @ from_rotation_vector(rng.normal(0, 0.02, 3), rng.normal(0, 2.0, 3)) for T in poses]
    others = seen(shaken, lambda *_: True, rng)
    both = [table.where(table.board == "a"), others.where(others.board == "b")]
    names = list(table.__dataclass_fields__)
    moved = Detections(*(np.concatenate([getattr(part, name) for part in both]) for name in names))
    found = calibrated(on_target(moved, PLATE), PLATE, "brown-k1k2")
    assert any("the boards moved relative to each other" in warning for warning in found.warnings)
    separate = PLATE.model_copy(update={"mounting": Mounting.SEPARATE})
    found = calibrated(on_target(moved, separate), separate, "brown-k1k2")
    assert found.found.rms_px < 1.6 * SIGMA_PX
    assert found.found.views[:2] == ("v00-a", "v01-a")


def test_one_camera_finds_the_boards_places() -> None:
    rng = np.random.default_rng(6)
    table = seen(plate_poses(rng, 10), lambda _view, camera, _name: camera == "left", rng)
    found = calibrated(on_target(table, PLATE), PLATE, "brown-k1k2")
    assert found.found.boards is not None
    assert found.found.boards.places is not None
    shift = found.found.boards.places[1].T[:3, 3] - T_A_B[:3, 3]
    assert (np.abs(shift) < 3.5 * np.array(found.found.boards.places[1].sigma_mm)).all()


def test_dots_of_several_boards_are_not_freed() -> None:
    rng = np.random.default_rng(7)
    table = on_target(seen(plate_poses(rng, 6), in_turn, rng), PLATE)
    with pytest.raises(InputError, match="cannot be freed"):
        calibrated(table, PLATE, "brown-k1k2", HandheldSettings(dot_places="freed"))


def test_a_table_of_boards_needs_the_boards() -> None:
    rng = np.random.default_rng(8)
    table = seen(plate_poses(rng, 3), in_turn, rng)
    one = on_target(table, PLATE.targets[0])
    assert not one.boards
    assert len(one) == (table.board == "a").sum()
    with pytest.raises(InputError, match="holds dots of boards by name"):
        table.measured()
    with pytest.raises(InputError, match="does not state the boards"):
        on_target(one, PLATE)
    other = target_of(PLATE.targets[0]).model_copy(update={"name": "c"})  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="none of 'c'"):
        on_target(table, other)
    foreign = replace(table, board=np.where(table.board == "b", "c", table.board))
    with pytest.raises(InputError, match="board 'c'"):
        on_target(foreign, PLATE)
