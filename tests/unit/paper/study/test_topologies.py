"""The networks of the study, their data, and their medians."""

from pathlib import Path

import numpy as np
import pytest

from labcal.estimators.registry import make_estimator
from labcal.paper.rows import row_named
from labcal.paper.simulated import NoiseReading, simulate
from labcal.paper.study.cells import parameters, studied, study_cells
from labcal.paper.study.topologies import (
    NEURONS,
    STUDIED_ROWS,
    StudyRun,
    shared_equally,
    study_runs,
    topologies,
    train_topology,
)
from labcal.paper.training_run import TrainingOutcome
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress


def test_neurons_are_shared_equally_and_none_is_lost() -> None:
    assert shared_equally(20, 3) == (7, 7, 6)
    assert shared_equally(5, 2) == (3, 2)
    networks = topologies()
    assert networks[0] == ()
    assert len(networks) == len(set(networks)) == 1 + 3 * len(NEURONS)
    assert {sum(hidden) for hidden in networks} == {0, *NEURONS}


def test_networks_of_one_seed_see_the_same_points() -> None:
    rows = [run.row for run in study_runs(range(1), 100) if run.exp == "13"]
    first, *others = [simulate(row, NoiseReading.NONE, 3) for row in rows[:3]]
    assert all(np.array_equal(first.X, other.X) for other in others)
    assert np.array_equal(first.X, simulate(row_named("13"), NoiseReading.NONE, 3).X)


def test_runs_have_names_of_their_own_and_stop_early() -> None:
    runs = study_runs(range(2), 5000)
    assert len({run.key for run in runs}) == len(runs)
    assert {run.max_epochs for run in runs} == {500}
    assert {run.max_epochs for run in study_runs(range(1), 7)} == {7}


@pytest.mark.parametrize("hidden", [(), (20, 30), (14, 13, 13)])
def test_the_number_of_weights_is_that_of_the_network(hidden: tuple[int, ...]) -> None:
    rng = np.random.default_rng(0)
    network = make_estimator("mlp").set_params(hidden=hidden, max_epochs=1)
    network.fit(rng.uniform(size=(12, 4)), rng.uniform(size=(12, 3)))
    assert network.parameters_.shape == (1, parameters(hidden))


def test_a_hidden_layer_is_needed_on_a_plane() -> None:
    linear, small = (train_topology(StudyRun("01", hidden, 0, 50)) for hidden in ((), (10,)))
    assert not linear.goal_reached
    assert small.goal_reached
    assert small.rmse_mm < linear.rmse_mm / 10


def test_medians_over_the_seeds_of_each_network() -> None:
    runs = [StudyRun("03", hidden, seed, 9) for hidden in ((5,), (3, 2)) for seed in range(3)]
    outcomes = [
        TrainingOutcome(
            mean_signed_mm=0.0, mean_coordinate_mm=1.0, mae_mm=1.0, rmse_mm=rmse, p95_mm=1.0, max_mm=1.0,
            further_rmse=(), epochs=9, goal_reached=reached, seconds=1.0,
        )
        for rmse, reached in ((1.0, True), (5.0, False), (2.0, True), *((r, False) for r in (7.0, 8.0, 9.0)))
    ]  # fmt: skip
    one, two = study_cells(runs, outcomes)
    assert (one.network, one.layers, one.neurons, one.rmse_mm, one.rmse_range_mm) == (
        "5-3",
        1,
        5,
        2.0,
        (1, 5),
    )
    assert (two.network, two.layers, two.rmse_mm, two.reached) == ("3-2-3", 2, 8.0, 0)
    assert (one.reached, one.seeds) == (2, 3)
    assert one.data.endswith("5% noise")


def test_the_whole_study_has_a_cell_for_every_network_and_data(tmp_path: Path) -> None:
    with open_executor(1, None) as executor:
        cells = studied(tmp_path, range(1), 1, executor, NoProgress())
    assert len(cells) == 3 * len(topologies())
    assert {cell.exp for cell in cells} == set(STUDIED_ROWS)
    assert all(cell.epochs <= 1 for cell in cells)
