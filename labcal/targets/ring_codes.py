"""Codes of coded dots: words of a cyclic code, half black, read around a ring from any start."""

from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int


class RingCode(StrEnum):
    """The codes of coded dots, by the number of sectors of their ring."""

    RING_23 = "ring-23"
    """The binary Golay code (Golay 1949): 23 sectors, of which 11 or 12 are black; 12 bits, 112 marks."""
    RING_31 = "ring-31"
    """A BCH code (Bose and Ray-Chaudhuri 1960): 31 sectors, 15 or 16 of them black; 16 bits, 1178 marks."""

    @property
    def sectors(self) -> int:
        """Sectors of the ring: the length of the code."""
        return _CODES[self].sectors

    @property
    def size(self) -> int:
        """Number of different marks."""
        return _CODES[self].marks


class _Code(NamedTuple):
    """Length, generator polynomial (its highest power first; it divides x^n - 1), and number of marks."""

    sectors: int
    generator: int
    marks: int


_CODES = {
    RingCode.RING_23: _Code(23, 0b110001110101, 112),
    RingCode.RING_31: _Code(31, 0b1000111110101111, 1178),
}
LEAST_DISTANCE = 7
"""Sectors by which any two words of a code differ at least, of two marks or of one that is turned."""


@dataclass(frozen=True)
class CodeBook:
    """All words of a code that marks have.

    Attributes
    ----------
    code : RingCode
        The code.
    words : ndarray of bool, shape (words, sectors)
        Every word, in every rotation; true is a black sector.
    identity : ndarray of int, shape (words,)
        Number of the mark that a word is a rotation of.
    first : ndarray of int, shape (size,)
        For every mark, the row in `words` of its word as it is printed.
    """

    code: RingCode
    words: Bool[np.ndarray, "words sectors"]
    identity: Int[np.ndarray, " words"]
    first: Int[np.ndarray, " marks"]

    def word(self, mark: int) -> Bool[np.ndarray, " sectors"]:
        """Return the sectors of a mark, clockwise as seen from the front; true is black."""
        return np.asarray(self.words[self.first[mark]])


@cache
def code_book(code: RingCode) -> CodeBook:
    """Return the words of a code.

    A cyclic code holds every rotation of its words (MacWilliams and Sloane 1977, chapter 7), so that any two
    words, turned or not, differ in as many sectors as the code's minimum distance says: seven. Its words that
    are half black are marks: clutter and shadows look like rings that are nearly white or nearly black. Marks
    are numbered by the least binary number that is a rotation of their word.

    Parameters
    ----------
    code : RingCode
    """
    length, generator, _ = _CODES[code]
    multiplier = np.arange(2 ** (length + 1 - generator.bit_length()), dtype=np.int64)
    number = np.zeros_like(multiplier)
    for power in range(generator.bit_length()):
        if generator >> power & 1:
            number ^= multiplier << power
    words = (number[:, None] >> np.arange(length - 1, -1, -1)) & 1 == 1
    is_half_black = np.abs(2 * words.sum(axis=1) - length) == 1
    number, words = number[is_half_black], words[is_half_black]
    order = np.argsort(number)
    number, words = number[order], words[order]
    least, turned = number.copy(), number
    for _ in range(length - 1):
        turned = ((turned << 1) & (2**length - 1)) | (turned >> (length - 1))
        least = np.minimum(least, turned)
    marks, identity = np.unique(least, return_inverse=True)
    return CodeBook(code, words, identity.astype(np.int64), np.searchsorted(number, marks))
