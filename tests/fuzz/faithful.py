"""Mutated files of cameras: refused by labcal's own errors, or read to what they state."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from fuzz.file_mutants import file_mutants
from fuzz.stated_cameras import READERS, Files, Stated, stated_camera
from fuzz.stated_forms import FORMS
from fuzz.stated_robots import ROBOTS, Example
from labcal.cameras.camera import Camera
from labcal.cameras.interop.exchange import Home, ReadOptions
from labcal.cameras.interop.registry import FORMATS, READ
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.cameras.rig import Rig
from labcal.errors import LabcalError
from labcal.geometry.poses import from_rotation_vector

_SECOND = from_rotation_vector(np.array([0.02, 0.25, -0.03]), np.array([-180.3, 6.1, 25.7]))


@dataclass(frozen=True)
class Reading:
    """What came of one mutant."""

    number: int
    file: str
    mutant: bytes
    refused: bool
    faults: tuple[str, ...]
    """What was read otherwise than it is stated, or a foreign exception."""


def example_rig(lens: str) -> Rig:
    """Return a pair without any number that comes twice."""
    dist = (-0.31, 0.1, -0.0015, 0.0017, -1e-5 if lens == "brown5" else 0.0)
    cameras = {}
    for name, f, T in (("left", 700.1, np.eye(4)), ("right-2", 691.0, _SECOND)):
        K = np.array([[f, 0.0, 0.4605 * f], [0.0, f - 9.9, 0.338 * f], [0.0, 0.0, 1.0]])
        cameras[name] = Camera(K, "brown5", np.array(dist) * (f / 700.1), T, (640, 480))
    return Rig.of(cameras)


def readings(name: str, folder: Path, seed: int, count: int) -> Iterator[Reading]:
    """Yield what comes of mutants of a format, about `count`, spread over its files.

    Parameters
    ----------
    name : str
        A format, or a form of it.
    folder : Path
        An empty folder, for the files.
    seed : int
        The same one gives the same mutants.
    count : int
    """
    example = example_of(name)
    chosen = READ[example.format_name]
    rng = np.random.default_rng([seed, *name.encode()])
    unit = chosen.unit if "unit" in chosen.options else None
    given = ReadOptions(size=(640, 480) if name == "matchid" else None, unit=unit)
    files = example.files
    for file, content in files.items():
        (folder / file).write_bytes(content)
    inputs = [folder] if chosen.home is Home.FOLDER else [folder / file for file in files]
    meant = example.read(files)
    number = 0
    for file, content in files.items():
        for mutant in file_mutants(
            content, rng, -(-count // len(files)), binary=chosen.binary or name.endswith(".npz")
        ):
            (folder / file).write_bytes(mutant)
            number += 1
            try:
                found = read_rig_files(inputs, chosen.name, given)[1].rig
            except LabcalError:
                yield Reading(number, file, mutant, True, ())
                continue
            except Exception as error:  # noqa: BLE001 -- that is what is looked for
                yield Reading(number, file, mutant, False, (f"{type(error).__name__}: {error}",))
                continue
            yield Reading(
                number, file, mutant, False, _faults(example, found, {**files, file: mutant}, meant)
            )
        (folder / file).write_bytes(content)


def example_of(name: str) -> Example:
    """Return files of a format, or of a form of it, and their second reader."""
    others = {**ROBOTS, **FORMS}
    if name in others:
        return others[name]
    rig = example_rig("brown4" if name == "kalibr" else "brown5")
    return Example(name.split(".", maxsplit=1)[0], _files(name, rig), READERS[name])


def _files(name: str, rig: Rig) -> Files:
    """Return the files of a format, or of a form of it that is not written."""
    chosen, _, form = name.partition(".")
    made = FORMATS[chosen]
    if form in {"json", "npz"}:
        first, second = rig.cameras.values()
        T = np.array(second.T_cam_world)
        arrays = {
            "M1": first.K,
            "D1": first.dist,
            "M2": second.K,
            "D2": second.dist,
            "R": T[:3, :3],
            "T": T[:3, 3],
        }
        content = {key: np.array(value) for key, value in arrays.items()}
        if form == "json":
            sizes = {"image_width": 640, "image_height": 480}
            listed = {key: value.tolist() for key, value in content.items()}
            return {"rig.json": json.dumps({**sizes, **listed}, indent=1).encode()}
        packed = BytesIO()
        np.savez(packed, image_size=np.array(first.size), **content)
        return {"rig.npz": packed.getvalue()}
    suffix = f".{form}" if form else made.suffixes[0]
    return {
        one.label if made.home is Home.FOLDER else f"{one.label or 'rig'}{suffix}":
            one.text.encode() if isinstance(one.text, str) else one.text
        for one in made.write(rig, suffix).files
    }  # fmt: skip


def _faults(example: Example, found: Rig, files: Files, meant: list[Stated]) -> tuple[str, ...]:
    """Return what a rig has that neither the files state nor was written before they were mutated."""
    read = [
        stated_camera((one.K[0][0], one.K[1][1], one.K[0][2], one.K[1][2]), one.dist,
                      np.array(one.T_cam_world), one.size)
        for one in found.cameras.values()
    ]  # fmt: skip
    try:
        stated = example.read(files)
    except Exception as error:  # noqa: BLE001 -- a small reader fails as it likes
        why, stated = f" (the other reader: {type(error).__name__} {error})", meant
    else:
        why = ""
    if len(read) != len(stated):
        return (f"{len(read)} cameras in place of {len(stated)}{why}",)
    return tuple(
        f"camera {number}: {what}{why}"
        for number, (one, other) in enumerate(zip(read, stated, strict=True))
        for what in one.differences(other)
    )
