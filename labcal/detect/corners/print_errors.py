"""Departures of a print from its design that all corners of a board share: markers off, and tone."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from labcal.detect.corners.board_print import BoardPrint
from labcal.detect.corners.printed_fit import PrintedCorner
from labcal.detect.corners.printed_kernel import empty_rows, fill_printed

_STEP = 1e-3
"""Of numerical derivatives, in squares: some hundredths of a pixel."""
_MOST = 24
"""Corners that tell the departures, spread over those that are measured."""
_EXPECTED = np.array([0.01, 0.01, 0.01, 0.01, 0.2])
"""Standard deviations of the departures, from experience: squares, and share of the half step."""
_CHANCE = 1e-3
"""Probability that a print that is as designed, in light alone, is taken for another one."""


@dataclass(frozen=True)
class PrintErrors:
    """Departures of a print from its design.

    Programs that draw markers round their cells to pixels, and put them off beside the squares; a tone curve
    and ink that spreads move edges into the black or out of it. Beside a marker, whose pattern is not the
    same on opposite sides of a corner, this moves corners.

    Attributes
    ----------
    values : ndarray, shape (5,)
        Displacement along x and y of the outer edges of markers and of the lines in them, squares; and c, the
        share of ``1 - X^2`` of the half step that is added to a pattern X.
    """

    values: np.ndarray

    @classmethod
    def none(cls) -> "PrintErrors":
        """Return those of a print as it is designed."""
        return cls(np.zeros(5))

    @property
    def tone(self) -> float:
        """c."""
        return float(self.values[4])

    def of(self, design: BoardPrint) -> BoardPrint:
        """Return the print with its lines where they are."""
        x, y = (
            lines + np.array([0.0, self.values[axis], self.values[2 + axis]])[kinds]
            for axis, (lines, kinds) in enumerate(
                zip((design.lines.x, design.lines.y), (design.x_kinds, design.y_kinds), strict=True)
            )
        )
        return replace(design, lines=design.lines._replace(x=x, y=y))


def print_errors(design: BoardPrint, before: PrintErrors, fits: Iterable[PrintedCorner]) -> PrintErrors:
    """Return the departures by least squares with the parameters of all fits; as before where chance explains.

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
    information, gradient = np.zeros((5, 5)), np.zeros(5)
    for fit in fits:
        own, slope = _told(design, before, fit)
        information += own
        gradient += slope
    change = np.linalg.solve(information + np.diag(_EXPECTED**-2), gradient)
    found = before.values + change
    far = float(found @ (information + np.diag(_EXPECTED**-2)) @ found)
    return PrintErrors(found) if far > chdtri(5, _CHANCE) else before


def _told(design: BoardPrint, before: PrintErrors, fit: PrintedCorner) -> tuple[np.ndarray, np.ndarray]:
    """Return what a corner's pixels tell of the departures beyond its own parameters, and their gradient."""
    pixels = np.ascontiguousarray(fit.window.offset), fit.window.value
    rows, moved = empty_rows(len(pixels[1])), empty_rows(len(pixels[1]))
    fill_printed(fit.state, pixels, fit.around, fit.print_, rows)
    D = np.empty((5, len(pixels[1])))
    for number in range(4):
        values = before.values.copy()
        values[number] += _STEP
        fill_printed(fit.state, pixels, fit.around, PrintErrors(values).of(design).lines, moved)
        D[number] = (rows[0] - moved[0]) / _STEP
    D[4] = rows[1][4] * fit.state[7] * (1.0 - rows[2] ** 2)
    J, noise = rows[1], max(fit.roughness * fit.step, 0.1)
    solved = np.linalg.solve(J @ J.T + fit.prior, J)
    free = D - (D @ J.T) @ solved
    return free @ D.T / noise**2, free @ rows[0] / noise**2
