"""Data of a case: the oracle at the physical limit, regions, and the same data for every method."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.distortion.case import Case, Cell, Layout, Measured
from labcal.bench.distortion.cell_data import cell_data, lattice
from labcal.bench.families.registry import family_by_name
from labcal.geometry.hull import inside_hull

BOTH = (Measured.WITHIN, Measured.OUTSIDE)


def case_of(family: str, strength: float, layout: Layout = Layout.PLANES) -> Case:
    return Case(Cell(family, strength, 0.1, 140, layout), 5, ("dlt",), BOTH, 400)


@pytest.mark.parametrize(("family", "strength"), [("brown", 0.7), ("wavy-pane", 1.0), ("fisheye", 0.5)])
def test_the_oracle_errs_as_the_cramer_rao_bound_says(family: str, strength: float) -> None:
    """The bound by differences of projected points, with none of the code that triangulates."""
    case = case_of(family, strength)
    tests = cell_data(case).tests[Measured.WITHIN]
    pair = family_by_name(family).pair(strength, case.seed)
    information = np.zeros((len(tests.p), 3, 3))
    for camera in pair:
        moved = [(camera.project(tests.p + h).q, camera.project(tests.p - h).q) for h in 0.01 * np.eye(3)]
        J = np.stack([(ahead - behind) / 0.02 for ahead, behind in moved], axis=-1)
        information += J.transpose(0, 2, 1) @ J / 0.1**2
    bound = np.linalg.inv(information)
    error = tests.oracle - tests.p
    chi_square = np.einsum("ni,nij,nj->n", error, information, error)
    assert abs(chi_square.mean() - 3.0) < 4.0 * np.sqrt(6.0 / len(error))
    shares = (error**2).sum(axis=1) / np.trace(bound, axis1=1, axis2=2)
    spread = np.sqrt(2.0 * (np.linalg.eigvalsh(bound) ** 2).sum(axis=1)) / np.trace(bound, axis1=1, axis2=2)
    assert abs(shares.mean() - 1.0) < 4.0 * np.sqrt((spread**2).sum()) / len(shares)


@pytest.mark.parametrize("layout", Layout)
def test_points_lie_in_their_region_and_both_cameras_see_them(layout: Layout) -> None:
    case = case_of("double-sphere", 1.0, layout)
    data = cell_data(case)
    pair = family_by_name("double-sphere").pair(1.0, case.seed)
    for region, tests in data.tests.items():
        assert len(tests.p) == 400
        assert (inside_hull(tests.p, data.Y, 0.0) == (region is Measured.WITHIN)).all()
        for camera in pair:
            assert camera.in_picture(camera.project(tests.p).q).all()
    assert len(data.X) == len(data.Y) >= 130


def test_data_depend_on_cell_and_seed_and_not_on_methods_or_regions() -> None:
    case = case_of("wavy-pane", 0.5)
    one = cell_data(case)
    other = cell_data(replace(case, methods=("hybrid", "mlp"), regions=(Measured.WITHIN,)))
    assert np.array_equal(one.X, other.X)
    assert np.array_equal(one.tests[Measured.WITHIN].q, other.tests[Measured.WITHIN].q)
    again = cell_data(replace(case, seed=6))
    assert np.array_equal(one.Y, again.Y)
    assert not np.array_equal(one.X, again.X)


def test_grids_have_as_many_dots_as_points_or_a_few_more() -> None:
    assert lattice(520) == (13, 10)
    assert lattice(140) == (7, 5)
    for points in range(16, 600, 7):
        cols, rows = lattice(points)
        assert points <= 4 * cols * rows <= points + 4 * max(rows, 2)


def test_what_no_pinhole_explains_is_nothing_for_a_pinhole() -> None:
    assert cell_data(case_of("brown", 0.0)).beyond_pinhole_px < 1e-9
    assert 1.0 < cell_data(case_of("brown", 1.0)).beyond_pinhole_px < 10.0
