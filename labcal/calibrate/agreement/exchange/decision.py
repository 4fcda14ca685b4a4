"""The decision that pictures are exchanged, and the cause that is reported."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from labcal.calibrate.agreement.finding import Cause, CauseName
from labcal.errors import InputError

LEFT = 0.1
"""Largest share of the residual that is left where exchanged pictures are exchanged back; of a chi-square,
its square."""


LEFT_OF_POSES = 0.2
"""The same where the poses of two cameras tell: what is left then holds the errors of both cameras' poses in
every view, which no exchange takes away. With 0.1, two of 36 rendered sets that were exchanged half-way had
another likely cause."""


def explains(given: float, exchanged: float, bound: float, left: float = LEFT) -> bool:
    """Tell whether exchanged pictures explain a residual.

    Parameters
    ----------
    given, exchanged : float
        Residuals with the pictures as given and exchanged back, in the same unit.
    bound : float
        The residual that a good set does not exceed: where nothing fits the pictures as given, and their
        residual is infinite, what is left must be below it.
    left : float
        Largest share of the residual that is left.
    """
    return exchanged < (left * given if np.isfinite(given) else bound)


def exchanges(cameras: int) -> Iterator[tuple[tuple[int, int], list[int]]]:
    """Yield every two cameras, and the order of all with these two exchanged."""
    for a, b in combinations(range(cameras), 2):
        order = list(range(cameras))
        order[a], order[b] = b, a
        yield (a, b), order


def exchange_cause(cameras: tuple[str, str], views: tuple[str, ...], where: str, left: str) -> Cause:
    """Return the cause with its advice.

    Parameters
    ----------
    cameras : (str, str)
    views : tuple of str
        Those with exchanged pictures.
    where : str
        In which views, in words.
    left : str
        What is left after the exchange, in words.
    """
    return Cause(
        CauseName.SWAPPED_CAMERAS,
        f"pictures of '{cameras[0]}' and '{cameras[1]}' are exchanged in {where}: exchanged back, {left}. "
        "State which camera took which picture: `cameras` of 'detect'.",
        cameras,
        views,
    )


class ExchangedPicturesError(InputError):
    """Pictures of a view bear each other's camera's name.

    Parameters
    ----------
    cause : Cause
        Which ones, in words too.
    """

    def __init__(self, cause: Cause) -> None:
        super().__init__(cause.why[0].upper() + cause.why[1:])
        self.cause = cause

    def __reduce__(self) -> tuple[type["ExchangedPicturesError"], tuple[Cause]]:
        """Let it be pickled, so that a worker process can hand it on."""
        return type(self), (self.cause,)


def refuse_exchanged(
    view: str, cameras: tuple[str, str], given: float, exchanged: float, bound: float
) -> None:
    """Raise where exchanged pictures of a view explain its residuals, px; see :func:`explains`.

    Raises
    ------
    ExchangedPicturesError
        They do.
    """
    if explains(given, exchanged, bound):
        as_given = f"as they are by {given:.3g} px" if np.isfinite(given) else "as they are nothing fits"
        left = f"dots are off by {exchanged:.3g} px, {as_given}"
        raise ExchangedPicturesError(exchange_cause(cameras, (view,), f"view '{view}'", left))
