"""OpenCV's FileStorage, YAML or XML, with the keys of its calibration samples.

One camera: ``camera_matrix``, ``distortion_coefficients``, ``image_width``, ``image_height``, and
``fisheye_model: 1`` for cv2.fisheye; besides them ``R`` and ``T``, the pose as solvePnP gives it (world to
camera). Two cameras: ``M1 D1 M2 D2 R T`` as stereoCalibrate returns them (first camera to second).
Millimetres. What follows from these (E, F, and R1 R2 P1 P2 Q of rectification) is neither written nor read.
"""

from collections.abc import Sequence

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.exchange import Home, OutputText, ReadRig, RigFormat, RigTexts, SourceText
from labcal.cameras.interop.lens_numbers import (
    FISHEYE_COEFFICIENTS,
    camera_record,
    coefficient_count,
    fisheye_coefficients,
    fisheye_lens,
    held_coefficients,
    intrinsics_of,
    opencv_model,
    perspective_lens,
)
from labcal.cameras.interop.numbers_text import finite_number, picture_size
from labcal.cameras.interop.opencv_storage import Content, Storage, read_storage, storage_text
from labcal.cameras.interop.placement import poses_from_first, rig_of, rounded_pose
from labcal.cameras.lens import LENGTH
from labcal.cameras.opencv_model import FISHEYE
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError

_HOLDER = "OpenCV"
_COUNTS = (0, 4, 5, 8, 12, 14)
_MATRIX = ("camera_matrix", "cameraMatrix", "K", "M")
_DIST = ("distortion_coefficients", "distCoeffs", "dist_coeffs", "D")
_PAIR_MATRIX = ("M{}", "K{}", "cameraMatrix{}", "camera_matrix{}")
_PAIR_DIST = ("D{}", "distCoeffs{}", "dist_coeffs{}")
_PAIR = 2


def recognises(text: str) -> bool:
    """Tell whether a text is a FileStorage with a camera in it."""
    ours = "<opencv_storage>" in text or "opencv-matrix" in text
    return ours and any(key in text for key in ("camera_matrix", "cameraMatrix", "K:", "M1", "K1", "<K>"))


def read_opencv(sources: Sequence[SourceText]) -> ReadRig:
    """Read one pair, or one camera from each file.

    Raises
    ------
    InputError
        A file is damaged, has no camera, or several cameras have no poses.
    """
    stores = [read_storage(source) for source in sources]
    if len(stores) == 1 and stores[0].first(_pair_keys(_PAIR_MATRIX, 1)) is not None:
        return _read_pair(stores[0])
    names, records = [], []
    notes: tuple[str, ...] = ()
    for storage in stores:
        posed = storage.first(("R",)) is not None and storage.first(("T",)) is not None
        if len(stores) > 1 and not posed:
            raise InputError(
                f"{storage.path} holds a camera without its pose (R and T), so several cameras cannot be "
                "placed in one world. Convert each file alone, or a stereo file (M1 D1 M2 D2 R T)."
            )
        T_cam_world, mended = _pose(storage) if posed else (np.eye(4), ())
        names.append(storage.text("camera_name") or storage.path.stem)
        records.append(_camera(storage, _MATRIX, _DIST, T_cam_world))
        notes += mended
    return ReadRig(rig_of(names, records), notes)


def write_opencv(rig: Rig, suffix: str) -> RigTexts:
    """Return a stereo file of two cameras, else a file a camera.

    Raises
    ------
    InputError
        OpenCV has no such lens, or the pair differs in picture size or kind of lens.
    """
    if len(rig.cameras) == _PAIR:
        return _write_pair(rig, suffix)
    alone = len(rig.cameras) == 1
    files = []
    for name, record in rig.cameras.items():
        T_cam_world = np.array(record.T_cam_world)
        content: Content = {
            "camera_name": name,
            "image_width": record.size[0],
            "image_height": record.size[1],
            "fisheye_model": int(_is_fisheye(name, record)),
            "camera_matrix": np.array(record.K),
            "distortion_coefficients": _coefficients(name, record),
            "R": T_cam_world[:3, :3],
            "T": T_cam_world[:3, 3:],
        }
        files.append(OutputText("" if alone else name, storage_text(content, suffix)))
    return RigTexts(tuple(files))


def _write_pair(rig: Rig, suffix: str) -> RigTexts:
    """Return the stereo file of two cameras."""
    (left, first), (right, second) = rig.cameras.items()
    for what, a, b in (
        ("size of the pictures", first.size, second.size),
        ("kind of lens", _is_fisheye(left, first), _is_fisheye(right, second)),
    ):
        if a != b:
            raise InputError(
                f"OpenCV's stereo file holds one {what} for both cameras, but '{left}' and '{right}' differ "
                f"in it. Write each camera alone: --only {left}."
            )
    (_, T_right_left), notes = poses_from_first(rig)
    content: Content = {
        "camera_name1": left,
        "camera_name2": right,
        "image_width": first.size[0],
        "image_height": first.size[1],
        "fisheye_model": int(_is_fisheye(left, first)),
        "M1": np.array(first.K),
        "D1": _coefficients(left, first),
        "M2": np.array(second.K),
        "D2": _coefficients(right, second),
        "R": T_right_left[:3, :3],
        "T": T_right_left[:3, 3:],
    }
    return RigTexts((OutputText("", storage_text(content, suffix)),), notes)


def _read_pair(storage: Storage) -> ReadRig:
    """Return the rig of a stereo file."""
    T_right_left, notes = _pose(storage)
    records = [
        _camera(storage, _pair_keys(_PAIR_MATRIX, number), _pair_keys(_PAIR_DIST, number), T)
        for number, T in ((1, np.eye(4)), (2, T_right_left))
    ]
    names = [storage.text("camera_name1") or "left", storage.text("camera_name2") or "right"]
    return ReadRig(rig_of(names, records), notes)


def _pair_keys(keys: tuple[str, ...], number: int) -> tuple[str, ...]:
    return tuple(key.format(number) for key in keys)


def _camera(
    storage: Storage, matrix: tuple[str, ...], dist: tuple[str, ...], T_cam_world: Pose
) -> CameraRecord:
    """Return the camera whose matrix and coefficients have one of these keys."""
    path = storage.path
    numbers = intrinsics_of(storage.matrix(matrix, (9,)), path)
    size = _size(storage)
    coefficients = storage.matrix(dist, _COUNTS)
    fisheye = storage.first(("fisheye_model",))
    if fisheye is not None and finite_number(fisheye, "fisheye_model", path) != 0.0:
        if len(coefficients) != FISHEYE_COEFFICIENTS:
            raise InputError(f"{path}: a fisheye has 4 coefficients, but there are {len(coefficients)}.")
        return camera_record(numbers, fisheye_lens(coefficients), T_cam_world, size, path)
    return camera_record(numbers, perspective_lens(coefficients), T_cam_world, size, path)


def _size(storage: Storage) -> tuple[int, int]:
    """Return the size of the pictures."""
    width, height = storage.first(("image_width", "width")), storage.first(("image_height", "height"))
    listed = storage.first(("image_size", "imageSize", "img_size"))
    if width is None and height is None and listed is None:
        raise InputError(
            f"{storage.path} does not say how large the pictures are. Add the keys image_width and "
            f"image_height."
        )
    return picture_size(listed if width is None and height is None else [width, height], storage.path)


def _pose(storage: Storage) -> tuple[Pose, tuple[str, ...]]:
    """Return what R and T say."""
    R = np.array(storage.matrix(("R",), (9,))).reshape(3, 3)
    return rounded_pose(R, np.array(storage.matrix(("T",), (3,))), storage.path)


def _coefficients(name: str, record: CameraRecord) -> np.ndarray:
    """Return a lens's coefficients as one row, as many as OpenCV takes."""
    if _is_fisheye(name, record):
        return np.array(fisheye_coefficients(record))[None]
    held = held_coefficients(name, record, max(_COUNTS), _HOLDER)
    count = min(count for count in _COUNTS if count >= max(LENGTH, coefficient_count(record)))
    return np.array(held[:count])[None]


def _is_fisheye(name: str, record: CameraRecord) -> bool:
    """Tell whether a camera's lens is OpenCV's fisheye; raise where it is none of OpenCV's."""
    return opencv_model(name, record, _HOLDER) is FISHEYE


OPENCV = RigFormat(
    "opencv", (".yml", ".yaml", ".xml"), Home.FILE, 2**18, recognises, read_opencv, write_opencv
)
