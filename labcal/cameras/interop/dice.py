"""DICe's camera system file (XML), and the cameras in a project file of VIC-3D, which is read only.

DICe (Sandia National Laboratories, ``DICe_CameraSystem.cpp``): a Teuchos ParameterList with a list ``CAMERA
0``, ``CAMERA 1`` ... for each camera; ``OPENCV_LENS_DISTORTION`` is OpenCV's model with all 14 coefficients.
TX TY TZ and ``rotation_3x3_matrix`` (or ALPHA BETA GAMMA, degrees) map world to camera; with
``extrinsics_relative_camera_to_camera`` those of the second camera map the first one's coordinates to its
own. Millimetres are written, and taken for granted.
"""

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

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
from labcal.cameras.interop.lens_parameters import camera_record, held_coefficients, perspective_lens
from labcal.cameras.interop.numbers_text import finite_number, finite_numbers, known_size, number_text
from labcal.cameras.interop.placement import rig_of, rounded_pose
from labcal.cameras.interop.vic3d import PROJECT, read_project
from labcal.cameras.interop.xml_tree import read_xml_tree
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.geometry.poses import from_fixed_angles_deg
from labcal.run.file_marks import TEXT_COMMENT

_HOLDER = "DICe"
_LIST, _PARAMETER = "ParameterList", "Parameter"
_MOST_CAMERAS = 9
_FORMAT = ("xml_file_format", "DICe_xml_camera_system_file")
_RELATIVE = "extrinsics_relative_camera_to_camera"
_ROTATION = "rotation_3x3_matrix"
_OF_USERS = "user_"
"""Beginning of lists that turn the results of DICe, not its cameras."""
_COEFFICIENTS = ("K1", "K2", "P1", "P2", "K3", "K4", "K5", "K6", "S1", "S2", "S3", "S4", "T1", "T2")
"""In OpenCV's order."""
_SHIFT, _ANGLES = ("TX", "TY", "TZ"), ("ALPHA", "BETA", "GAMMA")
_ROWS = ("ROW 0", "ROW 1", "ROW 2")
_KNOWN = frozenset(
    {"CAMERA_ID", "CX", "CY", "FX", "FY", "FS", "LENS_DISTORTION_MODEL", "IMAGE_HEIGHT_WIDTH", "PIXEL_DEPTH"}
    | {"CAMERA_LENS", "COMMENTS", *_COEFFICIENTS, *_SHIFT, *_ANGLES}
)
"""Parameters of a camera. DICe leaves out those that are zero, so that a strange name would be one lost."""
_NO_LENS, _OPENCV_LENS = "NO_LENS_DISTORTION", "OPENCV_LENS_DISTORTION"


def recognises(text: str) -> bool:
    """Tell whether a text is a camera system, or a project of VIC-3D."""
    return _FORMAT[1] in text or ("<project" in text and "<camera" in text)


def read_dice(sources: Sequence[SourceText], given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one file.

    Raises
    ------
    InputError
        It is damaged, of an older form, or a camera has skew or another lens model.
    """
    if len(sources) != 1:
        raise InputError("A camera system file of DICe holds a whole rig. Give one of them.")
    path = sources[0].path
    root = read_xml_tree(sources[0].text, path)
    if root.tag == PROJECT:
        return read_project(root, path, given.size)
    values = _values(root)
    if values.get(_FORMAT[0]) != _FORMAT[1]:
        raise InputError(
            f"{path} is no camera system file of DICe: it should hold the parameter {_FORMAT[0]} with the "
            f"value {_FORMAT[1]}. Older files ('cal_file_ID') are converted by opening and saving them in "
            "DICe."
        )
    cameras = _cameras(root, path)
    for camera in cameras:
        _require_known(camera, path)
    found = [_pose(camera, path) for camera in cameras]
    poses = [T for T, _ in found]
    if values.get(_RELATIVE, "false").lower() == "true":
        poses = [poses[0], *(T @ poses[0] for T in poses[1:])]
    records = [_camera(camera, T, given, path) for camera, T in zip(cameras, poses, strict=True)]
    names = [_values(camera).get("CAMERA_ID") or str(camera.get("name")) for camera in cameras]
    return ReadRig(rig_of(names, records), tuple(note for _, mended in found for note in mended))


def _cameras(root: ET.Element, path: Path) -> list[ET.Element]:
    """Return the lists of the cameras, none of which is left out."""
    lists = {child.get("name", ""): child for child in root if child.tag == _LIST}
    if len(lists) < sum(child.tag == _LIST for child in root):
        raise InputError(f"{path}: a camera occurs twice.")
    cameras: list[ET.Element] = []
    while f"CAMERA {len(cameras)}" in lists:
        cameras.append(lists[f"CAMERA {len(cameras)}"])
    if not cameras:
        raise InputError(f"{path} holds no 'CAMERA 0'.")
    strange = [name for name in lists if not name.startswith(_OF_USERS) and lists[name] not in cameras]
    if strange:
        raise InputError(
            f"{path} has a list '{strange[0]:.40}' behind {len(cameras)} cameras. Cameras are called 'CAMERA "
            "0', 'CAMERA 1' and so on, without a gap."
        )
    return cameras


def write_dice(rig: Rig, _suffix: str) -> RigTexts:
    """Return one camera system file, in the rig's world.

    Raises
    ------
    InputError
        DICe has no such lens, or there are too many cameras.
    """
    if len(rig.cameras) > _MOST_CAMERAS:
        raise InputError(
            f"DICe takes {_MOST_CAMERAS} cameras at most, and this rig has {len(rig.cameras)}. Choose some: "
            f"`only='{','.join(list(rig.cameras)[:2])}'`."
        )
    root = ET.Element(_LIST)
    _add(root, "string", *_FORMAT)
    _add(root, "string", "system_type_3D", "OPENCV")
    _add(root, "bool", _RELATIVE, "false")
    for number, (name, record) in enumerate(rig.cameras.items()):
        _add_camera(ET.SubElement(root, _LIST, {"name": f"CAMERA {number}"}), name, record)
    ET.indent(root)
    return RigTexts((OutputText("", ET.tostring(root, encoding="unicode") + "\n"),))


def _add(parent: ET.Element, kind: str, name: str, value: str) -> None:
    """Add a parameter to a list."""
    ET.SubElement(parent, _PARAMETER, {"name": name, "type": kind, "value": value})


def _add_camera(parent: ET.Element, name: str, record: CameraRecord) -> None:
    """Fill the list of one camera."""
    held = held_coefficients(name, record, len(_COEFFICIENTS), _HOLDER)
    (fx, _, cx), (_, fy, cy), _ = record.K
    R, t = np.array(record.T_cam_world)[:3, :3], np.array(record.T_cam_world)[:3, 3]
    _add(parent, "string", "CAMERA_ID", name)
    for key, value in (
        ("CX", cx),
        ("CY", cy),
        ("FX", fx),
        ("FY", fy),
        *zip(_COEFFICIENTS, held, strict=True),
    ):
        _add(parent, "double", key, number_text(value))
    _add(parent, "string", "LENS_DISTORTION_MODEL", _OPENCV_LENS)
    for key, value in zip(_SHIFT, t, strict=True):
        _add(parent, "double", key, number_text(value))
    rotation = ET.SubElement(parent, _LIST, {"name": _ROTATION})
    for at, row in enumerate(R):
        _add(rotation, "string", f"ROW {at}", f"{{ {', '.join(number_text(value) for value in row)} }}")
    _add(parent, "string", "IMAGE_HEIGHT_WIDTH", f"{{ {record.size[1]}, {record.size[0]} }}")


def _values(element: ET.Element) -> dict[str, str]:
    """Return the parameters of a list, by name."""
    found = [(child.get("name", ""), child.get("value", "")) for child in element if child.tag == _PARAMETER]
    names = [name for name, _ in found]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"The parameter {twice:.40} occurs twice in one list. Leave one of them.")
    return dict(found)


def _require_known(camera: ET.Element, path: Path) -> None:
    """Raise where a camera's list holds what DICe's have not, since what is missing counts as zero."""
    strange = []
    for child in camera:
        name = child.get("name", "")
        known = name in _KNOWN if child.tag == _PARAMETER else (child.tag, name) == (_LIST, _ROTATION)
        strange += [] if known else [f"{child.tag} {name}"]
        strange += [row.get("name", "") for row in child if row.get("name") not in _ROWS]
    if strange:
        raise InputError(
            f"{path}: '{strange[0]:.40}' of {camera.get('name', ''):.40} is not known in a camera system "
            "file of DICe. Correct the name, or leave it out."
        )


def _array(text: str | None) -> list[str]:
    """Return the elements of a Teuchos array, as in ``{ 1, 2 }``."""
    return (text or "").strip().strip("{}").split(",")


def _pose(camera: ET.Element, path: Path) -> tuple[Pose, tuple[str, ...]]:
    """Return the pose of a camera's list, mm."""
    values = _values(camera)
    t = np.array([finite_number(values.get(key, "0"), key, path) for key in _SHIFT])
    for child in camera:
        if child.get("name") == _ROTATION:
            rows = [_array(_values(child).get(row)) for row in _ROWS]
            R = np.array([finite_numbers(row, (3,), _ROTATION, path) for row in rows])
            return rounded_pose(R, t, path)
    angles = [finite_number(values.get(key, "0"), key, path) for key in _ANGLES]
    return rounded_pose(from_fixed_angles_deg(angles), t, path)


def _camera(camera: ET.Element, T_cam_world: Pose, given: ReadOptions, path: Path) -> CameraRecord:
    """Return the camera of one list."""
    values = _values(camera)
    skew = finite_number(values.get("FS", "0"), "FS", path)
    model = values.get("LENS_DISTORTION_MODEL", _NO_LENS).upper()
    if skew != 0.0 or model not in {_NO_LENS, _OPENCV_LENS}:
        raise InputError(
            f"{path}: {camera.get('name')} has the lens model {model:.40} and the skew FS = {skew:g}, which "
            f"labcal's cameras do not have. Calibrate with {_OPENCV_LENS} and without skew."
        )
    numbers = [finite_number(values.get(key), key, path) for key in ("FX", "FY", "CX", "CY")]
    coefficients = [finite_number(values.get(key, "0"), key, path) for key in _COEFFICIENTS]
    if any(coefficients) and "LENS_DISTORTION_MODEL" not in values:
        raise InputError(
            f"{path}: {camera.get('name')} has coefficients of a lens, but no LENS_DISTORTION_MODEL. Add it: "
            f"{_OPENCV_LENS}."
        )
    if model == _NO_LENS:
        coefficients = []
    height, width = finite_numbers(_array(values.get("IMAGE_HEIGHT_WIDTH")), (2,), "IMAGE_HEIGHT_WIDTH", path)
    size = known_size([width, height], given.size, path)
    return camera_record(numbers, perspective_lens(coefficients), T_cam_world, size, path)


DICE = RigFormat(
    "dice",
    (".xml",),
    Home.FILE,
    2**24,
    recognises,
    read_dice,
    write_dice,
    TEXT_COMMENT,
    options=("unit", "size"),
)
