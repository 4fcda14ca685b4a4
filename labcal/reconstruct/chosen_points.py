"""Some points of a reconstruction, and the covariance of what is computed from them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arguments import whole_number
from labcal.arrays import AnyArray, lines_array
from labcal.errors import InputError
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.reconstruct.reconstruction import Reconstruction


@dataclass(frozen=True)
class Shares:
    """The covariance of m values in two shares, in the values' units."""

    noise: Float64[np.ndarray, "m m"]
    calibration: Float64[np.ndarray, "m m"]
    budget: Budget

    @property
    def total(self) -> Float64[np.ndarray, "m m"]:
        """The sum of both."""
        return np.asarray(self.noise + self.calibration)


@dataclass(frozen=True)
class ChosenPoints:
    """Different points of one rig, with what their joint covariance is made of.

    Attributes
    ----------
    budget : PointBudget
        Of all points.
    line : int64 array, (k,)
        Of the points in their table.
    point : float64 array, (k, 3)
        Mm.
    noise : float64 array, (k, 3, 3)
        Mm squared.
    derivatives : float64 array, (k, 3, parameters)
        By the parameters of the cameras.
    """

    budget: PointBudget
    line: Int64[np.ndarray, " k"]
    point: Float64[np.ndarray, "k 3"]
    noise: Float64[np.ndarray, "k 3 3"]
    derivatives: Float64[np.ndarray, "k 3 parameters"]

    @classmethod
    def of(cls, found: Reconstruction, lines: AnyArray, name: str) -> "ChosenPoints":
        """Return the points of some lines; a mask or their numbers.

        Raises
        ------
        InputError, InputTypeError
            There is no such line, one is listed twice, a point has no solution, or the points are not those
            of a rig.
        """
        if found.budget is None:
            raise InputError(
                "These points come from a fitted method, which states no joint covariance. Reconstruct them "
                "with a rig, as 'labcal calibrate' makes one."
            )
        numbers = np.arange(len(found.points))[lines_array(lines, len(found.points), name)]
        _refuse_repeated(numbers, name)
        point = found.points.point[numbers]
        lost = numbers[~np.isfinite(point).all(axis=1)]
        if len(lost):
            raise InputError(f"Point {lost[0]} of `{name}` has no solution. Leave it out.")
        return cls(
            found.budget, numbers, point, found.budget.noise[numbers], found.budget.derivatives(numbers)
        )

    @classmethod
    def single(cls, found: Reconstruction, lines: Sequence[int], names: Sequence[str]) -> "ChosenPoints":
        """Return the points of single lines, each with the name of its argument."""
        least = -len(found.points)
        numbers = [whole_number(line, name, least) for line, name in zip(lines, names, strict=True)]
        return cls.of(found, numbers, ", ".join(names))

    def and_others(self, others: "ChosenPoints", names: str) -> "ChosenPoints":
        """Return these points and others of the same reconstruction, in this order.

        Raises
        ------
        InputError
            A point is among both.
        """
        line = np.concatenate([self.line, others.line])
        _refuse_repeated(line, names)
        return ChosenPoints(
            self.budget,
            line,
            np.concatenate([self.point, others.point]),
            np.concatenate([self.noise, others.noise]),
            np.concatenate([self.derivatives, others.derivatives]),
        )

    def shares(self, slopes: Float64[np.ndarray, "m k 3"]) -> Shares:
        """Return the covariance of values by their derivatives by the points (JCGM 102:2011, first order)."""
        noise = np.einsum("mki,kij,nkj->mn", slopes, self.noise, slopes)
        by = np.einsum("mki,kip->mp", slopes, self.derivatives)
        return Shares(noise, by @ self.budget.parameters @ by.T, self.budget.kind)


def _refuse_repeated(lines: Int64[np.ndarray, " k"], name: str) -> None:
    """Raise where a line is listed twice."""
    if len(set(lines.tolist())) < len(lines):
        raise InputError(f"`{name}` lists a point twice. Give different points.")
