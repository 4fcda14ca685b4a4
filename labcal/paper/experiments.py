"""The experiments of the paper by name: its rows, and its claims."""

from collections.abc import Sequence
from dataclasses import dataclass

from labcal.errors import UnknownNameError
from labcal.paper.claims.plan import claims_plan
from labcal.paper.rows import NOT_REPORTED, ROWS, PaperRow, row_named


@dataclass(frozen=True)
class Experiments:
    """A selection of rows and claims, each in the order of the paper."""

    rows: tuple[PaperRow, ...]
    claims: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Numbers of the rows, and the claims."""
        return (*(row.exp for row in self.rows), *self.claims)


def experiments_named(names: Sequence[str]) -> Experiments:
    """Return the rows and claims with these names, or all if none is given.

    Parameters
    ----------
    names : sequence of str
        Numbers of rows, with or without the leading zero, and claims: ``["01", "13", "C4"]``.

    Raises
    ------
    UnknownNameError
        The paper has no such row and no such claim.
    InputError
        The paper has a row in its text only.
    """
    claims = tuple(claims_plan().claims)
    if not names:
        return Experiments(ROWS, claims)
    rows = [row.exp for row in ROWS]
    named = {name.upper() for name in names} & set(claims)
    numbers = [name for name in names if name.upper() not in named]
    for number in numbers:
        if number.zfill(2) not in (*rows, *NOT_REPORTED):
            raise UnknownNameError("row or claim of the paper", number, (*rows, *claims))
    wanted = {row_named(number).exp for number in numbers}
    return Experiments(
        tuple(row for row in ROWS if row.exp in wanted), tuple(claim for claim in claims if claim in named)
    )
