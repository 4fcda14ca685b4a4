"""Cameras from boards on one plate: the rig, the boards' places, and how sure they are."""

from dataclasses import replace

import numpy as np
import pytest
from plate import PLATE, SIGMA_PX, T_A_B, Sees, board, cameras, in_turn, never_shared, plate_poses, seen
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from labcal.calibrate.calibrated import calibrated
from labcal.calibrate.calibration import Calibration
from labcal.calibrate.eccentricity import Discs, dot_eccentricities
from labcal.calibrate.handheld import HandheldSettings
from labcal.correspond.boards_table import on_target
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, inverse
from labcal.targets.board_set import BoardPlace, BoardSet, Mounting
from labcal.targets.catalogue import target_of
from labcal.targets.grid import DotGrid, Rings


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


DOTS = DotGrid(
    name="b", cols=8, rows=6, pitch_x_mm=16.0, pitch_y_mm=16.0, dot_diameter_mm=11.0,
    ring_outer_diameter_mm=11.0, ring_inner_diameter_mm=5.0, margin_mm=12.0,
    rings=Rings(origin=(1, 1), x=(6, 1), y=(1, 4)),
)  # fmt: skip
ROUND = BoardSet(name="plate", targets=(board("a", 0), DOTS))
FINE_PX = 0.004


def test_dots_on_a_tilted_board_have_their_own_eccentricity() -> None:
    rng = np.random.default_rng(11)
    table = seen(plate_poses(rng, 12), in_turn, rng, ROUND, FINE_PX)
    found = calibrated(on_target(table, ROUND), ROUND, "brown-k1k2")
    assert found.found.eccentricity.max > 10 * FINE_PX
    assert found.found.rms_px < 1.6 * FINE_PX
    assert max(squares_off(found)) < 9.0
    assert not any("tilted" in warning for warning in found.warnings)


def test_a_tilted_disc_is_imaged_as_by_its_own_board() -> None:
    rng = np.random.default_rng(12)
    (T_world_set,) = plate_poses(rng, 1)
    placed = ROUND.placed(np.stack([np.eye(4), T_A_B]))
    camera, dots = cameras()["left"], np.arange(DOTS.count)
    by_set = dot_eccentricities(camera, T_world_set, Discs.of(placed), ROUND.spans[1].start + dots)
    by_board = dot_eccentricities(camera, T_world_set @ T_A_B, Discs.of(DOTS), dots)
    assert np.abs(by_set - by_board).max() < 1e-9
    assert np.abs(by_board).max() > 0.01


@pytest.mark.parametrize("lens", ["auto", None])
def test_views_of_single_boards_choose_the_lens(lens: str | None) -> None:
    rng = np.random.default_rng(13)
    table = on_target(seen(plate_poses(rng, 12), never_shared, rng), PLATE)
    found = calibrated(table, PLATE, lens)
    assert found.choice is not None
    assert found.lens == found.choice.lens == ("brown5" if lens is None else "brown-k1k2")
    assert bool(found.choice.trials) == (lens == "auto")
    assert found.found.boards is not None
    assert found.found.views[0] == "v00"


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
