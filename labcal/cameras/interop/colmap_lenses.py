"""COLMAP's camera models and the lens models that they are.

The numbers and names are those of ``src/colmap/sensor/models.h``; ``EUCM`` is there from version 4.1 on.
"""

from collections.abc import Sequence
from pathlib import Path

from labcal.arrays import Pose
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
from labcal.cameras.interop.numbers_text import finite_numbers, picture_size
from labcal.cameras.lens import ENHANCED_UNIFIED
from labcal.cameras.opencv_model import FISHEYE
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError

_HOLDER = "COLMAP"
_HALF_PIXEL = 0.5
COUNTS = {
    "SIMPLE_PINHOLE": 3,
    "PINHOLE": 4,
    "SIMPLE_RADIAL": 4,
    "RADIAL": 5,
    "OPENCV": 8,
    "OPENCV_FISHEYE": 8,
    "FULL_OPENCV": 12,
    "FOV": 5,
    "SIMPLE_RADIAL_FISHEYE": 4,
    "RADIAL_FISHEYE": 5,
    "THIN_PRISM_FISHEYE": 12,
    "RAD_TAN_THIN_PRISM_FISHEYE": 16,
    "SIMPLE_DIVISION": 4,
    "DIVISION": 5,
    "SIMPLE_FISHEYE": 3,
    "FISHEYE": 4,
    "EUCM": 6,
}
"""Number of parameters of each model; its place in this list is its number in binary files."""
_PERSPECTIVE = {
    "SIMPLE_PINHOLE": (1, 0),
    "PINHOLE": (2, 0),
    "SIMPLE_RADIAL": (1, 1),
    "RADIAL": (1, 2),
    "OPENCV": (2, 4),
    "FULL_OPENCV": (2, 8),
}
"""By model: how many focal lengths, and how many of OpenCV's coefficients follow the principal point."""
_FISHEYE = {
    "SIMPLE_RADIAL_FISHEYE": (1, 1),
    "RADIAL_FISHEYE": (1, 2),
    "OPENCV_FISHEYE": (2, 4),
    "SIMPLE_FISHEYE": (1, 0),
    "FISHEYE": (2, 0),
}
_EUCM = {"EUCM": (2, 2)}
"""Alpha and beta."""
_MODELS = _PERSPECTIVE | _FISHEYE | _EUCM


def camera_of(
    model: str, size: Sequence[object], parameters: Sequence[object], T_cam_world: Pose, source: Path
) -> CameraRecord:
    """Return the camera with a model of COLMAP.

    Raises
    ------
    InputError
        labcal has no such lens, or the numbers are none of it.
    """
    if model not in _MODELS:
        raise InputError(
            f"{source}: the camera model {model:.40} has no counterpart here; {', '.join(_MODELS)} have. Use "
            f"one of these."
        )
    focals, count = _MODELS[model]
    numbers = finite_numbers(parameters, (focals + 2 + count,), f"the parameters of {model}", source)
    fx, fy = numbers[0], numbers[focals - 1]
    cx, cy = (value - _HALF_PIXEL for value in numbers[focals : focals + 2])
    coefficients = numbers[focals + 2 :]
    if model in _EUCM:
        lens = named_lens(ENHANCED_UNIFIED, coefficients)
    else:
        lens = (fisheye_lens if model in _FISHEYE else perspective_lens)(coefficients)
    return camera_record((fx, fy, cx, cy), lens, T_cam_world, picture_size(size, source), source)


def parameters_of(name: str, record: CameraRecord) -> tuple[str, tuple[int, int], tuple[float, ...]]:
    """Return COLMAP's model, the size of the pictures (px) and the parameters of a camera.

    Raises
    ------
    InputError
        COLMAP has no such lens.
    """
    model, coefficients = _distortion(name, record)
    (fx, _, cx), (_, fy, cy), _ = record.K
    return model, record.size, (fx, fy, cx + _HALF_PIXEL, cy + _HALF_PIXEL, *coefficients)


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
