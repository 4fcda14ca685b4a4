"""Which mutations suit which kind of file."""

from collections.abc import Callable
from random import Random

from fuzz.models import mutate_model
from fuzz.mutators import Mutant, laughs, mutate_bytes, mutate_tree, mutate_words

Mutator = Callable[[bytes, Random], Mutant]


def of_kind(kind: str) -> Mutator:
    """Return what mutates files of a kind: json, yaml, text, model or bytes."""

    def mutate(data: bytes, rng: Random) -> Mutant:
        roll = rng.random()
        if kind == "bytes" or roll < 0.25:
            return mutate_bytes(data, rng)
        if kind == "model":
            return mutate_model(data, rng)
        if kind == "text" or roll < 0.4:
            return mutate_words(data, rng)
        if kind == "yaml" and roll < 0.42:
            return laughs(rng)
        return mutate_tree(data.decode("utf-8"), kind, rng)

    return mutate
