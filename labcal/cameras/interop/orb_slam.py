"""Settings of ORB-SLAM2 and 3: one camera, or a pair, in metres.

``Camera1.fx`` and so on (version 1.0), or ``Camera.fx``; ``PinHole`` with OpenCV's k1 k2 p1 p2 k3, or
``KannalaBrandt8``, its fisheye. ``Stereo.T_c1_c2`` (``Tlr`` in older files) maps coordinates of the second
camera to those of the first one. ``Rectified`` cameras are one pinhole twice, ``Stereo.b`` apart along x. Of
ORB-SLAM2's pairs the original cameras are read (``LEFT.K``, ``RIGHT.K``), not that of the rectified pictures.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.exchange import NOTHING_GIVEN, ReadOptions, ReadRig, SourceText, Unit
from labcal.cameras.interop.lens_parameters import camera_record
from labcal.cameras.interop.numbers_text import finite_numbers, known_size
from labcal.cameras.interop.placement import MM_IN_M, rig_of, rounded_pose
from labcal.cameras.interop.read_only import read_only_format
from labcal.cameras.interop.ros import rig_of_infos
from labcal.cameras.interop.slam_lenses import brown, fisheye, numbers_by_name
from labcal.cameras.interop.yaml_tree import read_yaml_tree
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError
from labcal.geometry.poses import inverse, pose

_FX = re.compile(r"^Camera1?\.fx:", re.MULTILINE)
_POSES = ("Stereo.T_c1_c2", "Tlr")
_VIRTUAL = (
    "Camera.bf states how far apart rectified cameras are, or a depth camera's projector: one camera is read."
)
_INTRINSICS = ("fx", "fy", "cx", "cy")
_TYPES = ("PinHole", "KannalaBrandt8", "Rectified")
_RECTIFIED = {
    "camera_matrix": "K",
    "distortion_coefficients": "D",
    "rectification_matrix": "R",
    "projection_matrix": "P",
}
"""Keys of a camera_info, and those of an original camera in a file of ORB-SLAM2."""
_AFFINE = (12, 16)
"""Numbers of a pose, without and with its last row."""


def recognises(text: str) -> bool:
    """Tell whether a text is such a file."""
    return _FX.search(text) is not None


def read_orb_slam(sources: Sequence[SourceText], given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one camera, or a pair whose first camera is the world.

    Raises
    ------
    InputError
        The file is damaged, of a lens that labcal does not have, or a pair whose places are not stated; or
        nobody states the size of the pictures.
    """
    if len(sources) != 1:
        raise InputError("Settings of ORB-SLAM hold a whole rig. Give one file.")
    path = sources[0].path
    content = read_yaml_tree(sources[0].text, path)
    if "LEFT.K" in content:
        sides = ("LEFT", "RIGHT")
        return rig_of_infos([_info(content, side) for side in sides], ["left", "right"], [path, path])
    kind = str(content.get("Camera.type", _TYPES[0]))
    if kind not in _TYPES:
        raise InputError(
            f"{path}: the Camera.type {kind!r:.40} has no counterpart here; {', '.join(_TYPES)} have."
        )
    prefix = "Camera1." if "Camera1.fx" in content else "Camera."
    first = _record(content, prefix, np.eye(4), given, path)
    if kind == "Rectified" and "Stereo.b" in content:
        (apart,) = numbers_by_name(("Stereo.b",), content, path)
        T = pose(np.eye(3), np.array([-MM_IN_M * apart, 0.0, 0.0]))
        return _pair(first, _record(content, prefix, T, given, path))
    of_a_pair = [str(key) for key in content if str(key).startswith("Camera2.") or key in _POSES]
    if not of_a_pair and kind != "Rectified":
        return ReadRig(rig_of([path.stem], [first]), (_VIRTUAL,) if "Camera.bf" in content else ())
    if "Camera2.fx" not in content:
        lost = "Camera2.fx" if of_a_pair else "Stereo.b"
        raise InputError(f"{path} is of a pair ({(of_a_pair or [kind])[0]:.40}), but has no {lost}.")
    T_second_first, notes = _pose(content, path)
    return _pair(first, _record(content, "Camera2.", T_second_first, given, path), notes)


def _info(content: Mapping[str, Any], side: str) -> dict[str, Any]:
    """Return one camera of a pair that is rectified by the file, with the keys of ROS."""
    matrices = {key: content.get(f"{side}.{letter}") for key, letter in _RECTIFIED.items()}
    return {
        **matrices,
        "image_width": content.get(f"{side}.width"),
        "image_height": content.get(f"{side}.height"),
        "distortion_model": "plumb_bob",
    }


def _pair(first: CameraRecord, second: CameraRecord, notes: tuple[str, ...] = ()) -> ReadRig:
    return ReadRig(rig_of(["left", "right"], [first, second]), notes)


def _record(
    content: Mapping[str, Any], prefix: str, T_cam_world: Pose, given: ReadOptions, path: Path
) -> CameraRecord:
    """Return one camera."""
    sides = [content.get("Camera.width"), content.get("Camera.height")]
    size = known_size(None if sides == [None, None] else sides, given.size, path)
    numbers = numbers_by_name(_INTRINSICS, content, path, prefix=prefix)
    is_fisheye = content.get("Camera.type") == "KannalaBrandt8"
    lens = (fisheye if is_fisheye else brown)(content, path, prefix=prefix)
    return camera_record(numbers, lens, T_cam_world, size, path)


def _pose(content: Mapping[str, Any], path: Path) -> tuple[Pose, tuple[str, ...]]:
    """Return ``T_second_first``, mm, and a note where its rotation was rounded."""
    key = next((key for key in _POSES if key in content), None)
    if key is None:
        raise InputError(f"{path} holds two cameras, but no {_POSES[0]} that places the second one.")
    matrix = content[key]
    data = matrix.get("data") if isinstance(matrix, dict) else matrix
    numbers = np.array(finite_numbers(data, _AFFINE, key, path)).reshape(-1, 4)
    if not np.array_equal(numbers[3:], np.eye(4)[3 : len(numbers)]):
        raise InputError(f"{path}: the last row of {key} should be 0 0 0 1.")
    T_first_second, notes = rounded_pose(numbers[:3, :3], MM_IN_M * numbers[:3, 3], path)
    return inverse(T_first_second), notes


ORB_SLAM = read_only_format(
    "orb-slam", (".yaml", ".yml"), recognises, read_orb_slam, Unit.METRES, ("unit", "size")
)
