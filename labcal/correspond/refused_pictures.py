"""Pictures that are not used, reported once for each reason."""

from collections.abc import Sequence
from dataclasses import dataclass

from labcal.errors import InputError
from labcal.wording import counted, listed

_SHOWN = 3
"""Names of pictures."""


@dataclass(frozen=True)
class SharedReason:
    """A reason why some pictures are not used."""

    images: tuple[str, ...]
    """As given, in their order."""
    reason: str
    """That of the first one, which may be named in it."""

    @property
    def words(self) -> str:
        """A message with the reason and the pictures."""
        first = self.images[0]
        if len(self.images) == 1:
            return self.reason if first in self.reason else f"{first}: {self.reason}"
        of_first = ", the first one: " if first in self.reason else ": "
        names = listed(self.images, _SHOWN)
        return f"{counted(len(self.images), 'picture')} ({names}){of_first}{self.reason}"


def shared_reasons(refused: Sequence[tuple[str, str]]) -> list[SharedReason]:
    """Return the reasons of pictures; those that differ only in the name of the picture are one.

    Parameters
    ----------
    refused : sequence of (str, str)
        Picture, as given, and reason.

    Returns
    -------
    list of SharedReason
        In order of appearance.
    """
    alike: dict[str, list[tuple[str, str]]] = {}
    for image, reason in refused:
        alike.setdefault(reason.replace(image, ""), []).append((image, reason))
    return [SharedReason(tuple(image for image, _ in pairs), pairs[0][1]) for pairs in alike.values()]


def no_picture_left(refused: Sequence[tuple[str, str]]) -> InputError:
    """Return the error for pictures of which not one can be used: each reason once."""
    number = len(refused)
    subject = f"None of the {number} pictures" if number > 1 else "The only picture"
    verb = "can" if number > 1 else "cannot"
    reasons = " ".join(
        shared.reason if len(shared.images) == number else shared.words
        for shared in shared_reasons(refused)[:_SHOWN]
    )
    return InputError(f"{subject} {verb} be used. {reasons}")
