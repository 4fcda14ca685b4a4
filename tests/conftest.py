"""What several tests use."""

import annotation_checks
import pytest

annotation_checks.check_once()  # before the first import of labcal

from labcal.paper.rows import NOT_REPORTED, ROWS, PaperRow, Solver
from labcal.report.reproduction import Figures, Reproduction, RowResult, ShownPicture
from labcal.report.row_verdict import RowVerdict
from labcal.targets.grid import DotGrid, Rings


def pytest_runtest_setup() -> None:
    """Check the first calls of each function in each test."""
    annotation_checks.begin_test()


@pytest.fixture
def grid() -> DotGrid:
    """A small target with different pitches, so that x and y cannot be exchanged unseen."""
    return DotGrid(
        name="small",
        cols=5,
        rows=4,
        pitch_x_mm=20.0,
        pitch_y_mm=12.5,
        dot_diameter_mm=6.0,
        ring_outer_diameter_mm=8.0,
        ring_inner_diameter_mm=3.0,
        rings=Rings(origin=(1, 0), x=(3, 0), y=(1, 2)),
        margin_mm=10.0,
    )


def made_up_row(row: PaperRow, number: int) -> RowResult:
    """Return figures that might have come out, all different, with the paper's beside them."""
    scale = (3.1 if row.pictured else 0.004) * (number + 1) * (900 if row.noisy else 1)
    if row.solver is Solver.LEAST_SQUARES:
        scale *= 40.0
    readings = []
    names = ("mlp",) if row.solver is Solver.NETWORK else ("affine", "quadratic", "homography")
    for name in (f"{name}, noise 5% of {what}" for name in names for what in ("its spread", "a pixel")):
        signed = scale / 5e3 * (-1) ** number / (len(readings) + 1)
        epochs = None if row.paper_epochs is None else row.paper_epochs * (0.8 + 0.15 * number)
        readings.append(
            Figures(
                reading=name if row.noisy else name.partition(",")[0],
                mean_signed_m=signed,
                rel=signed,
                mae_mm=scale * 0.9,
                rmse_mm=scale,
                p95_mm=scale * 2,
                max_mm=scale * 3.5,
                epochs=epochs,
                goal_reached=None if epochs is None else row.exp not in {"04", "22"},
                seconds=0.37 * (number + 1),
                mean_signed_range_m=(signed - abs(signed) / 2, signed + abs(signed) * 2),
                mae_range_mm=(scale * 0.8, scale),
                rmse_range_mm=(scale * 0.9, scale * 1.2),
                p95_range_mm=(scale * 1.8, scale * 2.4),
                max_range_mm=(scale * 3.0, scale * 4.0),
                epochs_range=None if epochs is None else (epochs * 0.9, epochs * 1.2),
                seconds_range=(0.3 * (number + 1), 0.5 * (number + 1)),
                further_rmse=(1.25,) if row.exp == "23" else (),
            )
        )
    readings = readings if row.noisy else readings[::2]
    chosen = readings[-1].model_dump(exclude={"further_rmse"})
    verdicts = [verdict for verdict in RowVerdict if verdict is not RowVerdict.CONTRADICTION]
    return RowResult(
        exp=row.exp, solver=row.solver, data=row.data, points=row.points,
        network="-".join(map(str, (*row.hidden, 3))) if row.hidden else None,
        goal=row.goal, seeds=5, paper_epochs=row.paper_epochs, paper_abs_m=row.paper_abs_m,
        paper_rel=row.paper_rel, contradiction=row.contradiction, readings=tuple(readings),
        verdict=RowVerdict.CONTRADICTION if row.contradiction else verdicts[(number // 2) % 4], **chosen,
    )  # fmt: skip


@pytest.fixture
def made_up() -> Reproduction:
    """A quick reproduction of all rows with invented figures and one picture."""
    return Reproduction(
        rows=tuple(made_up_row(row, number) for number, row in enumerate(ROWS)),
        not_reported=NOT_REPORTED,
        quick=True,
        restrictions=("pictures are rendered with 16 rays a pixel", "training stops after 300 epochs"),
        pictures=(ShownPicture(scene="webcam-plane", caption="webcam-plane, left", file="shoots/a.png"),),
    )
