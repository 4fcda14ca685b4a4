"""The experiments of the paper by name: its rows, its claims, and two studies about them."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from labcal.errors import UnknownNameError
from labcal.paper.claims.plan import claims_plan
from labcal.paper.rows import NOT_REPORTED, ROWS, PaperRow, row_named


class Study(StrEnum):
    """Studies beside rows and claims."""

    STUDY = "study"
    """Neurons and layers, which the paper mentions and does not show."""
    EXPLANATIONS = "explanations"
    """Mistakes that would give what rows 17 to 23 print."""


@dataclass(frozen=True)
class Experiments:
    """A selection of rows, claims and studies, each in the order of the paper."""

    rows: tuple[PaperRow, ...]
    claims: tuple[str, ...]
    studies: tuple[Study, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Numbers of the rows, the claims, and the studies."""
        return (*(row.exp for row in self.rows), *self.claims, *self.studies)


def experiments_named(names: Sequence[str]) -> Experiments:
    """Return the rows, claims and studies with these names, or all if none is given.

    Parameters
    ----------
    names : sequence of str
        Numbers of rows, with or without the leading zero, claims, and studies: ``["01", "C4", "study"]``.

    Raises
    ------
    UnknownNameError
        The paper has no such row and no such claim, and there is no such study.
    InputError
        The paper has a row in its text only.
    """
    claims = tuple(claims_plan().claims)
    if not names:
        return Experiments(ROWS, claims, tuple(Study))
    rows = [row.exp for row in ROWS]
    named = {name.upper() for name in names} & set(claims)
    studies = tuple(study for study in Study if study in {name.lower() for name in names})
    numbers = [name for name in names if name.upper() not in named and name.lower() not in studies]
    for number in numbers:
        if number.zfill(2) not in (*rows, *NOT_REPORTED):
            known = (*rows, *claims, *Study)
            raise UnknownNameError("row, claim or study of the paper", number, known)
    wanted = {row_named(number).exp for number in numbers}
    return Experiments(
        tuple(row for row in ROWS if row.exp in wanted),
        tuple(claim for claim in claims if claim in named),
        studies,
    )
