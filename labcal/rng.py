"""Seeded random numbers by name: one seed, and a stream of its own for every purpose."""

import hashlib

import numpy as np


def _sequence(seed: int, names: tuple[str, ...]) -> np.random.SeedSequence:
    digest = hashlib.sha256("\x1f".join(names).encode()).digest()
    words = np.frombuffer(digest, dtype="<u4")
    return np.random.SeedSequence([seed, *(int(word) for word in words)])


def generator(seed: int, *names: str) -> np.random.Generator:
    """Return the generator for one purpose.

    Parameters
    ----------
    seed : int
        The seed of the whole run, not negative.
    *names : str
        What the numbers are for, for example a view, a camera and ``"noise"``. Other names give an
        independent stream, so that serial and parallel runs draw the same numbers.

    Returns
    -------
    numpy.random.Generator
    """
    return np.random.default_rng(_sequence(seed, names))


def integer_seed(seed: int, *names: str) -> int:
    """Return a 32-bit seed for a library that takes an integer, drawn like :func:`generator`."""
    return int(_sequence(seed, names).generate_state(1, dtype=np.uint32)[0])
