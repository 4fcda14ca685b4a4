"""Causes that move dots beyond noise, in words and by rank."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.guide.twin.cause_designs import CauseKind
from labcal.guide.twin.causes import Cause, Explained
from labcal.guide.twin.residuals import DotResiduals, rms
from labcal.wording import listed

_SIGMAS = 4.0
"""Of the chance of a mean square."""
_REST_SHARE = 0.1
_SHOWN = 4
_SHORT = {
    CauseKind.PRINT: "the places of the dots on the print",
    CauseKind.BEND: "a bend of the board",
    CauseKind.LENS: "the lens",
    CauseKind.PICTURES: "single pictures",
}


@dataclass(frozen=True)
class Unexplained:
    """Something that simulation does not explain.

    Attributes
    ----------
    kind : str
        ``print``, ``bend``, ``lens``, ``pictures``, ``positions`` (of no known pattern), ``blur``,
        ``blur-over-picture``, ``edges``, ``paper``, or ``undecided`` (one of several causes).
    words : str
    share : float or None
        Of the squares of residuals of dots; None of what does not move dots.
    size : float
    unit : str
    pictures : tuple of str
        That show it, where it is not all.
    """

    kind: str
    words: str
    share: float | None
    size: float
    unit: str
    pictures: tuple[str, ...] = ()


def unexplained_positions(
    explanation: Explained, found: DotResiduals, names: Sequence[str] = (), far: tuple[str, ...] = ()
) -> tuple[Unexplained, ...]:
    """Return what moves dots beyond noise, by rank.

    Parameters
    ----------
    explanation : Explained
    found : DotResiduals
    names : sequence of str
        Of the pictures.
    far : tuple of str
        Pictures with residuals above the mean.
    """
    moving = [_moving(cause, found, names) for cause in explanation.causes]
    n = 2.0 * len(found)
    if explanation.rest > _REST_SHARE and explanation.left_level > 1.0 + _SIGMAS * np.sqrt(2.0 / n):
        moving.append(Unexplained(
            "positions",
            f"residuals of dots without a pattern that repeats, {np.sqrt(explanation.left_level):.2g} times "
            "the noise: edges that are not those of round dots, or light and blur that vary from dot to dot",
            explanation.rest, np.sqrt(explanation.rest) * found.rms_px, "px", far,
        ))  # fmt: skip
    return tuple(sorted(moving, key=lambda one: -(one.share or 0.0)))


def _moving(cause: Cause, found: DotResiduals, names: Sequence[str]) -> Unexplained:
    """Return a cause of residuals in words."""
    size, share = cause.size, cause.share
    if cause.rivals:
        size = rms(cause.fit)
        could = " or ".join(_SHORT[kind] for kind in (cause.kind, *cause.rivals))
        words = (
            f"a pattern of {size:.2g} px RMS that can be {could}: these views do not tell which; "
            "more views with other tilts and places in the picture do"
        )
        return Unexplained("undecided", words, share, size, "px")
    if cause.kind is CauseKind.PRINT:
        words = f"the places of the dots on the print: {size:.2g} um RMS in its plane, the same in all views"
    elif cause.kind is CauseKind.BEND:
        words = f"a board that is bent otherwise: dots are displaced by {size:.2g} um RMS as cameras see it"
    elif cause.kind is CauseKind.LENS:
        words = f"the lens: a smooth field over the picture, {size:.2g} px RMS, the same in all views"
    else:
        of = [rms(cause.fit[found.picture == number]) for number in range(len(names))]
        order = np.argsort(-np.array(of))[:_SHOWN]
        worst = tuple(names[i] for i in order if of[i] > 0.5 * max(of))
        words = (
            f"single pictures that do not agree with the others of their view: {size:.2g} px RMS, most in "
            f"{listed(worst)}; the target moved between the exposures, or a camera did"
        )
        return Unexplained("pictures", words, share, size, "px", worst)
    return Unexplained(cause.kind.value, words, share, size, cause.unit)
