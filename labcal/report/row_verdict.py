"""The five verdicts on a row of the paper, and their meaning."""

from enum import StrEnum

EPOCH_FACTOR = 2.0
"""Epochs within this factor of the paper's count as the paper's."""


class RowVerdict(StrEnum):
    """Verdicts on the error and the epochs of a row, beside the paper's."""

    MATCHES = "matches"
    OTHER_EPOCHS = "other epochs"
    SMALLER = "smaller error than the paper's"
    LARGER = "larger error than the paper's"
    CONTRADICTION = "the paper contradicts itself"

    @property
    def short(self) -> str:
        """The verdict where there is little room."""
        return _SHORT.get(self, self.value)

    @property
    def meaning(self) -> str:
        """A sentence that says when it is given."""
        return _MEANINGS[self]


_SHORT = {
    RowVerdict.SMALLER: "smaller error",
    RowVerdict.LARGER: "larger error",
    RowVerdict.CONTRADICTION: "contradiction",
}
_MEANINGS = {
    RowVerdict.MATCHES: (
        "The paper's mean signed error lies within the range of our seeds, give or take the rounding of its "
        "last digit. The epochs, where there are any, include the paper's or are within a factor of 2."
    ),
    RowVerdict.OTHER_EPOCHS: "The error matches, the epochs do not.",
    RowVerdict.SMALLER: (
        "The error does not match: the magnitude of our median is smaller than the paper's figure."
    ),
    RowVerdict.LARGER: "The error does not match: the magnitude of our median is larger.",
    RowVerdict.CONTRADICTION: (
        "The paper's figures of this row cannot all be right, so there is nothing to agree with."
    ),
}
