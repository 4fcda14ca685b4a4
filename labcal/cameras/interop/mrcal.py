"""mrcal's ``.cameramodel``: a Python dictionary literal, one camera a file.

Intrinsics are fx fy cx cy and OpenCV's coefficients, pixels count from the centre of the top-left one.
``extrinsics`` is mrcal's rt_fromref: rotation vector and translation that map reference to camera
coordinates; mrcal 3 calls it ``rt_cam_ref``. Files of 2019 say ``DISTORTION_`` for ``LENSMODEL_``. mrcal
knows no units; its users, and its programs' ranges, are in metres, so translations are written and read in
metres. Nothing in the file is executed.
"""

import ast
import re
from collections.abc import Sequence

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
from labcal.cameras.interop.lens_parameters import (
    camera_record,
    coefficient_count,
    held_coefficients,
    perspective_lens,
)
from labcal.cameras.interop.numbers_text import finite_numbers, number_text, picture_size
from labcal.cameras.interop.placement import MM_IN_M, rig_of
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, rotation_vector
from labcal.run.file_marks import TEXT_COMMENT

_HOLDER = "mrcal"
_COEFFICIENTS = {
    "LENSMODEL_PINHOLE": 0,
    "LENSMODEL_OPENCV4": 4,
    "LENSMODEL_OPENCV5": 5,
    "LENSMODEL_OPENCV8": 8,
    "LENSMODEL_OPENCV12": 12,
}
_LARGEST = "LENSMODEL_OPENCV12"
_OLD, _NONE = "DISTORTION_", "DISTORTION_NONE"
"""Names of lens models in mrcal's files of 2019, which call them distortion_model."""
_POSE_KEYS = ("extrinsics", "rt_cam_ref")
# What the model was computed from: megabytes in base 85, which has no quotes and no backslashes.
_INPUTS = re.compile(r"'optimization_inputs'\s*:\s*b'[^'\\]*'\s*,?")
_MOST_LETTERS = 2**17
_NAME = re.compile(r"^# camera: ([A-Za-z0-9-]+)$", re.MULTILINE)


def recognises(text: str) -> bool:
    """Tell whether a text is a camera model."""
    quoted = text.replace('"', "'") if "LENSMODEL_" in text or _OLD in text else ""
    # PhotonVision says lensmodel, too.
    return ("'lensmodel'" in quoted or "'distortion_model'" in quoted) and "'intrinsics'" in quoted


def read_mrcal(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one camera from each file; the world is mrcal's reference.

    Raises
    ------
    InputError
        A file is damaged, or its lens model is another one.
    """
    return ReadRig(rig_of([_name(source) for source in sources], [_camera(source) for source in sources]))


def write_mrcal(rig: Rig, _suffix: str) -> RigTexts:
    """Return one file a camera; the reference is the rig's world.

    Raises
    ------
    InputError
        mrcal has no such lens.
    """
    alone = len(rig.cameras) == 1
    return RigTexts(
        tuple(OutputText("" if alone else name, _text(name, record)) for name, record in rig.cameras.items())
    )


def _text(name: str, record: CameraRecord) -> str:
    """Return the file of one camera."""
    count = coefficient_count(record)
    model = next((model for model, most in _COEFFICIENTS.items() if count <= most), _LARGEST)
    held = held_coefficients(name, record, _COEFFICIENTS[model], f"{_HOLDER} ({model})")
    (fx, _, cx), (_, fy, cy), _ = record.K
    T_cam_world = np.array(record.T_cam_world)
    rt = (*rotation_vector(T_cam_world), *(T_cam_world[:3, 3] / MM_IN_M))
    width, height = record.size
    return (
        f"# camera: {name}\n# Written by labcal. Translations are in metres.\n{{\n"
        f"    'lensmodel': '{model}',\n\n"
        "    # fx, fy, cx, cy, then the distortion coefficients in OpenCV's order\n"
        f"    'intrinsics': [{_list((fx, fy, cx, cy, *held))}],\n\n"
        "    # rt_fromref: rotation vector and translation, reference to camera\n"
        f"    'extrinsics': [{_list(rt)}],\n\n"
        f"    'imagersize': [{width}, {height}],\n}}\n"
    )


def _list(values: Sequence[float]) -> str:
    return ", ".join(number_text(value) for value in values)


def _name(source: SourceText) -> str:
    """Return the name that the file states in its first lines, or that of the file."""
    stated = _NAME.match(source.text)
    return stated[1] if stated else source.path.stem


def _keys(text: str) -> list[str]:
    """Return the keys of a dictionary literal, as often as they occur."""
    body = ast.parse(text, mode="eval").body
    found = body.keys if isinstance(body, ast.Dict) else []
    return [str(key.value) for key in found if isinstance(key, ast.Constant)]


def _present_name(old: object) -> object:
    """Return the present name of a lens model of old files; anything else as it is."""
    if not isinstance(old, str) or not old.startswith(_OLD):
        return old
    return "LENSMODEL_PINHOLE" if old == _NONE else f"LENSMODEL_{old.removeprefix(_OLD)}"


def _camera(source: SourceText) -> CameraRecord:
    """Return the camera of one file."""
    path = source.path
    text = _INPUTS.sub("", source.text).strip()
    if len(text) > _MOST_LETTERS:
        raise InputError(f"{path} is not a camera model of mrcal: it holds far more than a camera.")
    try:
        content = ast.literal_eval(text)
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError) as error:
        raise InputError(
            f"{path} is not a camera model of mrcal: {type(error).__name__}. Copy it again."
        ) from error
    if not isinstance(content, dict):
        raise InputError(f"{path} is not a camera model of mrcal: it holds no dictionary.")
    keys = _keys(text)
    if len(keys) != len(set(keys)):
        raise InputError(f"{path}: a key occurs twice, so that it is not known which holds.")
    model = content.get("lensmodel", _present_name(content.get("distortion_model")))
    if not isinstance(model, str) or model not in _COEFFICIENTS:
        raise InputError(
            f"{path}: the lens model {model!r:.60} has no counterpart here; {', '.join(_COEFFICIENTS)} have. "
            "Convert it with mrcal-convert-lensmodel first."
        )
    wanted = (4 + _COEFFICIENTS[model],)
    numbers = finite_numbers(content.get("intrinsics"), wanted, "intrinsics", path)
    stated = [content[key] for key in _POSE_KEYS if key in content]
    if len(stated) > 1 and stated[0] != stated[1]:
        raise InputError(f"{path}: {' and '.join(_POSE_KEYS)} contradict each other. Leave out one of them.")
    given = next(iter(stated), None)
    rt = np.array(finite_numbers(given, (6,), "extrinsics", path))
    return camera_record(
        numbers[:4],
        perspective_lens(numbers[4:]),
        from_rotation_vector(rt[:3], MM_IN_M * rt[3:]),
        picture_size(content.get("imagersize"), path),
        path,
    )


MRCAL = RigFormat(
    "mrcal",
    (".cameramodel",),
    Home.FILE,
    2**26,
    recognises,
    read_mrcal,
    write_mrcal,
    TEXT_COMMENT,
    Unit.METRES,
)
