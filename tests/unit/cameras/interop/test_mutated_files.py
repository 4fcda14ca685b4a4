"""Mutated files of every format: refused by labcal's own errors, or read to numbers that stand in them."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from labcal.cameras.interop.exchange import Home, OutputText, ReadOptions, Unit
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.cameras.rig import Rig
from labcal.errors import LabcalError

MakeRig = Callable[..., Rig]
SHIFTS = {"colmap": 0.5, "colmap-binary": 0.5, "matlab": 1.0}
GIVEN = ReadOptions(unit=Unit.MILLIMETRES)
NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
LITERAL = re.compile(rb"0x[0-9a-f]+|\b[1-9]\d*(?:_\d+)+")
"""Numbers of Python (mrcal) and TOML, which no other format may take for such."""
QUICK, MANY = 40, 3000


def mutants(data: bytes, rng: np.random.Generator, count: int, *, binary: bool) -> Iterator[bytes]:
    """Bytes and numbers changed, lines lost, doubled and exchanged, ends cut off."""
    numbers = [found.span() for found in NUMBER.finditer(data)]
    for _ in range(count):
        kind = rng.integers(3 if binary else 7)
        at = int(rng.integers(len(data)))
        if kind == 0:
            yield data[:at] + bytes([int(rng.integers(256))]) + data[at + 1 :]
        elif kind == 1:
            yield data[:at]
        elif kind == 2:
            end = min(len(data), at + int(rng.integers(1, 30)))
            yield data[:at] + data[end:]
        elif kind == 3:
            a, b = numbers[rng.integers(len(numbers))]
            words = [
                b"1e400",
                b"nan",
                b"true",
                b"'a'",
                b"[]",
                b"0x10",
                b"1_0",
                b"010",
                b"1:30",
                b"-7.25",
                b"",
                b"{}",
            ]
            yield data[:a] + words[rng.integers(len(words))] + data[b:]
        else:
            lines = data.split(b"\n")
            i, j = (int(one) for one in rng.integers(len(lines), size=2))
            if kind == 4:
                del lines[i]
            elif kind == 5:
                lines.insert(j, lines[i])
            else:
                lines[i], lines[j] = lines[j], lines[i]
            yield b"\n".join(lines)


def values_in(data: bytes, *, binary: bool) -> np.ndarray:
    """All numbers that stand in a file, sorted."""
    if binary:
        found = [np.frombuffer(data[at:][: (len(data) - at) // 8 * 8], "<f8") for at in range(8)]
        found += [np.frombuffer(data[at:][: (len(data) - at) // 4 * 4], "<u4") for at in range(4)]
        values = np.concatenate(found)
    else:
        numbers = [float(found[0]) for found in NUMBER.finditer(data)]
        numbers += [float(int(one[0], 0)) for one in LITERAL.finditer(data)]
        values = np.array(numbers)
    return np.unique(values[np.isfinite(values)])


def stands(value: float, values: np.ndarray) -> bool:
    at = np.clip(np.searchsorted(values, value), 1, len(values) - 1)
    return bool(np.abs(values[[at - 1, at]] - value).min() <= 1e-12 * max(1.0, abs(value)))


def run(name: str, rig: Rig, folder: Path, count: int) -> tuple[int, int]:
    """Read mutants of a format; return how many were read and how many refused."""
    chosen = FORMATS[name]
    rng = np.random.default_rng(sum(name.encode()))
    given = GIVEN if "unit" in chosen.options else ReadOptions()
    if name == "matchid":
        given = ReadOptions(size=(640, 480), unit=Unit.MILLIMETRES)
    files = chosen.write(rig, chosen.suffixes[0]).files
    home = folder / name
    home.mkdir()
    paths = [home / place_of(name, one) for one in files]
    contents = [one.text.encode() if isinstance(one.text, str) else one.text for one in files]
    for path, content in zip(paths, contents, strict=True):
        path.write_bytes(content)
    inputs = [home] if chosen.home is Home.FOLDER else paths
    shift = SHIFTS.get(name, 0.0)
    read = refused = 0
    for at, path in enumerate(paths):
        rest = b"\n".join(content for other, content in enumerate(contents) if other != at)
        for mutant in mutants(contents[at], rng, -(-count // len(paths)), binary=chosen.binary):
            path.write_bytes(mutant)
            try:
                found = read_rig_files(inputs, name, given)[1].rig
            except LabcalError:
                refused += 1
                continue
            read += 1
            values = values_in(mutant + b"\n" + rest, binary=chosen.binary)
            for record in found.cameras.values():
                (fx, _, cx), (_, fy, cy), _ = record.K
                sizes = [] if name == "matchid" else record.size
                for value in (fx, fy, cx + shift, cy + shift, *sizes, *(one for one in record.dist if one)):
                    assert stands(float(value), values), (name, path.name, value, mutant)
        path.write_bytes(contents[at])
    return read, refused


def place_of(name: str, one: OutputText) -> str:
    """The name of a file."""
    chosen = FORMATS[name]
    return one.label if chosen.home is Home.FOLDER else f"{one.label or 'rig'}{chosen.suffixes[0]}"


def lens_of(name: str) -> str:
    return "brown-k1k2" if name == "kalibr" else "brown5"


@pytest.mark.parametrize("name", list(FORMATS))
def test_mutated_files_are_refused_or_read_as_they_stand(
    name: str, tmp_path: Path, make_rig: MakeRig
) -> None:
    _, refused = run(name, make_rig(lens_of(name)), tmp_path, QUICK)
    assert refused > QUICK / 8


@pytest.mark.slow
@pytest.mark.parametrize("name", list(FORMATS))
def test_three_thousand_mutated_files(name: str, tmp_path: Path, make_rig: MakeRig) -> None:
    read, refused = run(name, make_rig(lens_of(name)), tmp_path, MANY)
    assert refused > MANY / 8
    assert read > 0
