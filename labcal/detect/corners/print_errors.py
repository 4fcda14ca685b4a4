"""Departures of a print from its design that all corners of a board share: markers off, and tone."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from labcal.detect.corners.board_print import BoardPrint
from labcal.detect.corners.printed_fit import PrintedCorner
from labcal.detect.corners.printed_kernel import empty_rows, fill_printed
from labcal.detect.corners.printed_lines import line_derivatives
from labcal.detect.corners.tone_curve import MOST_TONE, by_tone

_MOST = 24
"""Corners that tell the departures, spread over those that are measured."""
_LINE, _TONE = 0.01, 0.2
"""Expected departures: of lines, squares; of tone, its c."""
_LEAST_NOISE = 0.1
"""Of a pixel, grey values."""
_CHANCE = 1e-3
"""Probability that a print that is as designed, in light alone, is taken for another one."""
_RANK, _ROUNDING = 1e-9, 1e-9
"""Share of the greatest variance below which there is none, and the change that is none."""


@dataclass(frozen=True)
class PrintErrors:
    """Departures of a print from its design.

    Programs that draw markers round their cells to pixels, and put them off beside the squares; a tone curve
    and ink that spreads move edges into the black or out of it. Beside a marker, whose pattern is not the
    same on opposite sides of a corner, this moves corners.

    Attributes
    ----------
    values : ndarray, shape (p,)
        Displacement of the lines of markers, each the same in all markers, along x and then along y, squares;
        and c of the curve from light to grey values (:mod:`labcal.detect.corners.tone_curve`).
    covariance : ndarray, shape (p, p)
        Of these; zero where the print is as it is designed.
    """

    values: np.ndarray
    covariance: np.ndarray

    @classmethod
    def none(cls, design: BoardPrint) -> "PrintErrors":
        """Return those of a print as it is designed."""
        size = design.count + 1
        return cls(np.zeros(size), np.zeros((size, size)))

    @property
    def tone(self) -> float:
        """C."""
        return float(self.values[-1])

    def are_near(self, before: "PrintErrors") -> bool:
        """Tell whether they differ from those of the round before by less than their own error."""
        change = self.values - before.values
        weighed = np.linalg.pinv(self.covariance, rcond=_RANK, hermitian=True) @ change
        is_free = np.allclose(self.covariance @ weighed, change, rtol=0.0, atol=_ROUNDING)
        return is_free and float(change @ weighed) < 1.0

    def of(self, design: BoardPrint) -> BoardPrint:
        """Return the print with its lines where they are."""
        x, y = (
            lines + np.where(kinds >= 0, self.values[kinds], 0.0)
            for lines, kinds in ((design.lines.x, design.x_kinds), (design.lines.y, design.y_kinds))
        )
        return replace(design, lines=design.lines._replace(x=x, y=y))


def print_errors(design: BoardPrint, before: PrintErrors, fits: Iterable[PrintedCorner]) -> PrintErrors:
    """Return the departures by least squares with all fits' parameters.

    Three kinds are each zero where chance explains them: the tone, which nearly every camera has; the size of
    markers, in which spread ink and what the curve of the tone leaves show, and which moves no corner by
    itself; and all other displacements of lines. What is estimated anew in each picture moves all of its
    corners alike.

    Parameters
    ----------
    design : BoardPrint
        As it should be.
    before : PrintErrors
        With which the corners were fitted.
    fits : iterable of PrintedCorner
    """
    fits = list(fits)
    fits = [fits[k] for k in np.unique(np.linspace(0, len(fits) - 1, _MOST).astype(int))] if fits else []
    size = len(before.values)
    information, gradient = np.zeros((size, size)), np.zeros(size)
    for fit in fits:
        evidence = _Evidence.of(design, fit)
        information += evidence.information
        gradient += evidence.gradient
    right = information @ before.values + gradient
    information += np.diag([_LINE**-2.0] * design.count + [_TONE**-2.0])
    found, of_all = np.linalg.solve(information, right), np.linalg.inv(information)
    free = []
    for ways in _kinds_of_departures(design.count):
        along = ways.T @ found
        if along @ np.linalg.solve(ways.T @ of_all @ ways, along) > chdtri(len(along), _CHANCE):
            free.append(ways)
    if not free:
        return PrintErrors(np.zeros(size), np.zeros((size, size)))
    ways = np.concatenate(free, axis=1)
    covariance = ways @ np.linalg.inv(ways.T @ information @ ways) @ ways.T
    values = covariance @ right
    values[-1] = np.clip(values[-1], -MOST_TONE, MOST_TONE)
    return PrintErrors(values, covariance)


def _kinds_of_departures(count: int) -> Iterator[np.ndarray]:
    """Yield orthonormal directions of each kind, shape (count + 1, m): size of markers, other lines, tone."""
    lines, own = np.eye(count + 1)[:, :count], count // 2
    size = (lines[:, [0, own]] - lines[:, [own - 1, count - 1]]).sum(axis=1, keepdims=True) / 2.0
    yield size
    yield np.linalg.qr(np.concatenate([size, lines], axis=1))[0][:, 1:count]
    yield np.eye(count + 1)[:, count:]


def with_print_errors(design: BoardPrint, errors: PrintErrors, fit: PrintedCorner) -> PrintedCorner:
    """Return a fit that states what the uncertainty of the departures, with which it was made, adds."""
    if not errors.covariance.any():
        return fit
    moved = _Evidence.of(design, fit).moved
    return replace(fit, shared=moved @ errors.covariance @ moved.T)


@dataclass(frozen=True)
class _Evidence:
    """Evidence of the departures in a corner's pixels, beyond its own parameters.

    Attributes
    ----------
    information : ndarray, shape (p, p)
    gradient : ndarray, shape (p,)
    moved : ndarray, shape (2, p)
        Change of the corner's place by the departures, px.
    """

    information: np.ndarray
    gradient: np.ndarray
    moved: np.ndarray

    @classmethod
    def of(cls, design: BoardPrint, fit: PrintedCorner) -> "_Evidence":
        """Return it for the fit of a corner."""
        pixels = np.ascontiguousarray(fit.window.offset), fit.window.value
        rows, D = empty_rows(len(pixels[1])), np.empty((design.count + 1, len(pixels[1])))
        fill_printed(fit.state, pixels, fit.around, fit.print_, rows)
        place = fit.around, fit.print_
        line_derivatives(fit.state, pixels[0], place, (design.x_kinds, design.y_kinds), D[:-1])
        D[-1] = rows[1][4] * fit.state[7] * by_tone(rows[2], float(fit.state[10]))
        J, noise = rows[1], max(fit.roughness * fit.step, _LEAST_NOISE)
        mixed = J @ D.T
        common = np.linalg.solve(J @ J.T + fit.prior, mixed)
        information, gradient = D @ D.T - common.T @ mixed, D @ rows[0] - common.T @ (J @ rows[0])
        return cls(information / noise**2, gradient / noise**2, -common[:2])
