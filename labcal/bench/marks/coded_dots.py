"""Checks of coded dots on drawn pictures: the share that is read, wrong names, and errors of position."""

from dataclasses import dataclass

import numpy as np

from labcal.bench.detect.accuracy import SIGMAS, chi_square_z, over_bound
from labcal.bench.detect.bound import ImagedDot, centre_bounds
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
        The least covariance possible if all pixels had the mean variance of paper and ink, px squared.
    sharper_bound : ndarray, shape (m, 2, 2)
        The least one possible with the noise as it is: ink has less, so that its pixels tell more.
    """

    found: np.ndarray
    hidden: np.ndarray
    wrong: int
    error: np.ndarray
    covariance: np.ndarray
    bound: np.ndarray
    sharper_bound: np.ndarray


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
    bounds = np.array([_bounds(picture, k) for k in measured.tolist()]).reshape(-1, 2, 2, 2)
    return CodedOutcome(
        found=found[picture.measurable] >= 0,
        hidden=picture.hidden[picture.measurable],
        wrong=wrong,
        error=marks.position[of] - picture.centroid[measured],
        covariance=marks.covariance[of],
        bound=bounds[:, 0],
        sharper_bound=bounds[:, 1],
    )


def coded_dot_checks(name: str, outcomes: list[CodedOutcome]) -> Findings:
    """Return the checks of pictures of coded dots.

    Parameters
    ----------
    name : str
    outcomes : list of CodedOutcome
    """
    found, hidden = (np.concatenate([getattr(one, part) for one in outcomes]) for part in ("found", "hidden"))
    error, covariance, bound, sharper = (
        np.concatenate([getattr(one, part) for one in outcomes])
        for part in ("error", "covariance", "bound", "sharper_bound")
    )
    squares = np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[..., None])[..., 0])
    checks = [
        at_most(f"{name}: share not read, of a ring up to 30% hidden", _mean(~found), MOST_MISSED),
        at_most(f"{name}: share not read, ring in sight", _mean(~found[hidden == 0.0]), MOST_MISSED),
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
            Figure(name=f"{name}: share not read, 10 to 30% hidden", value=_mean(~found[hidden > _MUCH])),
            Figure(name=f"{name}: RMS error over what is stated", value=over_bound(error, covariance)),
            Figure(
                name=f"{name}: RMS error over the bound of a fit that weights pixels by their noise",
                value=over_bound(error, sharper),
            ),
        ],
    )


def _mean(found: np.ndarray) -> float:
    """Return the mean; NaN of nothing."""
    return float(found.mean()) if len(found) else float("nan")


def _bounds(picture: CodedPicture, number: int) -> np.ndarray:
    """Return the least covariances of a dot's centre, with the mean variance, and with those of either side.

    The dot's own pixels reach to half-way to its ring.
    """
    centre, exposure = picture.centroid[number], picture.exposure
    light = float(exposure.light(centre))
    reach = 0.5 * (1.0 + RING_INNER)
    dot = ImagedDot(centre, picture.shape[number], exposure.blur_px, INK * light, PAPER * light, reach)
    ink, paper = (exposure.noise**2 * light * level + ROUNDING for level in (INK, PAPER))
    mean = 0.5 * (ink + paper)
    return np.asarray(centre_bounds(dot, np.sqrt([[mean, mean], [ink, paper]])))
