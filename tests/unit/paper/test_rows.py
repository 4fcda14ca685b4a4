from labcal.paper.rows import NOT_REPORTED, ROWS, SCENES, Data, Solver, row_named
from labcal.scene.catalogue import scene_names


def test_there_are_the_22_rows_of_the_paper() -> None:
    assert [row.exp for row in ROWS] == [f"{n:02d}" for n in range(1, 24) if n != 16]
    assert NOT_REPORTED == ("16",)
    assert row_named("3") is row_named("03")


def test_some_figures_as_printed() -> None:
    # Tables 1 to 3 of the paper.
    assert (row_named("04").paper_abs_m, row_named("04").paper_epochs, row_named("04").goal) == (
        0.00091,
        989,
        1e-7,
    )
    assert (row_named("10").solver, row_named("10").paper_abs_m) == (Solver.LEAST_SQUARES, 0.01169)
    assert (row_named("21").hidden, row_named("21").paper_epochs) == ((50,), 1359)
    assert (row_named("22").points, row_named("22").goal) == (520, 1e-5)
    assert [row.exp for row in ROWS if row.noisy] == ["03", "04", "05"]
    assert {"07", "17", "18", "19", "20"} <= {row.exp for row in ROWS if row.contradiction}


def test_networks_have_a_goal_and_least_squares_have_none() -> None:
    for row in ROWS:
        network = row.solver is Solver.NETWORK
        assert (row.goal is not None) == network
        assert (row.paper_epochs is not None) == network
        assert bool(row.hidden) == network


def test_rows_from_pictures_have_a_scene() -> None:
    assert {row.exp for row in ROWS if row.pictured} == {"17", "18", "19", "20", "21", "22", "23"}
    assert set(SCENES.values()) <= set(scene_names())
    assert Data.PLANE not in SCENES
