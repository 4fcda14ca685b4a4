"""Cameras of OpenCV's calibration of many (cv::multicalib of ccalib), in one file.

``camera_matrix_0``, ``camera_distortion_0``, with omnidirectional lenses ``xi_0``, and ``camera_pose_0``,
4x4, for each camera. A pose maps coordinates of the first camera to those of the camera.
"""

import re

from labcal.cameras.interop.exchange import ReadOptions, ReadRig
from labcal.cameras.interop.numbers_text import finite_number
from labcal.cameras.interop.opencv_camera import read_camera
from labcal.cameras.interop.opencv_pose import whole_pose
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.interop.placement import rig_of
from labcal.errors import InputError

_COUNT, _PARTS = "nCameras", ("camera_matrix", "camera_distortion", "camera_pose")
_PART = re.compile(rf"({'|'.join(_PARTS)})_\d+")
_MOST = 1000


def is_of_network(storage: Storage) -> bool:
    """Tell whether a file is one of these."""
    return {_COUNT, *(f"{part}_0" for part in _PARTS)} <= set(storage.content)


def read_network(storage: Storage, given: ReadOptions) -> ReadRig:
    """Return the rig of all cameras, with lengths as they stand in the file.

    Raises
    ------
    InputError
        The file is damaged, a camera of those that it counts is missing, or it has more of them.
    """
    count = finite_number(storage.content[_COUNT], _COUNT, storage.path)
    numbers = range(max(0, int(min(count, _MOST))))
    wanted = {f"{part}_{number}" for part in _PARTS for number in numbers}
    there = {key for key in map(str, storage.content) if _PART.fullmatch(key)}
    if count != len(numbers) or there != wanted:
        raise InputError(
            f"{storage.path} states {count:g} cameras ({_COUNT}), but has not {', '.join(_PARTS)} of each of "
            "them, or those of more. Copy it again, or name the keys of one: `key='camera_matrix=KEY'`."
        )
    found = [whole_pose(storage, f"{_PARTS[2]}_{number}") for number in numbers]
    records = [
        read_camera(storage, f"_{number}", 0, T_cam_first, given)
        for number, (T_cam_first, _) in zip(numbers, found, strict=True)
    ]
    names = [f"camera-{number}" for number in numbers]
    return ReadRig(rig_of(names, records), tuple(dict.fromkeys(note for _, notes in found for note in notes)))
