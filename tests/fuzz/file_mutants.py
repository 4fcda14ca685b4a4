"""Mutants of small files: one change each, of a byte, a number or a line."""

import re
from collections.abc import Iterator

import numpy as np

_NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_WORDS = (
    b"1e400", b"nan", b"true", b"'a'", b"[]", b"0x10", b"1_0", b"010", b"1:30", b"-7.25", b"", b"{}", b"1,5",
    b"1 2", b"1d0", b".5", b"5.", b"+3", b"-", b"1e3", b"\xd9\xa1", b"1;2", b"~", b"1.0.0", b"--1", b"\t4",
)  # fmt: skip


def file_mutants(data: bytes, rng: np.random.Generator, count: int, *, binary: bool) -> Iterator[bytes]:
    """Yield mutants: bytes and numbers changed or exchanged, lines lost, doubled and moved, ends cut off."""
    numbers = [found.span() for found in _NUMBER.finditer(data)]
    for _ in range(count):
        kind = rng.integers(4 if binary else 11)
        at = int(rng.integers(len(data)))
        if kind == 0:
            yield data[:at] + bytes([int(rng.integers(256))]) + data[at + 1 :]
        elif kind == 1:
            yield data[:at]
        elif kind == 2:
            end = min(len(data), at + int(rng.integers(1, 30)))
            yield data[:at] + data[end:]
        elif kind == 3:
            end = min(len(data), at + int(rng.integers(1, 30)))
            yield data[:end] + data[at:]
        elif kind in (4, 5):
            a, b = numbers[rng.integers(len(numbers))]
            yield data[:a] + _WORDS[rng.integers(len(_WORDS))] + data[b:]
        elif kind == 6:
            yield _exchanged(data, numbers, rng)
        elif kind == 7:
            yield _other_digit(data, numbers, rng)
        else:
            yield _moved_line(data, int(kind) - 8, rng)


def _exchanged(data: bytes, numbers: list[tuple[int, int]], rng: np.random.Generator) -> bytes:
    """Return a file with two numbers exchanged."""
    (a, b), (c, d) = sorted(numbers[one] for one in rng.integers(len(numbers), size=2))
    return data if a == c else data[:a] + data[c:d] + data[b:c] + data[a:b] + data[d:]


def _other_digit(data: bytes, numbers: list[tuple[int, int]], rng: np.random.Generator) -> bytes:
    """Return a file with one digit of a number, its sign or its point changed."""
    a, b = numbers[rng.integers(len(numbers))]
    at = int(rng.integers(a, b))
    return data[:at] + b"0123456789-.eE+, "[(one := int(rng.integers(17))) : one + 1] + data[at + 1 :]


def _moved_line(data: bytes, kind: int, rng: np.random.Generator) -> bytes:
    """Return a file with a line lost, doubled elsewhere, or exchanged for another."""
    lines = data.split(b"\n")
    i, j = (int(one) for one in rng.integers(len(lines), size=2))
    if kind == 0:
        del lines[i]
    elif kind == 1:
        lines.insert(j, lines[i])
    else:
        lines[i], lines[j] = lines[j], lines[i]
    return b"\n".join(lines)
