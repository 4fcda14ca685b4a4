"""Checks of coded dots on drawn pictures: the share that is read, wrong names, and errors of position."""

from dataclasses import dataclass

import numpy as np

from labcal.bench.detect.accuracy import SIGMAS, chi_square_z, over_bound
from labcal.bench.detect.bound import ImagedDot, centre_bound
from labcal.bench.groups import Bench, Findings
from labcal.bench.marks.coded_picture import CodedPicture, coded_picture
from labcal.bench.marks.drawn_picture import INK, PAPER
from labcal.detect.marks.coded_dots import find_coded_dots
from labcal.detect.marks.picture_marks import PictureMarks
from labcal.report.bench import Figure, at_most
from labcal.targets.coded_dots import RING_INNER
from labcal.targets.ring_codes import RingCode

_MUCH = 0.1
"""Share of a ring that is hidden, from which on its marks have a figure of their own."""
PICTURES, QUICK_PICTURES = 500, 40
CODE = RingCode.RING_23
MOST_MISSED = 0.02
MOST_RATIO = 1.2
OFF_PX = 3.0
"""Error above which the name of a measured mark counts as wrong."""
ROUNDING = 1.0 / 12.0 / 255.0**2
"""Variance of rounding to whole levels, as a share of full scale squared."""


@dataclass(frozen=True)
class CodedOutcome:
    """Comparison of one picture's marks with the truth.

    Attributes
    ----------
    found : ndarray of bool, shape (n,)
        For every mark that should be read, whether it was measured under its own name.
    hidden : ndarray, shape (n,)
        Share of its ring that is hidden.
    wrong : int
        Measured marks whose name is that of a mark elsewhere, or of none in the picture.
    error : ndarray, shape (m, 2)
        Measured minus true centroids of those found, px.
    covariance : ndarray, shape (m, 2, 2)
        As stated, px squared.
    bound : ndarray, shape (m, 2, 2)
        The least covariance possible, px squared.
    """

    found: np.ndarray
    hidden: np.ndarray
    wrong: int
    error: np.ndarray
    covariance: np.ndarray
    bound: np.ndarray


def coded_dot_findings(bench: Bench) -> Findings:
    """Return the checks of coded dots over all difficulties: recall, wrong names, errors over the bound."""
    count = QUICK_PICTURES if bench.quick else PICTURES
    bench.progress.start("coded dots", count)
    outcomes = []
    for number in range(count):
        picture = coded_picture(CODE, number, bench.seed)
        outcomes.append(coded_outcome(picture, find_coded_dots(picture.picture, CODE)))
        bench.progress.advance()
    return coded_dot_checks(f"{count} pictures of coded dots", outcomes)


def coded_outcome(picture: CodedPicture, marks: PictureMarks) -> CodedOutcome:
    """Compare what was found in a picture with its truth.

    Parameters
    ----------
    picture : CodedPicture
    marks : PictureMarks
    """
    found = np.full(len(picture.point), -1)
    wrong = 0
    for number in np.flatnonzero(marks.ok).tolist():
        away = np.linalg.norm(picture.centroid - marks.position[number], axis=1)
        same = np.array([name == marks.point[number] for name in picture.point], dtype=bool)
        right = np.flatnonzero(same & (away < OFF_PX))
        wrong += len(right) == 0
        found[right] = number
    measured = np.flatnonzero(picture.measurable & (found >= 0))
    of = found[measured]
    return CodedOutcome(
        found=found[picture.measurable] >= 0,
        hidden=picture.hidden[picture.measurable],
        wrong=wrong,
        error=marks.position[of] - picture.centroid[measured],
        covariance=marks.covariance[of],
        bound=np.array([_bound(picture, k) for k in measured.tolist()]).reshape(-1, 2, 2),
    )


def coded_dot_checks(name: str, outcomes: list[CodedOutcome]) -> Findings:
    """Return the checks of pictures of coded dots.

    Parameters
    ----------
    name : str
    outcomes : list of CodedOutcome
    """
    found, hidden = (np.concatenate([getattr(one, part) for one in outcomes]) for part in ("found", "hidden"))
    error, covariance, bound = (
        np.concatenate([getattr(one, part) for one in outcomes]) for part in ("error", "covariance", "bound")
    )
    squares = np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[..., None])[..., 0])
    checks = [
        at_most(f"{name}: share not read, of a ring up to 30% hidden", 1.0 - _mean(found), MOST_MISSED),
        at_most(f"{name}: share not read, ring in sight", 1.0 - _mean(found[hidden == 0.0]), MOST_MISSED),
        at_most(f"{name}: wrong codes", float(sum(one.wrong for one in outcomes)), 0.0),
        at_most(f"{name}: RMS error over the Cramer-Rao bound", over_bound(error, bound), MOST_RATIO),
        at_most(
            f"{name}: normalised errors off chi-square, standard deviations",
            abs(chi_square_z(float(squares.sum()), 2 * len(error))),
            SIGMAS,
        ),
    ]
    return Findings(
        checks,
        [
            Figure(name=f"{name}: marks that should be read", value=float(len(found))),
            Figure(
                name=f"{name}: share not read, 10 to 30% hidden", value=1.0 - _mean(found[hidden > _MUCH])
            ),
            Figure(name=f"{name}: RMS error over what is stated", value=over_bound(error, covariance)),
        ],
    )


def _mean(found: np.ndarray) -> float:
    """Return the mean; NaN of nothing."""
    return float(found.mean()) if len(found) else float("nan")


def _bound(picture: CodedPicture, number: int) -> np.ndarray:
    """Return the least covariance of a dot's centre, whose own pixels reach to half-way to its ring."""
    centre, exposure = picture.centroid[number], picture.exposure
    light = float(exposure.light(centre))
    reach = 0.5 * (1.0 + RING_INNER)
    dot = ImagedDot(centre, picture.shape[number], exposure.blur_px, INK * light, PAPER * light, reach)
    # The noise of paper and of ink differ; an edge shows the mean of their variances.
    variance = exposure.noise**2 * light * 0.5 * (PAPER + INK) + ROUNDING
    return np.asarray(centre_bound(dot, float(np.sqrt(variance))))
