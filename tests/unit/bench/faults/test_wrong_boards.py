"""Wrong boards: exact cameras, asked where the dots are, find them where the fault puts them."""

import numpy as np
import pytest

from labcal.bench.families.registry import family_by_name
from labcal.bench.families.volume import TABLE
from labcal.bench.faults.planned_planes import PlannedPlanes
from labcal.bench.faults.registry import FAULT_KINDS, fault_named
from labcal.cameras.triangulation import triangulate
from labcal.errors import InputError
from labcal.scene.board import Bend, Board
from labcal.scene.print import TruePrint
from labcal.targets.grid import DotGrid

COLS, ROWS, SEED = 13, 10, 4
TOLD = TABLE.planes(COLS, ROWS)
PAIR = family_by_name("brown").pair(0.6, SEED)
PLANES = PlannedPlanes.of(TOLD, PAIR, SEED)
BOARD = DotGrid(
    name="board",
    cols=COLS,
    rows=ROWS,
    pitch_x_mm=700.0 / (COLS - 1),
    pitch_y_mm=700.0 / (ROWS - 1),
    dot_diameter_mm=10.0,
    rings=None,
)


def found(name: str) -> np.ndarray:
    """Return the places at which exact cameras see the dots, relative to the told ones, (planes, dots, 3)."""
    fault = fault_named(name)
    q = fault.kind.images(PLANES, fault.size)
    weights = np.tile(np.eye(2), (len(q), 2, 1, 1))
    return np.asarray((triangulate(PAIR, q, weights).point - TOLD).reshape(4, -1, 3))


def of_print(board: Board) -> np.ndarray:
    """Return what the laboratory makes of a print, relative to the design, (dots, 3)."""
    target = BOARD if board.misplacement_mm == 0.0 else BOARD.model_copy(update={"margin_mm": 20.0})
    return np.asarray(TruePrint.of(target, board, SEED).centres - BOARD.points())


def test_without_a_fault_the_plan_is_as_told() -> None:
    q = PLANES.images(PLANES.dots, PLANES.takes)
    for number, camera in enumerate(PAIR):
        assert np.abs(q[:, number] - camera.project(TOLD).q).max() < 1e-9


def test_a_pitch_scales_each_plane_from_dot_0_0_and_leaves_the_heights() -> None:
    off = found("pitch-0.01")
    expected = 0.01 * (TOLD - TOLD.min(axis=0)) * [1.0, 1.0, 0.0]
    assert np.abs(off.reshape(-1, 3) - expected).max() < 1e-6
    assert np.abs(found("wrong-pitch-0.5") - found("pitch-0.015")).max() < 1e-9


@pytest.mark.parametrize(
    ("name", "board"),
    [
        ("bend-2.5", Board(bend=Bend(along_x_mm=2.5))),
        ("misprint-0.3", Board(misplacement_mm=0.3)),
    ],
)
def test_a_board_is_as_wrong_as_the_laboratory_would_print_it_on_every_plane(name: str, board: Board) -> None:
    off = found(name)
    assert np.abs(off - of_print(board)).max() < 1e-6
    assert np.abs(off).max() > 0.3


def test_a_misprint_has_its_standard_deviation() -> None:
    off = found("misprint-0.3")[0, :, :2] / 0.3
    n = off.size
    assert abs((off**2).sum() - n) < 4.0 * np.sqrt(2.0 * n)


def test_a_misread_stage_moves_every_view_as_a_whole() -> None:
    off = found("stage-2")
    assert np.ptp(off, axis=1).max() < 1e-6
    views = off[:, 0]
    assert len(np.unique(views.round(6), axis=0)) == 4
    assert (views != 0.0).all()
    assert abs((views**2).sum() / 4.0 - 12.0) < 4.0 * np.sqrt(24.0)


def test_the_error_grows_with_the_size_and_nothing_else_changes() -> None:
    for kind in ("bend", "misprint", "stage"):
        assert np.abs(found(f"{kind}-2") - 10.0 * found(f"{kind}-0.2")).max() < 1e-5


def test_names_have_sizes_that_may_be_left_out() -> None:
    assert fault_named("misprint-1e-2").size == 0.01
    assert fault_named("pitch").name == "pitch-0.001"
    assert fault_named("swapped-cameras").name == "swapped-cameras-1"
    assert fault_named("swapped-cameras-0.5").size == 0.5
    for name in FAULT_KINDS:
        assert fault_named(fault_named(name).name) == fault_named(name)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("pich-0.01", "Did you mean 'pitch'"),
        ("camera-nocked", "Did you mean 'camera-knocked'"),
        ("bend-big", "Did you mean 'bend'"),
        ("pitch-0", "should be a number above 0 and at most 0.5, as in pitch-0.001"),
        ("pitch--0.1", "is '-0.1', but"),
        ("bend-1.2.3", "is '1.2.3', but"),
        ("misprint-1e999", "at most 100"),
        ("board-turned-2", "'board-turned' has no size"),
        ("swapped-cameras-2", "at most 1"),
    ],
)
def test_what_is_no_fault_is_refused(name: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        fault_named(name)
