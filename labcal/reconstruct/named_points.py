"""Points in space from named pixels, by a fitted method or by a rig."""

from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Bool, Int64

from labcal.arrays import PointCovariances, Vectors3
from labcal.bounds import MOST_MM
from labcal.calibrate.agreement.exchange.by_rays import refuse_exchanged_by_rays
from labcal.calibrate.residual_level import SeenPoints
from labcal.calibrate.systematic_residual import SystematicResidual
from labcal.calibrate.triangulation_check import TriangulationCheck, scatter_of
from labcal.calibrate.triangulation_residuals import MOST_PX, OUTLYING, TriangulationResiduals
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.correspond.matching import Matches
from labcal.correspond.named_matching import NamedMatches, match_named
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import PointFlag
from labcal.distributions import chi2_quantile, chi2_upper_quantile
from labcal.errors import InputError, UnknownNameError
from labcal.estimators.model import Model
from labcal.estimators.valid_points import predicted
from labcal.geometry.covariances import valid_or_not_stated
from labcal.reconstruct.named_judgement import FEWEST, judged
from labcal.reconstruct.named_reconstruction import NamedReconstruction
from labcal.reconstruct.point_budget import Budget, PointBudget, budget_of_a_method
from labcal.wording import listed

_PAIR = 2
_TOGETHER = 2**16
"""Points that are solved at a time, so that memory does not grow with the steps of many."""


def reconstruct_named(
    model: Model | Rig, pixels: NamedPixels, wanted: Budget | None = None
) -> NamedReconstruction:
    """Return the points of named pixels: each from all cameras that measured it, in a rig from two or more.

    Parameters
    ----------
    model : Model or Rig
        A fitted method gives points in the stage's world, with the covariances that it states, and takes all
        of its cameras; a rig triangulates, in its own world, with covariances from the pixels' and from its
        own.
    pixels : NamedPixels
        Each with a covariance. A pixel outside of its picture is not used; its point is flagged.
    wanted : Budget, optional
        The sources of errors in the covariances of a rig's points; all that the rig knows if left out.

    Raises
    ------
    InputError
        A budget is named for a fitted method, or the full one for a rig that states no covariance; the model
        has no such camera, pictures are exchanged, a point is listed twice for a picture, or no point was
        measured by enough cameras.
    """
    if wanted is not None and not isinstance(model, Rig):
        raise budget_of_a_method()
    cameras = tuple(model.cameras)
    for name in pixels.cameras:
        if name not in cameras:
            raise UnknownNameError(
                f"camera in the {'rig' if isinstance(model, Rig) else 'model'}", name, cameras
            )
    found = match_named(pixels, cameras)
    outside = _outside(model, found)
    found = replace(found, seen=found.seen & ~outside)
    needed = _PAIR if isinstance(model, Rig) else len(cameras)
    enough = [(chosen, rows) for chosen, rows in found.groups() if len(chosen) >= needed]
    if not enough:
        raise InputError(_nothing_to_meet(model, pixels, bool(outside.any())))
    solved = _Solved.empty(len(found))
    scatter_px = scatter_of(model.calibration)
    for chosen, rows in enough:
        solved.matches.append(found.matches(chosen, rows))
        solved.chosen.append(chosen)
        solved.rows.append(rows)
        if isinstance(model, Rig):
            _by_rig([model.camera(cameras[at]) for at in chosen], rows, scatter_px, solved)
        else:
            _by_method(model, rows, scatter_px, solved)
    budget = None
    if isinstance(model, Rig):
        used = np.where(found.seen[:, :, None, None], found.covariance, np.nan)
        budget = PointBudget.of(model, solved.point, used, wanted)
        if budget.kind is Budget.FULL:
            solved = replace(solved, covariance=budget.noise + budget.calibration)
    points, check, systematic = _flagged(model, found, outside, solved)
    residual = solved.px[np.concatenate([rows for _, rows in enough])]
    typical = float(np.median(residual)) if solved.residuals else None
    return NamedReconstruction(points, typical, check, systematic, budget=budget)


@dataclass(frozen=True)
class _Solved:
    """Solutions, filled in group by group."""

    point: Vectors3
    covariance: PointCovariances
    px: np.ndarray
    """(n,) triangulation residuals, px."""
    outlying: Bool[np.ndarray, " n"]
    tried: Bool[np.ndarray, " n"]
    chosen: list[tuple[int, ...]] = field(default_factory=list)
    rows: list[np.ndarray] = field(default_factory=list)
    matches: list[Matches] = field(default_factory=list)
    residuals: list[TriangulationResiduals] = field(default_factory=list)
    """Of the groups of points that the same cameras see; none for a method without cameras."""

    @classmethod
    def empty(cls, n: int) -> "_Solved":
        """Return what holds no solution yet."""
        false = np.zeros((2, n), dtype=bool)
        return cls(
            np.full((n, 3), np.nan), np.full((n, 3, 3), np.nan), np.full(n, np.inf), false[0], false[1]
        )

    def judge(self, rows: Int64[np.ndarray, " rows"], residuals: TriangulationResiduals) -> None:
        """Keep residuals of points, and which of them are larger than noise and calibration explain."""
        usual = float(np.median(residuals.chi_square)) / chi2_quantile(0.5, residuals.freedom)
        bound = max(1.0, usual if len(rows) >= FEWEST else 1.0)
        self.px[rows] = residuals.px
        self.outlying[rows] = residuals.chi_square > bound * chi2_upper_quantile(OUTLYING, residuals.freedom)
        self.residuals.append(residuals)

    def seen(self) -> list[SeenPoints]:
        """Return the points by the cameras that see them."""
        each = zip(self.chosen, self.matches, self.rows, strict=True)
        return [SeenPoints(chosen, matches, self.outlying[rows]) for chosen, matches, rows in each]


def _outside(model: Model | Rig, found: NamedMatches) -> Bool[np.ndarray, "n cameras"]:
    """Return which pixels lie outside of their pictures."""
    sizes = (
        [record.size for record in model.cameras.values()] if isinstance(model, Rig) else model.image_sizes
    )
    edge = np.array(sizes, dtype=np.float64) - 0.5
    inside = ((found.q >= -0.5) & (found.q <= edge)).all(axis=2)  # noqa: PLR2004 -- the pixel's edge
    return np.asarray(found.seen & ~inside)


def _by_rig(
    cameras: list[Camera], rows: Int64[np.ndarray, " rows"], scatter_px: float, solved: _Solved
) -> None:
    """Triangulate the latest group of points."""
    matches, parts = solved.matches[-1], []
    for first in range(0, len(rows), _TOGETHER):
        part = matches.where(np.arange(first, min(first + _TOGETHER, len(rows))))
        found = triangulate(cameras, part.q, part.covariance)
        at = rows[first : first + _TOGETHER]
        solved.point[at], solved.covariance[at], solved.tried[at] = found.point, found.covariance, True
        parts.append(TriangulationResiduals.at(cameras, _scattered(part, scatter_px), found))
    residuals = TriangulationResiduals(
        np.concatenate([part.px for part in parts]),
        np.concatenate([part.chi_square for part in parts]),
        parts[0].freedom,
    )
    if residuals.typical_px > MOST_PX:  # else no view needs to be looked at
        refuse_exchanged_by_rays(cameras, matches)
    solved.judge(rows, residuals)


def _by_method(model: Model, rows: Int64[np.ndarray, " rows"], scatter_px: float, solved: _Solved) -> None:
    """Predict the latest group of points, from the pixels of all cameras of a method."""
    matches = solved.matches[-1]
    if model.resected is not None:
        refuse_exchanged_by_rays(model.resected, matches)
        solved.judge(rows, TriangulationResiduals.of(model.resected, _scattered(matches, scatter_px)))
    solved.point[rows], solved.covariance[rows] = predicted(model, matches)
    solved.tried[rows] = True


def _scattered(matches: Matches, scatter_px: float) -> Matches:
    """Return points whose pixels scatter by the calibration, too."""
    return replace(matches, covariance=matches.covariance + scatter_px**2 * np.eye(2))


def _flagged(
    model: Model | Rig, found: NamedMatches, outside_of: Bool[np.ndarray, "n cameras"], solved: _Solved
) -> tuple[NamedPoints, TriangulationCheck | None, SystematicResidual | None]:
    """Return points with their flags, the check of their residuals, and what these have in common."""
    outside = outside_of.any(axis=1)
    check, systematic, doubtful = None, None, solved.outlying.copy()
    if solved.residuals:  # none of a method without cameras
        judgement = judged(model, solved.seen(), solved.residuals)
        check, systematic = judgement.check, judgement.systematic
        for rows, outlying in zip(solved.rows, judgement.outlying, strict=True):
            doubtful[rows] = outlying
        doubtful |= np.isin(found.view, check.views)
        doubtful |= systematic is not None and systematic.beyond_chance
    contradictory = model.calibration is not None and bool(model.calibration.inconsistent)
    if contradictory or (isinstance(model, Model) and model.misfit):
        doubtful[:] = True
    with np.errstate(invalid="ignore"):
        there = (np.abs(solved.point) <= MOST_MM).all(axis=1)
    sound = there & valid_or_not_stated(solved.covariance, MOST_MM**2)
    flag = np.full(len(found), PointFlag.OK.value, dtype="<U16")
    flag[doubtful] = PointFlag.MODEL_MISFIT
    if isinstance(model, Model):
        flag[~model.box.holds(solved.point)] = PointFlag.EXTRAPOLATED
    flag[outside] = PointFlag.OUTSIDE_PICTURE
    flag[~there] = PointFlag.NO_SOLUTION
    flag[~solved.tried] = PointFlag.TOO_FEW_CAMERAS
    flag[~solved.tried & outside] = PointFlag.OUTSIDE_PICTURE
    points = NamedPoints(
        found.view,
        found.name,
        np.where(there[:, None], solved.point, np.nan),
        np.where(sound[:, None, None], solved.covariance, np.nan),
        flag,
    )
    return points, check, systematic


def _nothing_to_meet(model: Model | Rig, pixels: NamedPixels, outside: bool) -> str:  # noqa: FBT001 -- of a message
    """Return why no point has a place, and what its pixels allow."""
    names = tuple(model.cameras)
    allows = (
        "One camera gives the direction of a point (`rig.camera(NAME).rays(q)` in Python), not its place. "
        if isinstance(model, Rig)
        else "A fitted method takes all of its cameras. "
    )
    enough = "two cameras or more" if isinstance(model, Rig) else "all of its cameras"
    within = " within their pictures" if outside else ""
    return (
        f"No point was measured by {enough} in the same view{within}: the cameras are {listed(names)}, the "
        f"pixels are those of {listed(pixels.cameras) or 'none'}. {allows}Measure points of the same name in "
        "the same view of several cameras."
    )
