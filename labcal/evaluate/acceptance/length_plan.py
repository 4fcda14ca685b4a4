"""A plan of lengths over a volume: seven measuring lines with five lengths each.

Published descriptions of VDI/VDE 2634 Part 1 ask for seven lines with five lengths each, a longest length on
each line that is not below the shortest side of the volume, a longest one of all of two thirds of its
diagonal or more, and an end in each corner. Which lines these are, the four diagonals of the volume and the
three lines through its middle along its sides, and the steps of the lengths are a choice of this package.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np
from jaxtyping import Float64

from labcal.arguments import real_number
from labcal.arrays import AnyArray, float_array
from labcal.bounds import LEAST_MM, MOST_MM
from labcal.errors import InputError
from labcal.evaluate.acceptance.reference_lengths import ReferenceLengths
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable, PublicObject
from labcal.wording import clipped

LINES, LENGTHS, SPACE = 7, 5, 3
LONGEST_SHARE = 2.0 / 3.0
"""Least share of the volume's diagonal that the longest length has."""
_STEPS = np.array([1.0, 0.8, 0.6, 0.4, 0.2])
"""Lengths on a line, as parts of its longest one."""


@dataclass(frozen=True, eq=False, repr=False)
class LengthPlan(PublicObject):
    """Places of a scale bar, or of two marks, for an acceptance test.

    Attributes
    ----------
    volume_mm : tuple of float
        Sides of the volume along x, y and z, mm.
    end_a, end_b : float64 array, (35, 3)
        Ends of the lengths, from the middle of the volume, mm: line by line, the longest length first.
    warnings : tuple of str
        What the plan does not reach.

    Examples
    --------
    >>> import labcal
    >>> plan = labcal.plan_lengths((400, 300, 200))
    >>> plan
    LengthPlan(volume=400 x 300 x 200 mm, lines=7, lengths=35, longest=539 mm, warnings=0)
    >>> plan.lengths().nominal_mm[:3].round(1)
    array([538.5, 430.8, 323.1])
    """

    volume_mm: tuple[float, float, float]
    end_a: Float64[np.ndarray, "lengths 3"]
    end_b: Float64[np.ndarray, "lengths 3"]
    warnings: tuple[str, ...]

    @property
    def nominal_mm(self) -> Float64[np.ndarray, " lengths"]:
        """The planned lengths, mm."""
        return np.asarray(np.linalg.norm(self.end_b - self.end_a, axis=1))

    def lengths(self) -> ReferenceLengths:
        """Return the form to fill in: a view for each length, ends ``a`` and ``b``, and planned lengths."""
        numbers = [(line, length) for line in range(1, LINES + 1) for length in range(1, LENGTHS + 1)]
        views = [f"line-{line}-length-{length}" for line, length in numbers]
        lines, lengths = ([str(pair[at]) for pair in numbers] for at in range(2))
        a, b = (np.full(len(views), end) for end in "ab")
        return ReferenceLengths(lines, lengths, views, a, views, b, np.round(self.nominal_mm, 3))

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write the form as ``lengths.csv``; as :meth:`ReferenceLengths.save`, which lists its errors."""
        self.lengths().save(path, force=force)

    def _summary(self) -> Mapping[str, object]:
        return {
            "volume": " x ".join(f"{side:g}" for side in self.volume_mm) + " mm",
            "lines": LINES,
            "lengths": len(self.end_a),
            "longest": f"{self.nominal_mm.max():.3g} mm",
            "warnings": len(self.warnings),
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        return [HtmlTable(("line", "length", "mm", "from (mm)", "to (mm)"), plan_rows(self))]


def volume_sides(volume_mm: AnyArray) -> tuple[float, float, float]:
    """Return the sides of a volume, mm.

    Raises
    ------
    InputError, InputTypeError
        They are not three positive numbers.
    """
    sides = float_array(volume_mm, ("n",), "volume_mm").tolist()
    if len(sides) != SPACE or not all(isfinite(side) and LEAST_MM <= side <= MOST_MM for side in sides):
        raise InputError(
            f"`volume_mm` takes three numbers from {LEAST_MM:g} to {MOST_MM:g} mm, but "
            f"{clipped(', '.join(f'{side:g}' for side in sides))} was given."
        )
    return (sides[0], sides[1], sides[2])


def plan_rows(plan: LengthPlan) -> list[list[str]]:
    """Return the lengths as cells: line, length, nominal length and both ends, mm."""
    rows = []
    for number, nominal in enumerate(plan.nominal_mm.tolist()):
        line, length = divmod(number, LENGTHS)
        ends = [", ".join(f"{x:+z.1f}" for x in end[number].tolist()) for end in (plan.end_a, plan.end_b)]
        rows.append([str(line + 1), str(length + 1), f"{nominal:.1f}", *ends])
    return rows


def plan_lengths(volume_mm: AnyArray, longest_mm: float | None = None) -> LengthPlan:
    """Return a plan of 35 lengths over a volume, for an acceptance test in the manner of VDI/VDE 2634 Part 1.

    Parameters
    ----------
    volume_mm : array_like, shape (3,)
        Sides of the volume that the user measures in, mm.
    longest_mm : float, optional
        Longest length that there is: of the scale bar. Shorter lengths follow from it.

    Returns
    -------
    LengthPlan

    Raises
    ------
    InputError, InputTypeError
        A side, or the longest length, is not a positive number.

    Examples
    --------
    >>> import labcal
    >>> labcal.plan_lengths((400, 300, 200), longest_mm=250.0).warnings[0][:60]
    'the longest length has 250 mm, less than two thirds of the v'
    """
    sides = np.array(volume_sides(volume_mm))
    bar = None if longest_mm is None else real_number(longest_mm, "longest_mm", (LEAST_MM, MOST_MM))
    half = 0.5 * sides
    corners = half * np.array([[-1, -1, -1], [1, -1, -1], [-1, 1, -1], [1, 1, -1]])
    starts = np.concatenate([corners, -np.diag(half)])
    end_a, end_b = [], []
    for number, start in enumerate(starts):
        whole = 2.0 * float(np.linalg.norm(start))
        reach = whole if bar is None else min(whole, bar)
        along = -2.0 * start / whole
        for step, share in enumerate(_STEPS):
            # Lengths begin at both ends of a line in turn, so that all of the volume is measured in.
            first, sign = (start, 1.0) if (number + step) % 2 == 0 or share == 1.0 else (-start, -1.0)
            end_a.append(first)
            end_b.append(first + sign * share * reach * along)
    plan = LengthPlan(
        (float(sides[0]), float(sides[1]), float(sides[2])), np.array(end_a), np.array(end_b), ()
    )
    warnings = extent_warnings(sides, np.repeat(np.arange(LINES), LENGTHS), plan.nominal_mm)
    return LengthPlan(plan.volume_mm, plan.end_a, plan.end_b, warnings)


def extent_warnings(
    sides_mm: Float64[np.ndarray, "3"], line: np.ndarray, nominal_mm: Float64[np.ndarray, " n"]
) -> tuple[str, ...]:
    """Return what lengths over a volume do not reach of the guideline; nothing without lengths.

    Parameters
    ----------
    sides_mm : ndarray, shape (3,)
    line : ndarray, shape (n,)
        The measuring line of each length.
    nominal_mm : ndarray, shape (n,)
    """
    if len(nominal_mm) == 0:
        return ()
    found, diagonal = [], float(np.linalg.norm(sides_mm))
    longest, slack = float(nominal_mm.max()), 1.0 - 1e-6
    if longest < slack * LONGEST_SHARE * diagonal:
        found.append(
            f"the longest length has {longest:.4g} mm, less than two thirds of the volume's diagonal of "
            f"{diagonal:.4g} mm: errors that grow with length are seen in part only"
        )
    shortest_side = float(sides_mm.min())
    short = [str(one) for one in dict.fromkeys(line.tolist())
             if float(nominal_mm[line == one].max()) < slack * shortest_side]  # fmt: skip
    if short:
        found.append(
            f"the longest length of {len(short)} lines is shorter than the shortest side of the volume, "
            f"{shortest_side:.4g} mm"
        )
    return tuple(found)
