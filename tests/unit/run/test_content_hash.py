import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum, StrEnum
from functools import partial
from pathlib import PurePosixPath

import numpy as np
import pytest
from pydantic import BaseModel

from labcal.errors import InputTypeError
from labcal.run.content_hash import content_hash
from labcal.scene.catalogue import load_scene


class Colour(Enum):
    RED = 1
    BLUE = 2


class Word(StrEnum):
    RED = "red"


@dataclass(frozen=True)
class Spot:
    place: np.ndarray
    name: str = "a"
    note: str = field(default="", compare=False)


@dataclass(frozen=True)
class OtherSpot:
    place: np.ndarray
    name: str = "a"


class Model(BaseModel):
    size: float = 1.0
    names: tuple[str, ...] = ()


PLACE = np.arange(6.0).reshape(2, 3)
DIFFERENT: list[object] = [
    None, True, False, 0, 1, -1, 2**70, 0.0, 1.0, 0.1 + 0.2, 0.3, float("nan"), float("inf"), "", "1", "a",
    b"a", (), (1,), (1, 1), ((1,), 1), (1, (1,)), ["ab", "c"], ["a", "bc"], {1}, {"a": 1}, {"a": 2}, {"b": 1},
    {1: "a"}, Colour.RED, Colour.BLUE, Word.RED, "red", PurePosixPath("a"), PLACE, PLACE.T, PLACE.ravel(),
    PLACE.astype(np.float32), PLACE.astype(int), PLACE + 1e-15, np.array("a"), Spot(PLACE), Spot(PLACE, "b"),
    OtherSpot(PLACE), Model(), Model(size=2.0), Model(names=("a",)), Spot, OtherSpot, len, content_hash,
    partial(content_hash, 1), partial(content_hash, 2),
]  # fmt: skip


def test_different_content_has_different_hashes() -> None:
    hashes = [content_hash(value) for value in DIFFERENT]
    assert len(set(hashes)) == len(DIFFERENT)


@pytest.mark.parametrize(
    ("one", "same"),
    [
        (PLACE, np.asfortranarray(PLACE)),
        (PLACE, PLACE.astype(">f8")),
        (PLACE, np.repeat(PLACE, 2, axis=0)[::2]),
        ({"a": 1, "b": 2}, {"b": 2, "a": 1}),
        ({"a", "b", "c"}, frozenset(("c", "b", "a"))),
        (np.float64(0.1), 0.1),
        (float("nan"), -float("nan")),
        ([1, 2], (1, 2)),
        (Spot(PLACE, note="mine"), Spot(PLACE.copy(), note="yours")),
    ],
)  # fmt: skip
def test_equal_content_has_equal_hashes(one: object, same: object) -> None:
    assert content_hash(one) == content_hash(same)


def test_the_hash_of_a_scene_is_the_same_in_another_process() -> None:
    code = (
        "from labcal.run.content_hash import content_hash; from labcal.scene.catalogue import load_scene; "
        "print(content_hash((load_scene('webcam-volume'), {'a', 'b', 'c', 'd'})))"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == content_hash((load_scene("webcam-volume"), {"d", "c", "b", "a"}))


class Plain:
    pass


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ({"a": [1, Plain()]}, r"the value\['a'\]\[1\] is of type Plain"),
        (Spot(np.array([Plain()])), r"the value\.place is of type ndarray"),
        (lambda: None, "A lambda of the module"),
    ],
)
def test_what_has_no_hash_is_named(value: object, said: str) -> None:
    with pytest.raises(InputTypeError, match=said):
        content_hash(value)


def test_code_of_the_users_counts_with_its_file(
    tmp_path: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So a method that is changed is measured again."""
    monkeypatch.syspath_prepend(str(tmp_path))
    hashes = []
    for number, name in enumerate(("of_mine_one", "of_mine_two")):
        (tmp_path / f"{name}.py").write_text(f"def work(case):\n    return case + {number}\n")  # type: ignore[operator]
        function: Callable[[int], int] = __import__(name).work
        function.__module__ = name
        hashes.append(content_hash(function))
    assert hashes[0] != hashes[1]
