"""TOML of aniposelib, as Anipose, Caliscope and Pose2Sim write it: a table for each camera.

``[cam_0]`` (in Caliscope's own file ``[cameras.0]``) holds ``name``, ``size``, ``matrix``, ``distortions``
(of cv2.calibrateCamera, or with ``fisheye = true`` of cv2.fisheye), ``rotation`` (a rotation vector, in older
files of Caliscope a matrix) and ``translation``, which map world to camera; see ``Camera.load_dict`` in
``aniposelib/cameras.py``. Lengths are in the unit of the board: millimetres with most boards of Anipose,
metres in Caliscope and Pose2Sim. labcal writes millimetres and states that as ``unit`` in ``[metadata]``,
which the others skip.
"""

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from labcal.arrays import Pose
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
from labcal.cameras.interop.lens_parameters import (
    FISHEYE_COEFFICIENTS,
    camera_record,
    fisheye_coefficients,
    fisheye_lens,
    held_coefficients,
    intrinsics_of,
    opencv_model,
    perspective_lens,
)
from labcal.cameras.interop.numbers_text import finite_numbers, known_size, number_text
from labcal.cameras.interop.opencv_camera import COUNTS
from labcal.cameras.interop.opencv_lens import given_fisheye
from labcal.cameras.interop.placement import rig_of, rounded_pose
from labcal.cameras.lens import FISHEYE as FISHEYE_LENS
from labcal.cameras.opencv_model import FISHEYE
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, rotation_vector
from labcal.run.file_marks import TEXT_COMMENT

_HOLDER = "aniposelib"
_NESTED = "cameras"
_OF_A_CAMERA = {"matrix", "distortions", "rotation", "translation"}
_SIZE = "size"
_HELD = 5
Table = Mapping[str, object]


def recognises(text: str) -> bool:
    """Tell whether a text is such a list of cameras."""
    return all(re.search(rf"^\s*{key}\s*=\s*\[", text, re.MULTILINE) for key in ("matrix", "distortions"))


def read_anipose(sources: Sequence[SourceText], given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one file.

    Raises
    ------
    InputError
        It is damaged, a camera of several has no place, or nothing determines its picture size or its lens.
    """
    if len(sources) != 1:
        raise InputError("A TOML file of cameras holds a whole rig. Give one of them.")
    path = sources[0].path
    try:
        content = tomllib.loads(sources[0].text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path} is not valid TOML: {str(error) or type(error).__name__:.200}.") from error
    nested = content.get(_NESTED)
    tables = {**content, **(nested if isinstance(nested, dict) else {})}
    cameras = {key: one for key, one in tables.items() if isinstance(one, dict) and _OF_A_CAMERA & set(one)}
    if not cameras or _OF_A_CAMERA & set(content):
        raise InputError(
            f"{path} should hold each camera as a table, such as [cam_0], with matrix and distortions"
            + (", but has these outside of any table. Copy it again." if cameras else ".")
        )
    names, records = [], []
    left_out = [key for key, one in tables.items() if isinstance(one, dict) and key not in cameras
                and _SIZE in one]  # fmt: skip
    notes: tuple[str, ...] = tuple(f"[{key}] has no matrix: it is left out." for key in left_out)
    for key, camera in cameras.items():
        posed = "rotation" in camera and "translation" in camera
        if not posed and (len(cameras) > 1 or {"rotation", "translation"} & set(camera)):
            raise InputError(f"{path}: [{key}] has no rotation and translation, so its camera has no place.")
        T_cam_world, mended = _pose(camera, key, path) if posed else (np.eye(4), ())
        stated = camera.get("name")
        names.append(stated if isinstance(stated, str) and stated else f"cam-{key}" if key.isdigit() else key)
        records.append(_camera(camera, key, T_cam_world, given, path))
        notes += mended
    return ReadRig(rig_of(names, records), notes, _stated_unit(content, path))


def write_anipose(rig: Rig, _suffix: str) -> RigTexts:
    """Return one file, in the rig's world and in millimetres.

    Raises
    ------
    InputError
        aniposelib has no such lens.
    """
    entries = []
    for number, (name, record) in enumerate(rig.cameras.items()):
        fisheye = opencv_model(name, record, _HOLDER) is FISHEYE
        held = fisheye_coefficients(record) if fisheye else held_coefficients(name, record, _HELD, _HOLDER)
        T = np.array(record.T_cam_world)
        entries.append(
            f'[cam_{number}]\nname = "{name}"\nsize = [{record.size[0]}, {record.size[1]}]\n'
            f"matrix = [{', '.join(_list(row) for row in record.K)}]\n"
            f"distortions = {_list(held)}\n"
            f"rotation = {_list(rotation_vector(T).tolist())}\ntranslation = {_list(T[:3, 3].tolist())}\n"
            f"fisheye = {str(fisheye).lower()}\n"
        )
    entries.append('[metadata]\nunit = "mm"\n')
    return RigTexts((OutputText("", "\n".join(entries)),))


def _list(values: Sequence[float]) -> str:
    return f"[{', '.join(number_text(value) for value in values)}]"


def _stated_unit(content: Table, path: Path) -> Unit | None:
    """Return the unit in the metadata, where there is one."""
    metadata = content.get("metadata")
    stated = metadata.get("unit", metadata.get("units")) if isinstance(metadata, dict) else None
    if stated is None:
        return None
    if stated not in [unit.value for unit in Unit]:
        raise InputError(f"{path}: the unit {stated!r:.40} is neither mm nor m.")
    return Unit(stated)


def _rows(value: object) -> object:
    """Return the rows of a matrix as one list; anything else as it is."""
    nested = isinstance(value, list) and value and all(isinstance(row, list) for row in value)
    return [number for row in value for number in row] if nested and isinstance(value, list) else value


def _pose(camera: Table, key: str, path: Path) -> tuple[Pose, tuple[str, ...]]:
    """Return a camera's pose, and a note if a rounded rotation was corrected."""
    turn = np.array(finite_numbers(_rows(camera["rotation"]), (3, 9), f"rotation of [{key}]", path))
    t = np.array(finite_numbers(_rows(camera["translation"]), (3,), f"translation of [{key}]", path))
    if turn.shape == t.shape:  # a rotation vector
        return from_rotation_vector(turn, t), ()
    return rounded_pose(turn.reshape(3, 3), t, path)


def _camera(camera: Table, key: str, T_cam_world: Pose, given: ReadOptions, path: Path) -> CameraRecord:
    """Return the camera of one table."""
    numbers = finite_numbers(_rows(camera.get("matrix")), (9,), f"matrix of [{key}]", path)
    coefficients = finite_numbers(_rows(camera.get("distortions")), COUNTS, f"distortions of [{key}]", path)
    stated = camera.get("fisheye")
    if not isinstance(stated, (bool, type(None))):
        raise InputError(f"{path}: fisheye of [{key}] should be true or false.")
    wanted = given_fisheye(given)
    if stated is not None and wanted is not None and stated != wanted:
        raise InputError(
            f"{path} states of [{key}] that its lens is {'a' if stated else 'no'} fisheye, but "
            f"`lens='{given.lens}'` states otherwise. Leave that out."
        )
    fisheye = wanted if stated is None else stated
    if fisheye is None and len(coefficients) == FISHEYE_COEFFICIENTS:
        raise InputError(
            f"{path}: [{key}] has four distortions, which are k1 k2 p1 p2 of cv2.calibrateCamera or k1 to k4 "
            f"of cv2.fisheye, and no key fisheye. Give it: `lens='brown5'` or `lens='{FISHEYE_LENS}'`."
        )
    if (fisheye and len(coefficients) < FISHEYE_COEFFICIENTS) or (fisheye and any(coefficients[4:])):
        raise InputError(f"{path}: a fisheye has 4 distortions, but [{key}] has {len(coefficients)}.")
    lens = fisheye_lens(coefficients[:4]) if fisheye else perspective_lens(coefficients)
    size = known_size(camera.get("size"), given.size, path, f"the pictures of [{key}]")
    return camera_record(intrinsics_of(numbers, path), lens, T_cam_world, size, path)


ANIPOSE = RigFormat(
    "anipose",
    (".toml",),
    Home.FILE,
    2**20,
    recognises,
    read_anipose,
    write_anipose,
    TEXT_COMMENT,
    options=("unit", "size", "lens"),
    unit_is_usual=False,
)
