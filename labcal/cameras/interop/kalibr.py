"""Kalibr's ``camchain.yaml``: cameras ``cam0``, ``cam1``, ... in a chain, in metres.

``T_cn_cnm1`` maps coordinates of the camera before to those of the camera; the first one is the world.
``radtan`` is OpenCV's k1 k2 p1 p2, ``equidistant`` its fisheye's k1 to k4. Of the camera models ``ds``,
``eucm`` and ``omni``, ``intrinsics`` begin with the lens's own coefficients: xi alpha, alpha beta, and xi,
behind which ``omni`` has a ``radtan``. The name of a camera is the topic that its pictures come on, as in
``/left/image_raw``.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

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
    camera_record,
    coefficients_of,
    fisheye_coefficients,
    fisheye_lens,
    held_coefficients,
    named_lens,
    opencv_model,
    perspective_lens,
    refuse_what_only_labcal_holds,
)
from labcal.cameras.interop.numbers_text import finite_number, finite_numbers, number_text, picture_size
from labcal.cameras.interop.placement import (
    MM_IN_M,
    poses_along,
    poses_from_first,
    rig_of,
    rounded_pose,
    steps_along,
)
from labcal.cameras.interop.yaml_tree import read_yaml_tree
from labcal.cameras.lens import DOUBLE_SPHERE, ENHANCED_UNIFIED, OMNIDIRECTIONAL
from labcal.cameras.opencv_model import FISHEYE
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.geometry.poses import inverse
from labcal.run.file_marks import TEXT_COMMENT

_HOLDER = "Kalibr"
_RADTAN = 4
_CAMERA = re.compile(r"cam\d{1,6}")
_AGREES = 1e-3
"""Largest difference of two statements of a pose, relative to its largest number."""
_LENSES = {
    "radtan": (perspective_lens, _RADTAN),
    "equidistant": (fisheye_lens, 4),
    "equi": (fisheye_lens, 4),
    "none": (perspective_lens, 0),
}
_OWN = {
    ("ds", "none"): (DOUBLE_SPHERE, 2, 0),
    ("eucm", "none"): (ENHANCED_UNIFIED, 2, 0),
    ("omni", "radtan"): (OMNIDIRECTIONAL, 1, _RADTAN),
    ("omni", "none"): (OMNIDIRECTIONAL, 1, 0),
}
"""By camera and distortion model: the lens, how many of its coefficients stand before the focal lengths, and
how many are the distortion's. The first of a lens is written."""
_WRITTEN = {lens: words for words, (lens, _, _) in reversed(_OWN.items())}


def recognises(text: str) -> bool:
    """Tell whether a text is a camera chain."""
    first = re.search(r"^[\"']?cam\d+[\"']?:", text, re.MULTILINE)
    return first is not None and "distortion_model:" in text  # of a camera chain, also on an IMU


def read_kalibr(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one chain; the first camera is the world.

    Raises
    ------
    InputError
        The file is damaged, or a camera is of a model that labcal does not have.
    """
    if len(sources) != 1:
        raise InputError("A camchain.yaml holds a whole rig. Give one of them.")
    path = sources[0].path
    content = read_yaml_tree(sources[0].text, path)
    chain: list[dict[str, Any]] = []
    while isinstance(content.get(f"cam{len(chain)}"), dict):
        chain.append(content[f"cam{len(chain)}"])
    if not chain:
        raise InputError(f"{path} is no camera chain of Kalibr: it has no camera 'cam0'.")
    _require_whole(content, chain, path)
    found = [_step(chain, number, path) for number in range(1, len(chain))]
    notes = tuple(note for _, mended in found for note in mended)
    poses = poses_along([step for step, _ in found])
    records = [_camera(camera, T, path) for camera, T in zip(chain, poses, strict=True)]
    return ReadRig(rig_of(_names(chain), records), notes)


def write_kalibr(rig: Rig, _suffix: str) -> RigTexts:
    """Return the chain.

    Raises
    ------
    InputError
        Kalibr has no such lens.
    """
    poses, notes = poses_from_first(rig)
    steps = [None, *steps_along(poses)]
    numbers = range(len(steps))
    entries = []
    for number, (name, record) in enumerate(rig.cameras.items()):
        words, before, behind = _lens(name, record)
        (fx, _, cx), (_, fy, cy), _ = record.K
        lines = [
            f"cam{number}:",
            f"  cam_overlaps: {[other for other in numbers if other != number]}",
            f"  camera_model: {words[0]}",
            f"  intrinsics: {_list((*before, fx, fy, cx, cy))}",
            f"  distortion_model: {words[1]}",
            f"  distortion_coeffs: {_list(behind)}",
            f"  resolution: [{record.size[0]}, {record.size[1]}]",
            f"  rostopic: /{name}/image_raw",
        ]
        step = steps[number]
        if step is not None:
            lines.append("  T_cn_cnm1:")
            lines += [f"  - {_list((*row[:3], row[3] / MM_IN_M))}" for row in step[:3]]
            lines.append("  - [0.0, 0.0, 0.0, 1.0]")
        entries += lines
    return RigTexts((OutputText("", "\n".join(entries) + "\n"),), notes)


def _list(values: Sequence[float]) -> str:
    return f"[{', '.join(number_text(value) for value in values)}]"


def _lens(name: str, record: CameraRecord) -> tuple[tuple[str, str], tuple[float, ...], tuple[float, ...]]:
    """Return camera and distortion model, the coefficients before the focal lengths, and the distortion's."""
    if record.lens in _WRITTEN:
        refuse_what_only_labcal_holds(name, record, _HOLDER)
        words = _WRITTEN[record.lens]
        _, before, behind = _OWN[words]
        return words, record.dist[:before], record.dist[before : before + behind]
    if opencv_model(name, record, _HOLDER) is FISHEYE:
        return ("pinhole", "equidistant"), (), fisheye_coefficients(record)
    held = held_coefficients(name, record, _RADTAN, f"{_HOLDER} (radtan)")
    return ("pinhole", "radtan"), (), held


def _step(chain: Sequence[dict[str, Any]], number: int, path: Path) -> tuple[Pose, tuple[str, ...]]:
    """Return ``T_cam_before``, mm, from the chain or, where it has none, from the places on an IMU."""
    before, camera = chain[number - 1], chain[number]
    if not (_on_imu(camera) and _on_imu(before)):
        if "T_cn_cnm1" not in camera:
            raise InputError(
                f"{path} does not state where cam{number} is: it has no T_cn_cnm1, and not both "
                f"cam{number - 1} and cam{number} have T_cam_imu or T_imu_cam."
            )
        return _matrix(camera, "T_cn_cnm1", number, path)
    T_before_imu, note_before = _from_imu(before, number - 1, path)
    T_cam_imu, note = _from_imu(camera, number, path)
    step, notes = T_cam_imu @ inverse(T_before_imu), note_before + note
    if "T_cn_cnm1" in camera:
        stated, notes = _matrix(camera, "T_cn_cnm1", number, path)
        both = f"T_cn_cnm1 of cam{number}, and the places of cam{number - 1} and cam{number} on the IMU,"
        _require_same(stated, step, both, path)
        step = stated
    return step, notes


def _on_imu(camera: dict[str, Any]) -> bool:
    """Tell whether a camera has its place on an IMU."""
    return "T_cam_imu" in camera or "T_imu_cam" in camera


def _from_imu(camera: dict[str, Any], number: int, path: Path) -> tuple[Pose, tuple[str, ...]]:
    """Return ``T_cam_imu``, mm, also where its inverse is stated (as OpenVINS and Basalt do)."""
    found = []
    if "T_cam_imu" in camera:
        found.append(_matrix(camera, "T_cam_imu", number, path))
    if "T_imu_cam" in camera:
        T_imu_cam, notes = _matrix(camera, "T_imu_cam", number, path)
        found.append((inverse(T_imu_cam), notes))
    _require_same(found[0][0], found[-1][0], f"T_cam_imu and T_imu_cam of cam{number}", path)
    return found[0]


def _require_same(first: Pose, second: Pose, what: str, path: Path) -> None:
    """Raise where two statements of a pose differ by more than rounding."""
    if np.abs(first - second).max() > _AGREES * max(1.0, np.abs(first).max()):
        raise InputError(f"{path}: {what} contradict each other. Leave out the one that does not hold.")


def _matrix(camera: dict[str, Any], key: str, number: int, path: Path) -> tuple[Pose, tuple[str, ...]]:
    """Return a pose, mm."""
    rows = camera.get(key)
    what = f"{key} of cam{number}"
    if isinstance(rows, dict):  # of OpenCV, as other programs write this file
        rows = rows.get("data")
    if isinstance(rows, list) and len(rows) == 16:  # noqa: PLR2004 -- a 4x4 matrix in one list
        rows = [rows[at : at + 4] for at in range(0, 16, 4)]
    if not isinstance(rows, list) or len(rows) != 4:  # noqa: PLR2004 -- a 4x4 matrix
        raise InputError(f"{path}: {what} should be 4 rows of 4 numbers.")
    matrix = np.array([finite_numbers(row, (4,), what, path) for row in rows])
    if not np.array_equal(matrix[3], [0.0, 0.0, 0.0, 1.0]):
        raise InputError(f"{path}: the last row of {what} should be 0 0 0 1.")
    return rounded_pose(matrix[:3, :3], MM_IN_M * matrix[:3, 3], path)


def _require_whole(content: dict[str, Any], chain: Sequence[dict[str, Any]], path: Path) -> None:
    """Raise where a number is left out, or a camera overlaps one that is not there: it may be cut off."""
    more = [key for key in content if _CAMERA.fullmatch(str(key)) and int(key[3:]) >= len(chain)]
    if more:
        raise InputError(
            f"{path} has {more[0]}, but no camera 'cam{len(chain)}' before it, or it holds nothing. Number "
            "the cameras from cam0 without a gap."
        )
    for number, camera in enumerate(chain):
        overlaps = camera.get("cam_overlaps")
        for other in overlaps if isinstance(overlaps, list) else ():
            if finite_number(other, "cam_overlaps", path) >= len(chain):
                raise InputError(
                    f"{path} is truncated: cam{number} overlaps cam{other}, but there is none. Copy it again."
                )


def _camera(camera: dict[str, Any], T_cam_world: Pose, path: Path) -> CameraRecord:
    """Return one camera of the chain."""
    model, distortion = str(camera.get("camera_model")), str(camera.get("distortion_model"))
    own = _OWN.get((model, distortion))
    if own is None and (model != "pinhole" or distortion not in _LENSES):
        raise InputError(
            f"{path}: the camera model {model!r:.40} with the distortion {distortion!r:.40} has no "
            f"counterpart here; pinhole with {', '.join(_LENSES)} has, and "
            f"{', '.join(f'{camera} with {behind}' for camera, behind in _OWN)}. Calibrate with one of these."
        )
    _, before, count = ("", 0, _LENSES[distortion][1]) if own is None else own
    numbers = finite_numbers(camera.get("intrinsics"), (before + 4,), "intrinsics", path)
    what = "distortion_coeffs"
    coefficients = coefficients_of(distortion, camera.get(what), count, what, path)
    if own is None:
        lens = _LENSES[distortion][0](coefficients)
    else:
        lens = named_lens(own[0], (*numbers[:before], *coefficients))
    return camera_record(
        numbers[before:],
        lens,
        T_cam_world,
        picture_size(camera.get("resolution"), path),
        path,
    )


def _names(chain: Sequence[dict[str, Any]]) -> list[str]:
    """Return what the topics call the cameras, or their numbers where that is not plain."""
    named = [re.search(r"([^/]+)/[^/]+$", str(camera.get("rostopic", ""))) for camera in chain]
    names = [found[1] for found in named if found]
    if len(set(names)) == len(chain):
        return names
    return [f"cam{number}" for number in range(len(chain))]


KALIBR = RigFormat(
    "kalibr",
    (".yaml", ".yml"),
    Home.FILE,
    2**17,
    recognises,
    read_kalibr,
    write_kalibr,
    TEXT_COMMENT,
    Unit.METRES,
)
