"""What files of cameras state, by readers that share no code with labcal: the judge of what it reads.

They are as small as the format allows, take the first thing that stands there, and fail with whatever error
comes where something is missing. Pixels and millimetres, as in labcal.
"""

import ast
import json
import re
import struct
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import yaml
from scipy.io import loadmat
from scipy.spatial.transform import Rotation

Files = Mapping[str, bytes]
"""Content of files by name, in the order in which they are given."""
_ROUNDED = 2e-6
"""A matrix that is a rotation but for so much may be taken as it stands, or for the nearest one."""
_COLMAP = ("SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "OPENCV_FISHEYE", "FULL_OPENCV")


@dataclass(frozen=True)
class Stated:
    """One camera as its file states it."""

    fx: float
    fy: float
    cx: float
    cy: float
    dist: tuple[float, ...]
    """Without zeros at the end."""
    T_cam_world: np.ndarray
    size: tuple[int, int] | None

    def differences(self, other: "Stated") -> list[str]:
        """Return what differs by more than rounding."""
        found = [
            name
            for name in ("fx", "fy", "cx", "cy")
            if not np.isclose(getattr(self, name), getattr(other, name), rtol=1e-12, atol=1e-12)
        ]
        if len(self.dist) != len(other.dist) or not np.allclose(self.dist, other.dist, rtol=1e-12, atol=0):
            found.append("dist")
        if None not in (self.size, other.size) and self.size != other.size:
            found.append("size")
        far = max(1.0, float(np.abs(other.T_cam_world).max()))
        if not np.allclose(self.T_cam_world, other.T_cam_world, rtol=0.0, atol=_ROUNDED * far):
            found.append("pose")
        return found


def stated_camera(
    numbers: Sequence[Any], dist: Sequence[Any], T: np.ndarray, size: Sequence[Any] | None
) -> Stated:
    """Return a camera of fx, fy, cx, cy and so on, which may be words."""
    coefficients = [float(value) for value in dist]
    while coefficients and coefficients[-1] == 0.0:
        coefficients.pop()
    sides = None if size is None else (int(float(size[0])), int(float(size[1])))
    fx, fy, cx, cy = (float(value) for value in numbers)
    return Stated(fx, fy, cx, cy, tuple(coefficients), sound(T), sides)


def sound(T: np.ndarray) -> np.ndarray:
    """Return a pose with the rotation that is nearest to the one stated."""
    U, _, Vt = np.linalg.svd(T[:3, :3])
    clean = np.eye(4)
    clean[:3, :3], clean[:3, 3] = U @ Vt, T[:3, 3]
    return clean


def posed(R: Any, t: Any, scale: float = 1.0) -> np.ndarray:
    """Return a pose of a rotation and a translation times `scale`."""
    T = np.eye(4)
    T[:3, :3] = np.array(R, dtype=float).reshape(3, 3)
    T[:3, 3] = scale * np.array(t, dtype=float).ravel()
    return T


def of_K(K: Any) -> tuple[float, float, float, float]:
    """Return fx, fy, cx, cy."""
    K = np.array(K, dtype=float).reshape(3, 3)
    return K[0, 0], K[1, 1], K[0, 2], K[1, 2]


def _labcal(files: Files) -> list[Stated]:
    (data,) = files.values()
    cameras = json.loads(data.decode("utf-8-sig"))["cameras"].values()
    return [
        stated_camera(of_K(one["K"]), one["dist"], np.array(one["T_cam_world"], dtype=float), one["size"])
        for one in cameras
    ]


def yaml_words(data: bytes) -> Any:
    """Return what a YAML text holds, in words."""
    text = data.decode("utf-8-sig", "replace")
    return yaml.load(re.sub(r"\A%YAML:[^\n]*\n", "", text), yaml.BaseLoader)  # noqa: S506 -- words only


def _opencv(files: Files) -> list[Stated]:
    (data,) = files.values()
    return _opencv_content(yaml_words(data))


def _opencv_xml(files: Files) -> list[Stated]:
    (data,) = files.values()
    root = ET.fromstring(data.decode("utf-8-sig", "replace"))  # noqa: S314 -- made here
    content: dict[str, Any] = {}
    for one in root:
        content[one.tag] = (one.findtext("data") or "").split() if len(one) else (one.text or "").strip()
    return _opencv_content(content)


def _opencv_json(files: Files) -> list[Stated]:
    (data,) = files.values()
    return _opencv_content(yaml_words(data.replace(b"\t", b" ")))


def _opencv_npz(files: Files) -> list[Stated]:
    (data,) = files.values()
    with np.load(BytesIO(data), allow_pickle=False) as archive:
        content = {key: archive[key].ravel().tolist() for key in archive}
    width, height = content["image_size"]
    return _opencv_content({**content, "image_width": width, "image_height": height})


def _opencv_content(content: Mapping[str, Any]) -> list[Stated]:
    """Return the cameras of the keys of OpenCV's samples."""

    def numbers(key: str) -> list[float]:
        value = content[key]
        rows = value["data"] if isinstance(value, dict) else value
        return [float(one) for row in rows for one in (row if isinstance(row, list) else [row])]

    size = (content["image_width"], content["image_height"])
    if "M1" not in content:
        T = posed(numbers("R"), numbers("T")) if {"R", "T"} <= set(content) else np.eye(4)
        return [stated_camera(of_K(numbers("camera_matrix")), numbers("distortion_coefficients"), T, size)]
    second = posed(numbers("R"), numbers("T"))
    return [stated_camera(of_K(numbers(f"M{side}")), numbers(f"D{side}"), T, size)
            for side, T in ((1, np.eye(4)), (2, second))]  # fmt: skip


def _mrcal(files: Files) -> list[Stated]:
    found = []
    for data in files.values():
        content = ast.literal_eval(data.decode("utf-8-sig", "replace"))
        rt = np.array(content.get("extrinsics", content.get("rt_cam_ref")), dtype=float)
        T = posed(Rotation.from_rotvec(rt[:3]).as_matrix(), rt[3:], 1000.0)
        intrinsics = content["intrinsics"]
        found.append(stated_camera(intrinsics[:4], intrinsics[4:], T, content["imagersize"]))
    return found


def _kalibr(files: Files) -> list[Stated]:
    (data,) = files.values()
    content, found, T = yaml_words(data), [], np.eye(4)
    for number in range(100):
        camera = content.get(f"cam{number}")
        if not isinstance(camera, dict):
            break
        if number > 0:
            step = np.array([[float(value) for value in row] for row in camera["T_cn_cnm1"]])
            T = sound(posed(step[:3, :3], step[:3, 3], 1000.0)) @ T
        dist = camera["distortion_coeffs"]
        found.append(stated_camera(camera["intrinsics"], dist, T, camera["resolution"]))
    return found


def _ros(files: Files) -> list[Stated]:
    return stated_infos([yaml_words(data) for data in files.values()])


def stated_infos(cameras: Sequence[Any]) -> list[Stated]:
    """Return the cameras of one camera_info, or of those of a rectified pair."""

    def numbers(camera: Any, key: str) -> np.ndarray:
        return np.array([float(value) for value in camera[key]["data"]])

    poses = [np.eye(4)]
    if len(cameras) > 1:
        turns = [sound(posed(numbers(one, "rectification_matrix"), np.zeros(3)))[:3, :3] for one in cameras]
        P = [numbers(one, "projection_matrix").reshape(3, 4) for one in cameras]
        centres = [-np.linalg.solve(one[:, :3], one[:, 3]) for one in P]  # in the rectified frame
        t = turns[1].T @ (centres[0] - centres[1])
        poses.append(posed(turns[1].T @ turns[0], t, 1000.0))
    return [
        stated_camera(of_K(numbers(one, "camera_matrix")), numbers(one, "distortion_coefficients").tolist(),
                      T, (one["image_width"], one["image_height"]))
        for one, T in zip(cameras, poses, strict=True)
    ]  # fmt: skip


def _seven(numbers: Sequence[Any], scale: float = 1.0) -> np.ndarray:
    w, x, y, z, *t = (float(value) for value in numbers)
    return posed(Rotation.from_quat([x, y, z, w]).as_matrix(), t, scale)


def _colmap_camera(model: str, numbers: Sequence[float], T: np.ndarray, size: Sequence[Any]) -> Stated:
    """Return a camera of a model of COLMAP, whose pixels count from a corner."""
    if model in {"SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL"}:
        numbers = (numbers[0], *numbers)
    cx, cy = numbers[2] - 0.5, numbers[3] - 0.5
    return stated_camera((*numbers[:2], cx, cy), numbers[4:], T, size)


def _colmap(files: Files) -> list[Stated]:
    def lines(name: str) -> list[list[str]]:
        text = files[name].decode("utf-8-sig", "replace")
        return [line.split() for line in text.split("\n") if not line.startswith("#")]

    places = {}
    images = [line for line in lines("images.txt") if len(line) == 10]
    for words in images:
        places.setdefault(int(words[8]), _seven(words[1:8]))
    return [
        _colmap_camera(model, [float(one) for one in rest], places[int(number)], (width, height))
        for number, model, width, height, *rest in (line for line in lines("cameras.txt") if line)
    ]


def _colmap_binary(files: Files) -> list[Stated]:
    data, at, places = files["images.bin"], 8, {}
    for _ in range(struct.unpack_from("<Q", data)[0]):
        _, *place, camera = struct.unpack_from("<I7dI", data, at)
        places.setdefault(camera, _seven(place))
        at = data.index(b"\0", at + 64) + 1
        at += 8 + 24 * struct.unpack_from("<Q", data, at)[0]
    data, at, found = files["cameras.bin"], 8, []
    for _ in range(struct.unpack_from("<Q", data)[0]):
        number, kind, width, height = struct.unpack_from("<IiQQ", data, at)
        model = _COLMAP[kind]
        count = (3, 4, 4, 5, 8, 8, 12)[kind]
        numbers = struct.unpack_from(f"<{count}d", data, at + 24)
        found.append(_colmap_camera(model, numbers, places[number], (width, height)))
        at += 24 + 8 * count
    return found


def _dice(files: Files) -> list[Stated]:
    (data,) = files.values()
    root, found = ET.fromstring(data.decode("utf-8-sig", "replace")), []  # noqa: S314 -- made here
    relative = root.find("Parameter[@name='extrinsics_relative_camera_to_camera']")
    for number in range(9):
        camera = root.find(f"ParameterList[@name='CAMERA {number}']")
        if camera is None:
            break
        values = {one.get("name"): one.get("value", "") for one in camera.iter("Parameter")}
        rows = [re.findall(r"[^{},\s]+", values[f"ROW {row}"]) for row in range(3)]
        T = sound(posed(rows, [values.get(key, 0.0) for key in ("TX", "TY", "TZ")]))
        if found and relative is not None and relative.get("value", "").lower() == "true":
            T = T @ found[0].T_cam_world
        keys = ("K1", "K2", "P1", "P2", "K3", "K4", "K5", "K6", "S1", "S2", "S3", "S4", "T1", "T2")
        bent = values.get("LENS_DISTORTION_MODEL", "").upper() == "OPENCV_LENS_DISTORTION"
        height, width = re.findall(r"[^{},\s]+", values["IMAGE_HEIGHT_WIDTH"])
        found.append(
            stated_camera([values[key] for key in ("FX", "FY", "CX", "CY")],
                          [values.get(key, 0.0) for key in keys] if bent else [], T, (width, height))
        )  # fmt: skip
    return found


def _anipose(files: Files) -> list[Stated]:
    (data,) = files.values()
    found, content = [], tomllib.loads(data.decode("utf-8-sig", "replace"))
    for camera in content.values():
        if "matrix" not in camera:
            continue
        if not {"rotation", "translation"} & set(camera):  # a camera alone may have no place
            camera = {**camera, "rotation": [0.0] * 3, "translation": [0.0] * 3}  # noqa: PLW2901
        turn = np.array(camera["rotation"], dtype=float).ravel()
        R = Rotation.from_rotvec(turn).as_matrix() if turn.size == 3 else turn
        dist = camera["distortions"]
        found.append(
            stated_camera(of_K(camera["matrix"]), dist, posed(R, camera["translation"]), camera["size"])
        )
    return found


def _matlab(files: Files) -> list[Stated]:
    (data,) = files.values()
    pair = next(one for name, one in loadmat(BytesIO(data), simplify_cells=True).items() if name[0] != "_")
    second = posed(np.array(pair["RotationOfCamera2"]).T, pair["TranslationOfCamera2"])
    found = []
    for number, T in ((1, np.eye(4)), (2, second)):
        one = pair[f"CameraParameters{number}"]
        fx, fy, cx, cy = of_K(np.array(one["IntrinsicMatrix"]).T)
        k1, k2, *k3 = one["RadialDistortion"]
        found.append(
            stated_camera((fx, fy, cx - 1.0, cy - 1.0), (k1, k2, *one["TangentialDistortion"], *k3), T,
                          one["ImageSize"][::-1])
        )  # fmt: skip
    return found


def _matchid(files: Files) -> list[Stated]:
    (data,) = files.values()
    values: dict[str, float] = {}
    for line in data.decode("utf-8-sig", "replace").splitlines():
        label, _, number = line.partition(";")
        name = re.sub(r"\[.*?\]|\s", "", label).lower()
        if re.fullmatch(r"\s*[-+.0-9eE]+\s*", number):
            values.setdefault(name, float(number))
    R = Rotation.from_euler("xyz", [values[key] for key in ("theta", "phi", "psi")], degrees=True)
    second = posed(R.as_matrix(), [values[key] for key in ("tx", "ty", "tz")])
    first = 0 if "cam0_fx" in values else 1
    found = []
    for number, T in ((first, np.eye(4)), (first + 1, second)):
        one = [values[f"cam{number}_{key}"]
               for key in ("fx", "fy", "cx", "cy", "kappa1", "kappa2", "p1", "p2", "kappa3")]  # fmt: skip
        found.append(stated_camera(one[:4], one[4:], T, None))
    return found


READERS: dict[str, Callable[[Files], list[Stated]]] = {
    "labcal": _labcal, "opencv": _opencv, "mrcal": _mrcal, "kalibr": _kalibr, "ros": _ros,
    "colmap": _colmap, "colmap-binary": _colmap_binary, "dice": _dice, "anipose": _anipose,
    "matlab": _matlab, "matchid": _matchid, "opencv.xml": _opencv_xml, "opencv.json": _opencv_json,
    "opencv.npz": _opencv_npz,
}  # fmt: skip
"""By format, and by ending where a format has several forms."""
