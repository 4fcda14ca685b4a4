"""MatchID's ``.caldat``: a line ``label;value`` for each number of a stereo pair.

MatchID publishes no description. What is public are programs that write and read such files and agree:
pyvale (UKAEA) and what is built on OpenCorr use kappa 1 to 3, P1 and P2 as OpenCV's k1, k2, k3, p1 and p2.
Theta, Phi and Psi turn about the fixed axes x, y and z in this order, in degrees, and with Tx, Ty, Tz (mm)
map coordinates of camera 0 to those of camera 1. Older files count cameras from 1. There is no size of the
pictures in them, and nobody states where pixels count from; labcal takes the centre of the first one.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from labcal.cameras.interop.exchange import (
    NOTHING_GIVEN,
    Home,
    OutputText,
    ReadOptions,
    ReadRig,
    RigFormat,
    RigTexts,
    SourceText,
    Unit,
)
from labcal.cameras.interop.lens_parameters import camera_record, held_coefficients, perspective_lens
from labcal.cameras.interop.numbers_text import finite_number, known_size, number_text
from labcal.cameras.interop.placement import poses_from_first, rig_of
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.geometry.poses import fixed_angles_deg, from_fixed_angles_deg, pose
from labcal.run.file_marks import TEXT_COMMENT

_HOLDER = "MatchID"
_PAIR = 2
_COEFFICIENTS = ("Kappa 1", "Kappa 2", "P1", "P2", "Kappa 3")
"""In OpenCV's order."""
_SHIFT, _TURN = ("Tx", "Ty", "Tz"), ("Theta", "Phi", "Psi")
_LABEL = re.compile(r"^cam([012])_fx\b.*;", re.MULTILINE | re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d*([eE][-+]?\d+)?", re.ASCII)
_UNIT = re.compile(r"\[([^\]]*)\]")
_DEGREES, _RADIANS = {"", "deg", "degree", "degrees", "\u00b0"}, {"rad", "radian", "radians"}
_PIXELS, _PLAIN = {"", "pixels", "pixel", "px"}, {"", "-", "1"}
"""Words for the units of Fx, Fy, Fs, Cx and Cy, and of coefficients."""
_ORIGIN = (
    "MatchID does not publish where its pixels count from: taken for the centre of the first one, as of "
    "OpenCV."
)


def recognises(text: str) -> bool:
    """Tell whether a text is such a file."""
    return len(set(_LABEL.findall(text))) == _PAIR


def read_matchid(sources: Sequence[SourceText], given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one pair.

    Raises
    ------
    InputError
        A label is missing, occurs twice or has no number, a unit is another one than this program writes,
        there is skew, or no size is given.
    """
    if len(sources) != 1:
        raise InputError("A .caldat holds a pair. Give one of them.")
    source = sources[0]
    path, values = source.path, _values(source)
    numbers = sorted({label[3] for label in values if re.match(r"cam\d_fx", label)})
    if len(numbers) != _PAIR:
        raise InputError(f"{path} is no .caldat: it should hold Cam0_Fx and Cam1_Fx, each with a number.")
    size = known_size(None, given.size, path)
    units = _units(source)
    t = np.array([_number(values, label, path) for label in _SHIFT])
    angles = np.array([_number(values, label, path) for label in _TURN])
    angles_deg = np.degrees(angles) if _in_radians(units, path) else angles
    poses = [np.eye(4), pose(from_fixed_angles_deg(angles_deg.tolist()), t)]
    records = []
    for camera, T in zip(numbers, poses, strict=True):
        one = {name: _number(values, f"Cam{camera}_{name}", path)
               for name in ("Fx", "Fy", "Cx", "Cy", "Fs", *_COEFFICIENTS)}  # fmt: skip
        if one["Fs"] != 0.0:
            raise InputError(f"{path}: camera {camera} has a skew, which labcal's cameras do not have.")
        lens = perspective_lens([one[name] for name in _COEFFICIENTS])
        intrinsics = [one[name] for name in ("Fx", "Fy", "Cx", "Cy")]
        records.append(camera_record(intrinsics, lens, T, size, path))
    return ReadRig(
        rig_of([f"cam{number}" for number in numbers], records), (_ORIGIN,), _stated_unit(units, path)
    )


def write_matchid(rig: Rig, _suffix: str) -> RigTexts:
    """Return one file of a pair; the first camera is the world.

    Raises
    ------
    InputError
        MatchID has no such lens, or it is no pair.
    """
    held = {
        name: held_coefficients(name, record, len(_COEFFICIENTS), _HOLDER)
        for name, record in rig.cameras.items()
    }
    if len(rig.cameras) != _PAIR:
        names = ",".join(list(rig.cameras)[:_PAIR])
        mend = f"Choose two: `only='{names}'`." if len(rig.cameras) > _PAIR else "Choose another format."
        raise InputError(
            f"A .caldat of MatchID holds two cameras, and this rig has {len(rig.cameras)}. {mend}"
        )
    (_, T), notes = poses_from_first(rig)
    lines = []
    for number, (name, record) in enumerate(rig.cameras.items()):
        coefficients = dict(zip(_COEFFICIENTS, held[name], strict=True))
        (fx, _, cx), (_, fy, cy), _ = record.K
        labels = {"Fx [pixels]": fx, "Fy [pixels]": fy, "Fs [pixels]": 0.0}
        labels |= {label: coefficients[label] for label in sorted(coefficients)} | {
            "Cx [pixels]": cx,
            "Cy [pixels]": cy,
        }
        lines += [f"Cam{number}_{label};{number_text(value)}" for label, value in labels.items()]
    lines += [f"{label} [mm];{number_text(value)}" for label, value in zip(_SHIFT, T[:3, 3], strict=True)]
    angles = fixed_angles_deg(T[:3, :3])
    lines += [f"{label} [deg];{number_text(value)}" for label, value in zip(_TURN, angles, strict=True)]
    sizes = " and ".join(f"{one.size[0]}x{one.size[1]}" for one in rig.cameras.values())
    lost = (
        f"A .caldat states neither the names of the cameras ({', '.join(rig.cameras)}) nor the size of the "
        f"pictures ({sizes})."
    )
    return RigTexts((OutputText("", "\n".join(lines) + "\n"),), (*notes, lost, _ORIGIN))


def _values(source: SourceText) -> dict[str, str]:
    """Return what stands behind each label, which is without its unit, blanks and capital letters."""
    values: dict[str, str] = {}
    for line in source.text.splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        label, separator, value = line.partition(";")
        name = _plain(label)
        if not separator or name in values:
            what = "occurs twice" if separator else "should be a label, ';' and a number"
            raise InputError(f"{source.path}: '{line.strip():.60}' {what}.")
        values[name] = value.strip()
    # The separator is ';', so that commas are those of a computer with decimal commas, if no point is there.
    if not any("." in number for number in values.values()):
        commas = [name for name, number in values.items() if _DECIMAL_COMMA.fullmatch(number)]
        values |= {name: values[name].replace(",", ".") for name in commas}
    return values


def _units(source: SourceText) -> dict[str, str]:
    """Return the unit in brackets behind each label, in small letters; empty where there is none.

    Raises
    ------
    InputError
        Pixels or coefficients have another one than they can have.
    """
    units = {}
    for line in source.text.splitlines():
        label = line.partition(";")[0]
        found = _UNIT.search(label)
        name = _plain(label)
        units[name] = word = found[1].strip().lower() if found else ""
        in_pixels = re.fullmatch(r"cam\d_[fc][xys]", name) is not None
        if name.startswith("cam") and word not in (_PIXELS if in_pixels else _PLAIN):
            should = "be in [pixels]" if in_pixels else "have no unit"
            raise InputError(f"{source.path}: '{label.strip():.60}' should {should}. Convert its number.")
    return units


def _plain(label: str) -> str:
    """Return a label without its unit, blanks and capital letters."""
    return re.sub(r"\s", "", _UNIT.sub("", label)).lower()


def _in_radians(units: Mapping[str, str], path: Path) -> bool:
    """Tell whether Theta, Phi and Psi are in radians; they are in degrees where nothing is stated.

    Raises
    ------
    InputError
        They are in neither, or not in one of both all three.
    """
    words = {units.get(label.lower(), "") for label in _TURN}
    if not (words <= _DEGREES or words <= _RADIANS):
        raise InputError(
            f"{path}: Theta, Phi and Psi should be in [deg] or in [rad], all three, but are in "
            f"{' and '.join(f'[{word}]'[:20] if word else 'none' for word in sorted(words))}. Convert them."
        )
    return words <= _RADIANS


def _stated_unit(units: Mapping[str, str], path: Path) -> Unit | None:
    """Return the unit that the labels of Tx, Ty and Tz state; None for mm, which all of them say."""
    words = {units.get(label.lower(), "") for label in _SHIFT} - {""}
    if len(words) > 1 or not words <= {unit.value for unit in Unit}:
        raise InputError(f"{path}: Tx, Ty and Tz should be in mm or in m, all three.")
    return Unit.METRES if words == {Unit.METRES.value} else None


def _number(values: Mapping[str, str], label: str, path: Path) -> float:
    """Return the number behind a label."""
    return finite_number(values.get(label.replace(" ", "").lower()), label, path)


MATCHID = RigFormat(
    "matchid",
    (".caldat",),
    Home.FILE,
    2**16,
    recognises,
    read_matchid,
    write_matchid,
    TEXT_COMMENT,
    options=("unit", "size"),
)
