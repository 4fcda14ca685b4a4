"""OpenCV's FileStorage, YAML or XML, with the keys of its calibration samples.

One camera: ``camera_matrix``, ``distortion_coefficients``, ``image_width``, ``image_height``, and
``fisheye_model: 1`` for cv2.fisheye; besides them ``R`` and ``T``, the pose as solvePnP gives it (world to
camera). Two cameras: ``M1 D1 M2 D2 R T`` as stereoCalibrate returns them (first camera to second).
Millimetres, where a file states no unit. What follows from these (E, F, and R1 R2 P1 P2 Q of rectification)
is neither written nor read.
"""

import re
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cache

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
)
from labcal.cameras.interop.lens_parameters import (
    coefficient_count,
    fisheye_coefficients,
    held_coefficients,
    opencv_model,
)
from labcal.cameras.interop.mrcal import recognises as is_of_mrcal
from labcal.cameras.interop.numpy_archive import is_archive
from labcal.cameras.interop.opencv_camera import COUNTS, read_camera, sides_of
from labcal.cameras.interop.opencv_keys import ALONE, with_given_keys, with_other_half
from labcal.cameras.interop.opencv_names import DIST, MATRIX, SIDES, named_so, side_keys
from labcal.cameras.interop.opencv_network import is_of_network, read_network
from labcal.cameras.interop.opencv_pair import name_of, read_pair, read_placed, require_whole
from labcal.cameras.interop.opencv_pose import (
    OF_A_CAMERA,
    is_pose_named,
    is_posed,
    read_pose,
    require_no_half,
)
from labcal.cameras.interop.opencv_storage import Content, Storage, read_storage, storage_text
from labcal.cameras.interop.opencv_unit import in_stated_unit
from labcal.cameras.interop.placement import poses_from_first, rig_of
from labcal.cameras.lens import LENGTH
from labcal.cameras.opencv_model import FISHEYE
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.run.file_marks import TEXT_COMMENT

_HOLDER = "OpenCV"
_PAIR = 2


_KEY = re.compile(
    r"""(?:^[ \t]*(?:- )?|[{,]\s{0,200})["']?([A-Za-z_][A-Za-z0-9_.\- ]{0,60}?)["']?[ \t]{0,200}:""",
    re.MULTILINE,
)
_OF_OTHERS = re.compile(
    r"^[ \t]*(projection_matrix|cam\d+|projection_parameters|T_BS|T_B_C|Camera1?\.fx):|\"cameraData\":",
    re.MULTILINE,
)
"""Keys of ROS, Kalibr, programs for robots and DepthAI."""
_OF_ROS = re.compile(r"^[Pp]:", re.MULTILINE)
_SEEN = 2**17


def recognises(text: str) -> bool:
    """Tell whether a text is a FileStorage, or has its usual keys in plain YAML, JSON or an npz."""
    if is_archive(text):
        return True
    if _OF_OTHERS.search(text) is not None or is_of_mrcal(text):
        return False
    if "<opencv_storage>" in text or "opencv-matrix" in text or "opencv-nd-matrix" in text:
        return True
    keys = set(_KEY.findall(text[:_SEEN]))
    of_labcal = "cameras" in keys and bool({"T_cam_world", "lens"} & keys)
    of_ros = "distortion_model" in keys and _OF_ROS.search(text) is not None
    return _names_both(keys) and not (of_labcal or of_ros)


def _names_both(keys: Collection[str]) -> bool:
    """Tell whether there are keys of a camera matrix and of coefficients, of either camera of a pair."""
    return all(named_so(_every_side(names), keys) for names in (MATRIX, DIST))


@cache
def _every_side(names: tuple[str, ...]) -> tuple[str, ...]:
    return (*names, *(key for sides in SIDES for side in sides for key in side_keys(names, side)))


def read_opencv(sources: Sequence[SourceText], given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one pair, also from a file of intrinsics and one of extrinsics, or one camera from each file.

    Raises
    ------
    InputError
        A file is damaged, has no camera, does not state its lens or its picture size, or several cameras have
        no poses.
    """
    stores = with_given_keys([read_storage(source) for source in sources], given.key)
    alone = given.key is not None and ALONE in given.key
    if not given.key and len(stores) == 1 and is_of_network(stores[0]):
        return in_stated_unit(read_network(stores[0], given), stores, given.unit)
    stores, notes = (stores, ()) if alone else with_other_half(stores)
    read = in_stated_unit(_read(stores, given, alone=alone), stores, given.unit)
    return replace(read, notes=(*notes, *read.notes))


def _read(stores: Sequence[Storage], given: ReadOptions, *, alone: bool) -> ReadRig:
    """Return what is in files, with lengths as they stand there; of each its camera alone, or a pair."""
    paired = [] if alone else [storage for storage in stores if sides_of(storage) is not None]
    if paired:
        others = [storage for storage in stores if storage is not paired[0]]
        return read_pair(paired[0], others, given)
    placed = None if alone else read_placed(stores, given)
    if placed is not None:
        return placed
    names, records = [], []
    notes: tuple[str, ...] = ()
    for storage in stores:
        # R and T of a pair place the second camera, not one that a user picks out of it.
        posed = is_posed(storage, OF_A_CAMERA) and (not alone or is_pose_named(storage))
        if storage.mapped & {"R", "T"} and not posed:
            raise InputError(
                f"`key` names R or T, but {storage.path} has not both, which place a camera together. Name "
                "both, or one matrix of both, [R T] in 3 or 4 rows, as R."
            )
        if not alone:
            require_whole(storage)
            require_no_half(storage)
        T_cam_world, mended = read_pose(storage, OF_A_CAMERA) if posed else (np.eye(4), ())
        names.append(name_of(storage))
        records.append(read_camera(storage, "", 0, T_cam_world, given))
        notes += mended
        if len(stores) > 1 and not posed:
            raise InputError(
                f"{storage.path} holds a camera without its pose (R and T), so several cameras cannot be "
                "placed in one world. Convert each file alone; or give two cameras and a file with R and T, "
                "which map coordinates of the first camera to those of the second one; or a stereo file (M1 "
                "D1 M2 D2 R T)."
            )
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
                f"in it. Write each camera alone: `only='{left}'`."
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


def _coefficients(name: str, record: CameraRecord) -> np.ndarray:
    """Return a lens's coefficients as one row, as many as OpenCV takes."""
    if _is_fisheye(name, record):
        return np.array(fisheye_coefficients(record))[None]
    held = held_coefficients(name, record, max(COUNTS), _HOLDER)
    count = min(count for count in COUNTS if count >= max(LENGTH, coefficient_count(record)))
    return np.array(held[:count])[None]


def _is_fisheye(name: str, record: CameraRecord) -> bool:
    """Tell whether a camera's lens is OpenCV's fisheye; raise where it is none of OpenCV's."""
    return opencv_model(name, record, _HOLDER) is FISHEYE


OPENCV = RigFormat(
    "opencv",
    (".yml", ".yaml", ".xml"),
    Home.FILE,
    2**18,
    recognises,
    read_opencv,
    write_opencv,
    TEXT_COMMENT,
    options=("unit", "size", "lens", "key"),
)
