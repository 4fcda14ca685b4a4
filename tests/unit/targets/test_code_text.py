"""The whole description of a target in a code, and codes that lie."""

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget, load_target, target_names
from labcal.targets.charuco import CharucoBoard, MarkerDictionary, Pattern
from labcal.targets.code_text import MOST_LETTERS, _checksum, code_text, described_by
from labcal.targets.coded_dots import CodedDots
from labcal.targets.grid import DotGrid, Polarity

ALPHANUMERIC = set("0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ $%*+-./:")
GOOD = "LABCAL1:D:RINGS-14X10:14X10:S:7:7:2:2:0.8:2.2.11.7:B:7:0"


def signed(body: str) -> str:
    """Return a text with the checksum that belongs to it."""
    return f"{body}:{_checksum(body)}"


def any_name(random: np.random.Generator) -> str:
    letters = list("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-")
    return "".join(random.choice(letters, random.integers(1, 16)))


def any_length(random: np.random.Generator, low: float, high: float) -> float:
    return float(np.round(random.uniform(low, high), random.integers(0, 7)) or low)


def any_target(random: np.random.Generator) -> AnyTarget:
    """Return a target of any kind, with sizes that a printer prints."""
    cols, rows = (int(n) for n in random.integers(4, 30, 2))
    pitch = any_length(random, 2.0, 60.0)
    kind = random.integers(4)
    common = {"name": any_name(random), "margin_mm": any_length(random, 0.5, 20.0)}
    if kind == 0:
        squares = (cols, rows) if cols * rows < 900 else (5, 4)
        return CharucoBoard(
            kind="charuco", squares=squares, square_mm=pitch, marker_mm=0.7 * pitch,
            dictionary=random.choice([one for one in MarkerDictionary if one.size >= 450]),
            pattern=random.choice(list(Pattern)), **common,
        )  # fmt: skip
    if kind == 1:
        return CodedDots(
            kind="coded-dots", code="ring-31", first_mark=int(random.integers(0, 300)), cols=cols, rows=rows,
            pitch_mm=pitch, dot_diameter_mm=pitch / random.uniform(4.01, 9.0), **common,
        )  # fmt: skip
    if kind == 2:
        return DotGrid(
            layout="asymmetric", cols=cols, rows=rows, pitch_x_mm=pitch, pitch_y_mm=pitch / 2,
            dot_diameter_mm=0.3 * pitch, rings=None, **common,
        )  # fmt: skip
    rings = {"origin": (1, 1), "x": (2, 1), "y": (1, 3)} if random.integers(2) else None
    return DotGrid(
        cols=cols, rows=rows, pitch_x_mm=pitch, pitch_y_mm=pitch * random.uniform(0.9, 1.1),
        dot_diameter_mm=0.4 * pitch, rings=rings, polarity=random.choice(list(Polarity)),
        ring_outer_diameter_mm=0.5 * pitch if rings else None,
        ring_inner_diameter_mm=0.2 * pitch if rings else None, **common,
    )  # fmt: skip


def test_the_text_says_all_of_every_target() -> None:
    random = np.random.default_rng(18)
    told = 0
    for _ in range(400):
        target, copy = any_target(random), int(random.integers(0, 3))
        try:
            text = code_text(target, copy)
        except InputError:  # many digits and a long name, which test_what_no_code_can_say looks at
            continue
        told += 1
        assert len(text) <= MOST_LETTERS
        assert set(text) <= ALPHANUMERIC
        found = described_by(text)
        assert found is not None
        assert found.target == target
        assert found.copy == copy
    assert told > 300


@pytest.mark.parametrize("name", target_names())
def test_a_shipped_target_comes_back_with_its_words(name: str) -> None:
    found = described_by(code_text(load_target(name), 7))
    assert found is not None
    assert found.target == load_target(name)
    assert found.name == f"{name}#7"


def test_a_letter_that_is_misread_is_noticed() -> None:
    text = code_text(load_target("rings-14x10"))
    assert text.startswith(GOOD)
    random = np.random.default_rng(2)
    for _ in range(300):
        at, letter = int(random.integers(8, len(text))), str(random.choice(sorted(ALPHANUMERIC)))
        changed = text[:at] + letter + text[at + 1 :]
        if changed != text:
            with pytest.raises(InputError):
                described_by(changed)


@pytest.mark.parametrize(
    "text", ["https://example.org/LABCAL1:", "", "WIFI:S:lab;;", "labcal1:d:", "LABCAL:D"]
)
def test_a_code_of_someone_else_is_none_of_labcal_s(text: str) -> None:
    assert described_by(text) is None


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (GOOD.replace("LABCAL1", "LABCAL2"), "version 2"),
        (GOOD.replace(":D:", ":Z:"), "kind 'Z'"),
        (GOOD.replace("14X10:S", "1000X1000:S"), "at most 250000 dots"),
        (GOOD.replace("14X10:S", "1000X100:S"), "at most 20000"),
        (GOOD.replace("14X10:S", "1000000X1:S"), "whole numbers"),
        (GOOD.replace(":7:7:2", ":-7:7:2"), "has no sign"),
        (GOOD.replace(":7:7:2", ":NAN:7:2"), "has no sign"),
        (GOOD.replace(":7:7:2", ":INF:7:2"), "has no sign"),
        (GOOD.replace(":7:7:2", ":0:7:2"), "describes no target"),
        (GOOD.replace(":7:7:2:2:0.8", ":7E8:7E8:7E7:7E7:7E6"), "at most 10000 mm"),
        (GOOD.replace(":7:7:2:2:0.8", ":7E999:7:2:2:0.8"), "describes no target"),
        (GOOD.replace(":7:7:2:2:0.8", ":0.007:0.007:0.002:0.002:0.0008").replace("B:7", "B:0"), "finer than"),
        (GOOD.replace("2.2.11.7", "2.2.99.7"), "outside the 14 x 10 grid"),
        (GOOD.replace("RINGS-14X10", "../ETC"), "letters, digits and hyphens"),
        (GOOD + ":1", "fields"),
        (GOOD[:-1] + "12345", "its copy|Its copy"),
        (GOOD + "9" * 5000, "letters"),
    ],
)
def test_a_code_that_lies_is_refused_by_what_it_says(body: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        described_by(signed(body))


def test_a_wrong_checksum_is_told() -> None:
    with pytest.raises(InputError, match="checksum"):
        described_by(GOOD + ":0000000")


def test_what_no_code_can_say_is_refused() -> None:
    target = load_target("rings-14x10").model_copy(update={"name": "x" * 120})  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="shorter name"):
        code_text(target)
    with pytest.raises(InputError, match="1 to 9999"):
        code_text(load_target("rings-14x10"), 10_000)
