"""Calibrations by boards of every kind: pictures that are numbered, errors of cameras and of points.

Pictures are drawn and measured by the detector, so that errors of places, their covariances, and the
calibration are judged together, on as many sets as a coverage takes. Dots go the same way, for comparison.
"""

import numpy as np

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.board_figures import BoardFigures
from labcal.bench.solve.board_poses import BOARDS
from labcal.bench.solve.board_set import BoardSet, measured_board_set
from labcal.bench.solve.budget import standard_error
from labcal.bench.solve.joint_errors import (
    chance_of_mean,
    median_sigmas,
    most_mean_square,
    most_sigmas,
    within_three_sigmas,
)
from labcal.report.bench import Check, Figure, at_most
from labcal.run.cases import run_cases

SETS, QUICK_SETS = 16, 2
"""Of each board."""
LEAST_COVERAGE = 0.90
MOST_OVER_STATED = 1.2
MOST_WARNED = 0.05
"""Share of sets, all of which are right, with a warning that residuals hold more than chance."""
MOST_NOT_INDEXED = 0.01
_CHANCE = 2.6
"""Standard errors that chance is granted: of a hundred good ones, one is beyond."""


def board_findings(bench: Bench) -> Findings:
    """Return the checks of calibrations by each kind of board."""
    seeds = range(bench.seed, bench.seed + (QUICK_SETS if bench.quick else SETS))
    cases = [BoardSet(board, seed) for board in BOARDS for seed in seeds]
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, measured_board_set, BoardFigures, bench.folder / "boards", executor, bench.progress
        )
    sets = {
        board: found[number * len(seeds) : (number + 1) * len(seeds)] for number, board in enumerate(BOARDS)
    }
    *boards, dots = sets
    checks = [check for board in sets for check in board_checks(board, sets[board])]
    checks += [coverage_check(board, sets[board], sets[dots]) for board in boards]
    return Findings(checks, [figure for board in sets for figure in _figures(board, sets[board])])


def board_checks(board: str, sets: list[BoardFigures]) -> list[Check]:
    """Return the checks of the sets of one board.

    Parameters
    ----------
    board : str
        Its kind.
    sets : list of BoardFigures
        Two or more.

    Notes
    -----
    Of many parameters whose errors are normal some are beyond three standard deviations. So all of them are
    judged together, by their squared Mahalanobis distance, and the worst one by the distribution of the
    largest of so many (:mod:`labcal.bench.solve.joint_errors`).
    """
    title = _title(board, sets)
    parameters = sum(one.parameters for one in sets)
    mean_square = sum(one.mean_square * one.parameters for one in sets) / parameters
    shares = np.array([one.coverage for one in sets])
    refused = 1.0 - sum(one.indexed for one in sets) / sum(one.pictures for one in sets)
    return [
        at_most(f"{title}: share of pictures not indexed", refused, MOST_NOT_INDEXED),
        at_most(f"{title}: wrong ids", float(sum(one.wrong for one in sets)), 0.0),
        at_most(f"{title}: mean square of {parameters} errors of cameras in units of their covariance",
                mean_square, most_mean_square(parameters)),
        at_most(f"{title}: worst of {parameters} parameters, standard deviations",
                max(one.worst for one in sets), most_sigmas(parameters)),
        at_most(f"{title}: coverage of points of held-out views below {LEAST_COVERAGE:g}",
                LEAST_COVERAGE - float(shares.mean()), chance_of_mean(len(sets)) * standard_error(shares)),
        at_most(f"{title}: RMS error of places over the one stated",
                _root(sets, "error_px") / _root(sets, "stated_px"), MOST_OVER_STATED),
        at_most(f"{title}: share of sets that calibrate warns of",
                float(np.mean([one.warned for one in sets])),
                MOST_WARNED + _CHANCE * float(np.sqrt(MOST_WARNED / len(sets)))),
    ]  # fmt: skip


def coverage_check(board: str, sets: list[BoardFigures], dots: list[BoardFigures]) -> Check:
    """Return the check that stated errors of points cover as by dots, but for chance.

    All points of a set share the errors of its cameras, so that a set covers nearly all of them or, one in
    twenty, few.
    """
    own, theirs = (np.array([one.coverage for one in some]) for some in (sets, dots))
    chance = float(np.hypot(standard_error(own), standard_error(theirs)))
    return at_most(
        f"{_title(board, sets)}: coverage of points below that by dots",
        float(theirs.mean() - own.mean()),
        chance_of_mean(min(len(own), len(theirs))) * chance,
    )


def _title(board: str, sets: list[BoardFigures]) -> str:
    return f"boards, {board}, {len(sets)} sets"


def _figures(board: str, sets: list[BoardFigures]) -> list[Figure]:
    title = f"boards, {board}"
    mean = {
        "squared errors of places in units of their covariance, a coordinate": "normalised",
        "squared errors of cameras in units of their covariance, a parameter": "mean_square",
        "RMS residual over what covariances leave": "residual",
        "largest error of a parameter in a set, standard deviations, mean": "worst",
        "coverage of points of held-out views": "coverage",
    }
    root = {
        "RMS error of places, px": "error_px",
        "RMS error of points, mm": "error_mm",
        "stated RMS error of points, mm": "stated_mm",
    }
    parameters = sum(one.parameters for one in sets)
    near = float(np.mean([within_three_sigmas(one.mean_square, one.parameters) for one in sets]))
    return [
        Figure(name=f"{title}: share of sets within three standard deviations jointly", value=near),
        Figure(
            name=f"{title}: median of the worst of {parameters} independent normal errors",
            value=median_sigmas(parameters),
        ),
        *(
            Figure(name=f"{title}: {words}", value=float(np.mean([getattr(one, part) for one in sets])))
            for words, part in mean.items()
        ),
        *(Figure(name=f"{title}: {words}", value=_root(sets, part)) for words, part in root.items()),
    ]


def _root(sets: list[BoardFigures], part: str) -> float:
    """Return the root of the mean square of a figure over sets."""
    return float(np.sqrt(np.mean([getattr(one, part) ** 2 for one in sets])))
