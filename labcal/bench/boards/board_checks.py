"""Checks and figures of the corners of boards in drawn pictures."""

from collections.abc import Sequence

import numpy as np

from labcal.bench.boards.board_outcome import BoardOutcome
from labcal.bench.detect.accuracy import SIGMAS, chi_square_z, over_bound
from labcal.bench.groups import Findings
from labcal.report.bench import Check, Figure, at_most

MOST_NOT_INDEXED = 0.01
MOST_RATIO = 1.2
MOST_OF_OPENCV = 0.5


def board_checks(name: str, outcomes: Sequence[BoardOutcome], second: str) -> Findings:
    """Return the checks of boards, and OpenCV's figures beside.

    Parameters
    ----------
    name : str
    outcomes : sequence of BoardOutcome
        At least one, all with the same ways of OpenCV.
    second : str
        What the second bound is.
    """
    error, covariance, bound, second_bound = (
        np.concatenate([getattr(one, part) for one in outcomes])
        for part in ("error", "covariance", "bound", "second_bound")
    )
    squares = np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[..., None])[..., 0])
    not_indexed = float(np.mean([not one.indexed for one in outcomes]))
    checks = [
        at_most(f"{name}: share not indexed", not_indexed, MOST_NOT_INDEXED),
        at_most(f"{name}: wrong ids", float(sum(one.wrong for one in outcomes)), 0.0),
        at_most(f"{name}: RMS error over the Cramer-Rao bound", over_bound(error, bound), MOST_RATIO),
        at_most(
            f"{name}: normalised errors off chi-square, standard deviations",
            abs(chi_square_z(float(squares.sum()), 2 * len(error))),
            SIGMAS,
        ),
    ]
    missed = [float(one.missed) for one in outcomes if one.indexed]
    figures = [
        Figure(name=f"{name}: corners compared with the bound", value=float(len(error))),
        Figure(name=f"{name}: corners in sight not measured, a picture", value=_mean(missed)),
        Figure(name=f"{name}: RMS error over what is stated", value=over_bound(error, covariance)),
        Figure(name=f"{name}: RMS error over the bound of {second}", value=over_bound(error, second_bound)),
    ]
    for who in outcomes[0].seconds:
        seconds = float(np.median([one.seconds[who] for one in outcomes]))
        figures.append(Figure(name=f"{name}: {who}, median s", value=seconds))
    for way in outcomes[0].opencv:
        more_checks, more_figures = _beside(name, way, outcomes)
        checks += more_checks
        figures += more_figures
    return Findings(checks, figures)


def time_check(name: str, way: str, outcomes: Sequence[BoardOutcome], most: float) -> Check:
    """Return the check of labcal's time over that of one of OpenCV's ways, where that finds the board."""
    ratios = [one.seconds["labcal"] / one.seconds[way] for one in outcomes if len(one.opencv[way])]
    return at_most(
        f"{name}: time over that of {way}", float(np.median(ratios)) if ratios else float("nan"), most
    )


def _beside(name: str, way: str, outcomes: Sequence[BoardOutcome]) -> tuple[list[Check], list[Figure]]:
    """Return the check and the figures beside one of OpenCV's ways; no check where it finds nothing."""
    theirs, ours = (
        np.concatenate([getattr(one, part)[way] for one in outcomes]) for part in ("opencv", "own")
    )
    of_theirs, of_ours = _rms(theirs), _rms(ours)
    ratio = at_most(f"{name}: RMS error over that of {way}", of_ours / of_theirs, MOST_OF_OPENCV)
    found = _mean([float(len(one.opencv[way]) > 0) for one in outcomes])
    return [ratio] if len(theirs) else [], [
        Figure(name=f"{name}: share in which {way} finds the board", value=found),
        Figure(name=f"{name}: {way}, RMS error, px", value=of_theirs),
        Figure(name=f"{name}: labcal on the same corners, RMS error, px", value=of_ours),
    ]


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt((errors**2).sum(axis=1).mean())) if len(errors) else float("nan")


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if values else float("nan")
