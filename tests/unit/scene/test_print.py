import numpy as np
import pytest

from labcal.cameras.dot_image import flat_outlines
from labcal.errors import InputError
from labcal.scene.board import Bend, Board
from labcal.scene.print import TruePrint
from labcal.targets.grid import DotGrid


def test_a_print_without_defects_is_the_design(grid: DotGrid) -> None:
    made = TruePrint.of(grid, Board(), 3)
    np.testing.assert_allclose(made.centres, grid.points(), rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        made.outlines, flat_outlines(grid.points(), 0.5 * grid.outer_diameters_mm()), rtol=0, atol=1e-12
    )
    assert not made.is_displaced


def test_scale_and_shear_are_about_the_middle_and_dots_grow_with_them(grid: DotGrid) -> None:
    made = TruePrint.of(grid, Board(print_scale=(1.02, 0.97), print_shear=0.03), 3)
    x, y, _ = (grid.points() - grid.points().mean(axis=0)).T
    expected = np.stack([1.02 * x + 0.03 * y, 0.97 * y, 0.0 * x], axis=-1) + grid.points().mean(axis=0)
    np.testing.assert_allclose(made.centres, expected, atol=1e-12)
    extent = np.ptp(made.outlines, axis=1)
    radius = 0.5 * grid.outer_diameters_mm()
    np.testing.assert_allclose(extent[:, 1], 2 * 0.97 * radius, rtol=1e-12)
    np.testing.assert_allclose(extent[:, 0], 2 * np.hypot(1.02, 0.03) * radius, rtol=2e-3)


def test_a_bend_lifts_the_print_and_leaves_x_and_y(grid: DotGrid) -> None:
    made = TruePrint.of(grid, Board(bend=Bend(along_x_mm=3.0, along_y_mm=-1.0, twist_mm=2.0)), 3)
    np.testing.assert_allclose(made.centres[:, :2], grid.points()[:, :2], atol=1e-12)
    x_min, y_min, x_max, y_max = grid.extent_mm
    a = (2 * grid.points()[:, 0] - x_min - x_max) / (x_max - x_min)
    b = (2 * grid.points()[:, 1] - y_min - y_max) / (y_max - y_min)
    np.testing.assert_allclose(made.centres[:, 2], 3 * a**2 - b**2 + 2 * a * b, atol=1e-12)


def test_displacements_have_their_deviation_and_belong_to_the_seed() -> None:
    target = DotGrid.model_validate(
        {
            "name": "many", "cols": 60, "rows": 50, "pitch_x_mm": 20.0, "pitch_y_mm": 20.0,
            "dot_diameter_mm": 6.0, "ring_outer_diameter_mm": 6.0, "ring_inner_diameter_mm": 3.0,
            "rings": {"origin": (2, 2), "x": (7, 2), "y": (2, 5)}, "margin_mm": 10.0,
        }
    )  # fmt: skip
    board = Board(misplacement_mm=0.3)
    made, again, other = (TruePrint.of(target, board, seed) for seed in (5, 5, 6))
    off = (made.centres - target.points())[:, :2]
    n = off.size
    z_mean = off.mean() / (0.3 / np.sqrt(n))
    z_square = ((off**2).sum() / 0.3**2 - n) / np.sqrt(2 * n)
    z_mixed = (off[:, 0] * off[:, 1]).sum() / 0.3**2 / np.sqrt(n / 2)
    assert max(abs(z_mean), abs(z_square), abs(z_mixed)) < 4
    np.testing.assert_array_equal(made.centres, again.centres)
    assert not np.array_equal(made.centres, other.centres)
    # A dot moves as a whole.
    moved = made.outlines - flat_outlines(target.points(), 0.5 * target.outer_diameters_mm())
    np.testing.assert_allclose(
        moved[..., :2], np.broadcast_to(off[:, None], (*moved.shape[:2], 2)), atol=1e-9
    )


def test_half_the_displacement_is_the_same_print_less_wrong(grid: DotGrid) -> None:
    much, half = (TruePrint.of(grid, Board(misplacement_mm=size), 5).centres for size in (0.4, 0.2))
    np.testing.assert_allclose(much - grid.points(), 2 * (half - grid.points()), atol=1e-12)


def test_offsets_as_the_design_sees_them_lead_to_the_true_place(grid: DotGrid) -> None:
    made = TruePrint.of(grid, Board(print_scale=(1.1, 0.9), print_shear=0.1, misplacement_mm=0.3), 5)
    there = grid.points()[:, :2] + made.dot_offsets() - made.surface.middle
    np.testing.assert_allclose(made.centres[:, :2], there @ made.A.T + made.surface.middle, atol=1e-12)


@pytest.mark.parametrize(
    ("board", "what"),
    [
        (Board(misplacement_mm=5.0), "half a pitch off"),
        (Board(print_scale=(1.2, 1.0)), "does not fit on its board"),
        (Board(print_shear=0.5), "does not fit on its board"),
    ],
)
def test_what_cannot_be_printed_is_refused(grid: DotGrid, board: Board, what: str) -> None:
    with pytest.raises(InputError, match=what):
        TruePrint.of(grid, board, 0)


def test_a_target_whose_edge_cuts_its_dots_can_still_be_printed(grid: DotGrid) -> None:
    cut = grid.model_copy(update={"margin_mm": 0.0})
    assert TruePrint.of(cut, Board(), 0).target is cut


def test_the_papers_unevenness_has_its_deviation(grid: DotGrid) -> None:
    assert len(TruePrint.of(grid, Board(), 0).waves) == 0
    spread = []
    for seed in range(20):
        made = TruePrint.of(grid, Board(unevenness=0.04), seed)
        x, y = np.random.default_rng(seed).uniform(0.0, 1.0, (2, 4000)) * 2e4  # over many wavelengths
        along_x, along_y, phase = made.waves.T[..., None]
        spread.append((made.amplitude * np.cos(along_x * x + along_y * y + phase)).sum(axis=0).std())
    assert np.mean(spread) == pytest.approx(0.04, rel=0.03)
