"""Codes of coded dots: their distances, counted word by word."""

import numpy as np
import pytest

from labcal.targets.ring_codes import LEAST_DISTANCE, RingCode, code_book


@pytest.mark.parametrize("code", RingCode)
def test_marks_are_as_many_as_stated_and_every_rotation_of_a_mark_is_a_word(code: RingCode) -> None:
    book = code_book(code)
    assert len(book.first) == code.size == book.identity.max() + 1
    assert (np.bincount(book.identity) == code.sectors).all()
    known = {bytes(word) for word in book.words}
    for mark in range(0, code.size, 37):
        word = book.word(mark)
        assert all(bytes(np.roll(word, k)) in known for k in range(code.sectors))
    assert set(np.abs(2 * book.words.sum(axis=1) - code.sectors).tolist()) == {1}


@pytest.mark.parametrize("code", RingCode)
def test_any_two_words_differ_in_seven_sectors_or_more(code: RingCode) -> None:
    # Every word against the words that marks are printed with, which covers all pairs up to a rotation.
    book = code_book(code)
    signs = np.where(book.words, np.int8(1), np.int8(-1)).astype(np.float32)
    least = code.sectors
    for mark in range(0, code.size, max(1, code.size // 112)):
        first = book.first[mark]
        distance = (code.sectors - signs @ signs[first]) / 2
        distance[first] = code.sectors
        least = min(least, int(distance.min()))
    assert least == LEAST_DISTANCE


@pytest.mark.parametrize(("hidden", "least"), [(5, 3), (8, 2)])
def test_no_two_marks_look_alike_with_a_third_of_the_ring_hidden(hidden: int, least: int) -> None:
    book = code_book(RingCode.RING_23)
    signs = np.where(book.words[:, hidden:], 1.0, -1.0)
    distance = (signs.shape[1] - signs @ signs.T) / 2
    distance[book.identity[:, None] == book.identity] = 99
    assert distance.min() == least
