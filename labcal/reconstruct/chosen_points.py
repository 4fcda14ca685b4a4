"""Some points of a reconstruction, and the covariance of what is computed from them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import AnyArray
from labcal.errors import InputError
from labcal.reconstruct.chosen_lines import OnePoint, line_of, lines_of
from labcal.reconstruct.frames.framed_budget import FramedBudget
from labcal.reconstruct.named_reconstruction import NamedReconstruction
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.reconstruct.point_errors import PointErrors
from labcal.reconstruct.reconstruction import Reconstruction
from labcal.reconstruct.scale.scaled_budget import ScaledBudget

AnyReconstruction = Reconstruction | NamedReconstruction
"""Points of dots or of named pixels."""


@dataclass(frozen=True)
class Shares:
    """The covariance of m values in three shares, in the values' units."""

    noise: Float64[np.ndarray, "m m"]
    """Of pixel noise."""
    calibration: Float64[np.ndarray, "m m"]
    """Of the cameras."""
    stated: Float64[np.ndarray, "m m"]
    """Of known coordinates of the frame, or lengths of scale bars; 0 without either."""
    budget: Budget

    @property
    def total(self) -> Float64[np.ndarray, "m m"]:
        """The sum of all."""
        return np.asarray(self.noise + self.calibration + self.stated)


@dataclass(frozen=True)
class ChosenPoints:
    """Different points of one rig, with the sources of their errors.

    Attributes
    ----------
    line : int64 array, (k,)
        Of the points in their table.
    point : float64 array, (k, 3)
        Mm.
    errors : PointErrors
    budget : Budget
        The sources of errors that these are.
    """

    line: Int64[np.ndarray, " k"]
    point: Float64[np.ndarray, "k 3"]
    errors: PointErrors
    budget: Budget

    @classmethod
    def of(cls, found: AnyReconstruction, lines: AnyArray, name: str) -> "ChosenPoints":
        """Return the points of some lines: a mask, their numbers, or names of named points.

        Raises
        ------
        InputError, InputTypeError
            There is no such line or name, one is listed twice, a point has no solution, or the points are not
            those of a rig.
        """
        return cls._of_lines(found, lines_of(found.points, lines, name), name)

    @classmethod
    def single(
        cls, found: AnyReconstruction, given: Sequence[OnePoint], names: Sequence[str]
    ) -> "ChosenPoints":
        """Return single points, each with the name of its argument; the lines as of :meth:`of`."""
        lines = [line_of(found.points, one, name) for one, name in zip(given, names, strict=True)]
        return cls._of_lines(found, np.array(lines), ", ".join(names))

    @classmethod
    def _of_lines(
        cls, found: AnyReconstruction, numbers: Int64[np.ndarray, " k"], name: str
    ) -> "ChosenPoints":
        budget = budget_of(found)
        _refuse_repeated(numbers, name)
        point = found.points.point[numbers]
        lost = numbers[~np.isfinite(point).all(axis=1)]
        if len(lost):
            raise InputError(f"Point {lost[0]} of `{name}` has no solution. Leave it out.")
        return cls(numbers, point, budget.errors(numbers), budget.kind)

    def and_others(self, others: "ChosenPoints", names: str) -> "ChosenPoints":
        """Return these points and others of the same reconstruction, in this order.

        Raises
        ------
        InputError
            A point is among both.
        """
        line = np.concatenate([self.line, others.line])
        _refuse_repeated(line, names)
        point = np.concatenate([self.point, others.point])
        return ChosenPoints(line, point, self.errors.and_others(others.errors), self.budget)

    def shares(self, slopes: Float64[np.ndarray, "m k 3"]) -> Shares:
        """Return the covariance of values by their derivatives by the points (JCGM 102:2011, first order)."""
        errors = self.errors
        own = np.einsum("mki,kij,nkj->mn", slopes, errors.own, slopes)
        by_shared = np.einsum("mki,kis->ms", slopes, errors.by_shared)
        stated = np.ix_(errors.stated, errors.stated)
        noise = np.ix_(~errors.stated, ~errors.stated)
        by_stated, by_noise = by_shared[:, errors.stated], by_shared[:, ~errors.stated]
        by_cameras = np.einsum("mki,kip->mp", slopes, errors.by_cameras)
        return Shares(
            own + by_noise @ errors.shared[noise] @ by_noise.T,
            by_cameras @ errors.cameras @ by_cameras.T,
            by_stated @ errors.shared[stated] @ by_stated.T,
            self.budget,
        )


def budget_of(found: AnyReconstruction) -> PointBudget | FramedBudget | ScaledBudget:
    """Return the error budget of points.

    Raises
    ------
    InputError
        They are not those of a rig.
    """
    if found.budget is None:
        raise InputError(
            "These points come from a fitted method, which states no joint covariance. Reconstruct them "
            "with a rig, as 'labcal calibrate' makes one."
        )
    return found.budget


def _refuse_repeated(lines: Int64[np.ndarray, " k"], name: str) -> None:
    """Raise where a line is listed twice."""
    if len(set(lines.tolist())) < len(lines):
        raise InputError(f"`{name}` lists a point twice. Give different points.")
