"""Basalt's ``calibration.json``: cameras on an IMU, in metres.

``T_imu_cam`` maps coordinates of each camera to those of the IMU (place and quaternion). Camera types:
``pinhole``, ``pinhole-radtan8`` (OpenCV's k1 k2 p1 p2 k3 to k6), ``kb4`` (its fisheye), ``ds``, ``eucm``, and
``ucm``, which is ``eucm`` with a beta of 1.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.colmap_model import placed
from labcal.cameras.interop.exchange import NOTHING_GIVEN, ReadOptions, ReadRig, SourceText, Unit
from labcal.cameras.interop.lens_parameters import camera_record
from labcal.cameras.interop.numbers_text import picture_size
from labcal.cameras.interop.placement import MM_IN_M, rig_of
from labcal.cameras.interop.read_only import read_only_format
from labcal.cameras.interop.slam_lenses import (
    Lens,
    brown,
    double_sphere,
    enhanced_unified,
    fisheye,
    numbers_by_name,
    rational,
    unified,
)
from labcal.errors import InputError
from labcal.geometry.poses import inverse
from labcal.run.json_reading import json_content

_LENSES: dict[str, Callable[[Mapping[str, object], Path], Lens]] = {
    "pinhole": brown,
    "pinhole-radtan8": rational,
    "kb4": fisheye,
    "ds": double_sphere,
    "eucm": enhanced_unified,
    "ucm": unified,
}
_PLACE = ("qw", "qx", "qy", "qz", "px", "py", "pz")


def recognises(text: str) -> bool:
    """Tell whether a text is such a file."""
    return '"T_imu_cam"' in text and '"camera_type"' in text


def read_basalt(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read a rig; the first camera is the world.

    Raises
    ------
    InputError
        The file is damaged, or a camera is of a lens that labcal does not have.
    """
    if len(sources) != 1:
        raise InputError("A calibration of Basalt holds a whole rig. Give one file.")
    path = sources[0].path
    content = json_content(sources[0].text, str(path))
    outer = content.get("value0", content) if isinstance(content, dict) else {}
    places, cameras, sizes = (_list(outer, key, path) for key in ("T_imu_cam", "intrinsics", "resolution"))
    if not len(places) == len(cameras) == len(sizes) >= 1:
        raise InputError(
            f"{path} has {len(places)} T_imu_cam, {len(cameras)} intrinsics and {len(sizes)} resolution, "
            "which should be one of each for every camera."
        )
    on_imu = [_on_imu(place, path) for place in places]
    to_first = inverse(on_imu[0])
    poses = [np.eye(4), *(T_cam_imu @ to_first for T_cam_imu in on_imu[1:])]
    records = []
    for camera, size, T in zip(cameras, sizes, poses, strict=True):
        kind = camera.get("camera_type") if isinstance(camera, dict) else None
        numbers = camera.get("intrinsics") if isinstance(camera, dict) else None
        if kind not in _LENSES or not isinstance(numbers, dict):
            raise InputError(
                f"{path}: the camera type {kind!r:.40} has no counterpart here; {', '.join(_LENSES)} have."
            )
        four = numbers_by_name(("fx", "fy", "cx", "cy"), numbers, path)
        records.append(camera_record(four, _LENSES[kind](numbers, path), T, picture_size(size, path), path))
    return ReadRig(rig_of([f"cam{number}" for number in range(len(records))], records))


def _list(content: Mapping[str, Any], key: str, path: Path) -> list[Any]:
    found = content.get(key)
    if not isinstance(found, list):
        raise InputError(f"{path} is no calibration of Basalt: it has no list '{key}'.")
    return found


def _on_imu(place: object, path: Path) -> Pose:
    """Return ``T_cam_imu``, mm."""
    if not isinstance(place, dict):
        raise InputError(f"{path}: an entry of T_imu_cam should have px to pz and qx to qw.")
    numbers = numbers_by_name(_PLACE, place, path)
    T_imu_cam = placed(numbers, "T_imu_cam", path)
    T_imu_cam[:3, 3] *= MM_IN_M
    return inverse(T_imu_cam)


BASALT = read_only_format("basalt", (".json",), recognises, read_basalt, Unit.METRES)
