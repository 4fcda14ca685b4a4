"""COLMAP's text model: a folder with ``cameras.txt``, ``images.txt`` and ``points3D.txt``.

COLMAP counts pixels from the corner of the top-left one, whose centre is (0.5, 0.5): the principal point is
shifted here and nowhere else. An image's quaternion (w x y z) and translation map world to camera, whose axes
are labcal's. COLMAP has no units; labcal writes millimetres and takes a model for millimetres.
"""

import re
from collections.abc import Sequence
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
)
from labcal.cameras.interop.lens_parameters import (
    camera_record,
    fisheye_coefficients,
    fisheye_lens,
    held_coefficients,
    named_lens,
    opencv_model,
    perspective_lens,
    refuse_what_only_labcal_holds,
)
from labcal.cameras.interop.numbers_text import finite_numbers, number_text, picture_size
from labcal.cameras.interop.placement import rig_of
from labcal.cameras.lens import ENHANCED_UNIFIED
from labcal.cameras.opencv_model import FISHEYE
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.geometry.poses import from_quaternion, pose, quaternion
from labcal.run.file_marks import TEXT_COMMENT

_HOLDER = "COLMAP"
_HALF_PIXEL = 0.5
_CAMERAS, _IMAGES, _POINTS = "cameras.txt", "images.txt", "points3D.txt"
_PERSPECTIVE = {
    "SIMPLE_PINHOLE": (1, 0),
    "PINHOLE": (2, 0),
    "SIMPLE_RADIAL": (1, 1),
    "RADIAL": (1, 2),
    "OPENCV": (2, 4),
    "FULL_OPENCV": (2, 8),
}
"""By model: how many focal lengths, and how many of OpenCV's coefficients follow the principal point."""
_FISHEYE = {"SIMPLE_RADIAL_FISHEYE": (1, 1), "RADIAL_FISHEYE": (1, 2), "OPENCV_FISHEYE": (2, 4)}
_EUCM = {"EUCM": (2, 2)}
"""Alpha and beta; COLMAP has it from version 4.1 on."""
_MODELS = _PERSPECTIVE | _FISHEYE | _EUCM
_CAMERA_LINE = rf"^\d+ ({'|'.join(_MODELS)}|FOV|THIN_PRISM_FISHEYE) \d+ \d+ |CAMERA_ID, MODEL, WIDTH, HEIGHT"
_CAMERA_WORDS = 4
_IMAGE_WORDS = 10


def recognises(text: str) -> bool:
    """Tell whether a text is a list of cameras."""
    return re.search(_CAMERA_LINE, text, re.MULTILINE) is not None


def read_colmap(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read the texts of one folder; each camera must have taken one image, which gives its pose.

    Raises
    ------
    InputError
        A file is missing or damaged, a camera model has no counterpart, or a camera has more than one place.
    """
    by_name = {source.path.name: source for source in sources}
    if _CAMERAS not in by_name or _IMAGES not in by_name:
        raise InputError(f"A model of COLMAP is a folder with {_CAMERAS} and {_IMAGES}. Give the folder.")
    images = _images(by_name[_IMAGES])
    cameras = _lines(by_name[_CAMERAS])
    names, records = [], []
    notes: tuple[str, ...] = ()
    listed = [line for line in cameras if line]
    for line in listed:
        words = line.split()
        taken = [image for image in images if image[0] == words[0]]
        if len(listed) == 1 and len(taken) != 1:
            note = f"Camera {words[0]:.20} took {len(taken)} images: its lens is read, no place of it."
            notes += (note,)
            taken = [(words[0], f"camera-{words[0]}", np.eye(4))]
        if len(taken) != 1:
            raise InputError(
                f"{by_name[_IMAGES].path}: camera {words[0]:.20} took {len(taken)} images. A rig's camera "
                "has one place: keep one image of each camera."
            )
        _, name, T_cam_world = taken[0]
        names.append(Path(name).stem)
        records.append(_camera(words, T_cam_world, by_name[_CAMERAS].path))
    if not records:
        raise InputError(f"{by_name[_CAMERAS].path} lists no camera.")
    return ReadRig(rig_of(names, records), notes)


def write_colmap(rig: Rig, _suffix: str) -> RigTexts:
    """Return the three texts, with one image a camera.

    Raises
    ------
    InputError
        COLMAP has no such lens.
    """
    cameras: list[str] = []
    images: list[str] = []
    points: list[str] = []
    for number, (name, record) in enumerate(rig.cameras.items(), start=1):
        model, coefficients = _distortion(name, record)
        (fx, _, cx), (_, fy, cy), _ = record.K
        numbers = (fx, fy, cx + _HALF_PIXEL, cy + _HALF_PIXEL, *coefficients)
        cameras.append(f"{number} {model} {record.size[0]} {record.size[1]} {_words(numbers)}")
        T_cam_world = np.array(record.T_cam_world)
        place = (*quaternion(T_cam_world[:3, :3]), *T_cam_world[:3, 3])
        images.append(f"{number} {_words(place)} {number} {name}.png\n")
    texts = (
        (_CAMERAS, "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]", cameras),
        (
            _IMAGES,
            "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)",
            images,
        ),
        (_POINTS, "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)", points),
    )
    return RigTexts(tuple(OutputText(name, "\n".join([head, *lines]) + "\n") for name, head, lines in texts))


def _words(values: Sequence[float]) -> str:
    return " ".join(number_text(value) for value in values)


def _lines(source: SourceText) -> list[str]:
    """Return the lines that are no comments."""
    return [line.strip() for line in source.text.splitlines() if not line.lstrip().startswith("#")]


def _images(source: SourceText) -> list[tuple[str, str, Pose]]:
    """Return camera, name and pose of each image; every second line lists points and may be empty."""
    found = []
    for line in _lines(source)[::2]:
        words = line.split(maxsplit=_IMAGE_WORDS - 1)
        if not words:
            continue
        if len(words) != _IMAGE_WORDS:
            raise InputError(f"{source.path}: '{line:.60}' is no line of an image.")
        numbers = finite_numbers(words[1:8], (7,), "a pose", source.path)
        wxyz = np.array(numbers[:4])
        if abs(np.linalg.norm(wxyz) - 1.0) > 1e-3:  # noqa: PLR2004 -- rounded to few digits
            raise InputError(f"{source.path}: the quaternion in '{line:.60}' has not the length 1.")
        found.append((words[8], words[9], pose(from_quaternion(wxyz), np.array(numbers[4:]))))
    return found


def _camera(words: Sequence[str], T_cam_world: Pose, path: Path) -> CameraRecord:
    """Return the camera of one line."""
    if len(words) < _CAMERA_WORDS:
        raise InputError(f"{path}: '{' '.join(words):.60}' is no line of a camera.")
    model = words[1]
    if model not in _MODELS:
        raise InputError(
            f"{path}: the camera model {model:.40} has no counterpart here; {', '.join(_MODELS)} have. Use "
            f"one of these."
        )
    focals, count = _MODELS[model]
    numbers = finite_numbers(words[4:], (focals + 2 + count,), f"the parameters of {model}", path)
    fx, fy = numbers[0], numbers[focals - 1]
    cx, cy = (value - _HALF_PIXEL for value in numbers[focals : focals + 2])
    coefficients = numbers[focals + 2 :]
    if model in _EUCM:
        lens = named_lens(ENHANCED_UNIFIED, coefficients)
    else:
        lens = (fisheye_lens if model in _FISHEYE else perspective_lens)(coefficients)
    size = picture_size(words[2:4], path)
    return camera_record((fx, fy, cx, cy), lens, T_cam_world, size, path)


def _distortion(name: str, record: CameraRecord) -> tuple[str, tuple[float, ...]]:
    """Return COLMAP's model and its coefficients."""
    if record.lens == ENHANCED_UNIFIED:
        refuse_what_only_labcal_holds(name, record, _HOLDER)
        return "EUCM", record.dist[: _EUCM["EUCM"][1]]
    if opencv_model(name, record, _HOLDER) is FISHEYE:
        return "OPENCV_FISHEYE", fisheye_coefficients(record)
    held = held_coefficients(name, record, 8, f"{_HOLDER} (FULL_OPENCV)")
    if not any(held):
        return "PINHOLE", ()
    return ("FULL_OPENCV", held) if any(held[4:]) else ("OPENCV", held[:4])


COLMAP = RigFormat(
    "colmap", (".txt",), Home.FOLDER, 2**26, recognises, read_colmap, write_colmap, TEXT_COMMENT
)
