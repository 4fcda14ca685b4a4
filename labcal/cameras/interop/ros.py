"""ROS camera_info YAML, as camera_calibration and camera_info_manager write it, one camera a file.

``plumb_bob`` is OpenCV's k1 k2 p1 p2 k3, ``rational_polynomial`` adds k4 k5 k6, ``equidistant`` (also called
``fisheye``) is its fisheye. The file has no pose; that of a pair follows from both files'
``rectification_matrix`` and ``projection_matrix`` (in metres), which hold for the pair rectified as ``labcal
undistort --rectify`` does it.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labcal.arrays import Matrix3, Pose
from labcal.cameras.camera import Camera
from labcal.cameras.ideal import rectified_pair
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
    fisheye_coefficients,
    held_coefficients,
    intrinsics_of,
    opencv_model,
)
from labcal.cameras.interop.numbers_text import finite_numbers, number_text, picture_size
from labcal.cameras.interop.opencv_storage import require_shape
from labcal.cameras.interop.placement import MM_IN_M, poses_from_first, rig_of, rounded_pose
from labcal.cameras.interop.ros_documents import contents_of, is_message, is_of_part, note_on_part
from labcal.cameras.interop.ros_lens import COUNTS, LENSES, NO_MODEL, model_of
from labcal.cameras.opencv_model import FISHEYE
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.geometry.poses import pose
from labcal.run.file_marks import TEXT_COMMENT

_HOLDER = "ROS"
_PAIR = 2
_PLUMB_BOB, _RATIONAL = 5, 8


def recognises(text: str) -> bool:
    """Tell whether a text is a camera_info; old ones do not state their model."""
    if "projection_matrix:" in text:
        return "distortion_model:" in text or ("camera_matrix:" in text and "image_width:" in text)
    return "distortion_model:" in text and is_message(text)


def read_ros(sources: Sequence[SourceText], given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one camera, or a rectified pair from one file or two; the first camera is the world.

    Raises
    ------
    InputError
        A file is damaged, there are more than two, nothing determines where the second camera is or whose
        four coefficients are, or a lens is given for files that state it.
    """
    found = [(content, source.path) for source in sources for content in contents_of(source)]
    contents, paths = [content for content, _ in found], [path for _, path in found]
    names = [str(content.get("camera_name") or "") for content in contents]
    return rig_of_infos(contents, names, paths, given)


def rig_of_infos(
    contents: Sequence[Mapping[str, Any]],
    names: Sequence[str],
    paths: Sequence[Path],
    given: ReadOptions = NOTHING_GIVEN,
) -> ReadRig:
    """Return the rig of one camera_info, or of those of a rectified pair.

    Parameters
    ----------
    contents : sequence of mappings
        With the keys of camera_info files.
    names : sequence of str
        Of the cameras; the file's where one is empty.
    paths : sequence of Path
        The files, for messages.
    given : ReadOptions
        Its lens decides where four coefficients have no model.

    Raises
    ------
    InputError
        As of :func:`read_ros`.
    """
    poses = [np.eye(4)]
    notes: tuple[str, ...] = ()
    if len(contents) > _PAIR:
        raise InputError("ROS files hold one camera, or a rectified pair. Give one or two of them.")
    if len(contents) == _PAIR:
        T_second_first, notes = _pair_pose(contents, paths)
        poses.append(T_second_first)
    parts = zip(contents, poses, paths, strict=True)
    cameras = [_camera(content, T, given, path) for content, T, path in parts]
    notes += tuple(note_on_part(content, path) for content, path in zip(contents, paths, strict=True)
                   if is_of_part(content))  # fmt: skip
    return ReadRig(
        rig_of([name or path.stem for name, path in zip(names, paths, strict=True)], cameras), notes
    )


def write_ros(rig: Rig, _suffix: str) -> RigTexts:
    """Return one file a camera.

    Raises
    ------
    InputError
        ROS has no such lens, or there are more than two cameras.
    """
    if len(rig.cameras) > _PAIR:
        names = list(rig.cameras)
        raise InputError(
            f"ROS files hold the poses of a pair at most, and this rig has {len(names)} cameras. Choose two "
            f"of them: `only='{','.join(names[:2])}'`."
        )
    poses, notes = poses_from_first(rig)
    held = {name: _distortion(name, record) for name, record in rig.cameras.items()}
    if len(poses) == 1:
        ((name, record),) = rig.cameras.items()
        P = np.concatenate([np.array(record.K), np.zeros((3, 1))], axis=1)
        return RigTexts((OutputText("", _text(name, record, held[name], (np.eye(3), P))),), notes)
    cameras = [
        Camera(np.array(record.K), record.lens, np.array(record.dist), T, record.size)
        for record, T in zip(rig.cameras.values(), poses, strict=True)
    ]
    files = []
    for (name, record), camera, ideal in zip(
        rig.cameras.items(), cameras, rectified_pair(cameras[0], cameras[1]), strict=True
    ):
        R_ideal_cam = ideal.T_cam_world[:3, :3] @ camera.T_cam_world[:3, :3].T
        along = float(ideal.T_cam_world[0, :3] @ (cameras[0].centre - camera.centre)) / MM_IN_M
        P = np.concatenate([ideal.K, [[ideal.K[0, 0] * along], [0.0], [0.0]]], axis=1)
        files.append(OutputText(name, _text(name, record, held[name], (R_ideal_cam, P))))
    return RigTexts(tuple(files), notes)


def _text(
    name: str,
    record: CameraRecord,
    distortion: tuple[str, tuple[float, ...]],
    rectified: tuple[Matrix3, np.ndarray],
) -> str:
    """Return the file of one camera; `rectified` is its rectification and projection matrix."""
    model, coefficients = distortion
    R, P = rectified
    return (
        f"image_width: {record.size[0]}\nimage_height: {record.size[1]}\ncamera_name: '{name}'\n"
        f"camera_matrix:\n{_matrix(np.array(record.K))}"
        f"distortion_model: {model}\n"
        f"distortion_coefficients:\n{_matrix(np.array(coefficients)[None])}"
        f"rectification_matrix:\n{_matrix(R)}"
        f"projection_matrix:\n{_matrix(P)}"
    )


def _matrix(values: np.ndarray) -> str:
    data = ", ".join(number_text(value) for value in values.ravel())
    return f"  rows: {values.shape[0]}\n  cols: {values.shape[1]}\n  data: [{data}]\n"


def _data(content: Mapping[str, Any], key: str, counts: Sequence[int], path: Path) -> tuple[float, ...]:
    """Return the numbers of a matrix."""
    matrix = content.get(key)
    if not isinstance(matrix, dict):
        raise InputError(f"{path} has no {key} with rows, cols and data.")
    numbers = finite_numbers(matrix.get("data"), counts, key, path)
    require_shape(matrix, len(numbers), key, path)
    return numbers


def _camera(content: Mapping[str, Any], T_cam_world: Pose, given: ReadOptions, path: Path) -> CameraRecord:
    """Return the camera of one file."""
    model = content.get("distortion_model")
    stated = _data(content, "distortion_coefficients", COUNTS, path) if model in NO_MODEL else ()
    lens, counts = LENSES[model_of(model, stated, given, path)]
    return camera_record(
        intrinsics_of(_data(content, "camera_matrix", (9,), path), path),
        lens(_data(content, "distortion_coefficients", counts, path)),
        T_cam_world,
        picture_size([content.get("image_width"), content.get("image_height")], path),
        path,
    )


def _pair_pose(contents: Sequence[Mapping[str, Any]], paths: Sequence[Path]) -> tuple[Pose, tuple[str, ...]]:
    """Return ``T_second_first``, mm, of a rectified pair."""
    turns, shifts = [], []
    for content, path in zip(contents, paths, strict=True):
        turns.append(np.array(_data(content, "rectification_matrix", (9,), path)).reshape(3, 3))
        P = np.array(_data(content, "projection_matrix", (12,), path)).reshape(3, 4)
        if abs(np.linalg.det(P[:, :3])) == 0.0:
            raise InputError(f"{path}: the projection_matrix is singular.")
        shifts.append(MM_IN_M * np.linalg.solve(P[:, :3], P[:, 3]))
    step = shifts[1] - shifts[0]
    if not np.any(step):
        same = paths[0] == paths[1]
        raise InputError(
            f"{paths[0]} {'does' if same else f'and {paths[1]} do'} not state how far apart the cameras are: "
            "both projection matrices have the same fourth column, as those of cameras that were calibrated "
            f"alone. Convert each {'document, in a file of its own' if same else 'file'}, alone."
        )
    first, note_first = rounded_pose(turns[0], np.zeros(3), paths[0])
    second, note_second = rounded_pose(turns[1], np.zeros(3), paths[1])
    R_cam_ideal = second[:3, :3].T
    return pose(R_cam_ideal @ first[:3, :3], R_cam_ideal @ step), note_first + note_second


def _distortion(name: str, record: CameraRecord) -> tuple[str, tuple[float, ...]]:
    """Return ROS's distortion model and its coefficients."""
    if opencv_model(name, record, _HOLDER) is FISHEYE:
        return "equidistant", fisheye_coefficients(record)
    held = held_coefficients(name, record, _RATIONAL, f"{_HOLDER} (rational_polynomial)")
    return ("rational_polynomial", held) if any(held[_PLUMB_BOB:]) else ("plumb_bob", held[:_PLUMB_BOB])


ROS = RigFormat(
    "ros",
    (".yaml", ".yml"),
    Home.FILE,
    2**17,
    recognises,
    read_ros,
    write_ros,
    TEXT_COMMENT,
    Unit.METRES,
    options=("unit", "lens"),
)
