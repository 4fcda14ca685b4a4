"""Files of formats that are read and not written, and what they state by readers of their own.

As in :mod:`fuzz.stated_cameras`, whose rules hold here, too.
"""

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any
from xml.etree import ElementTree as ET

import cv2
import numpy as np
import robot_files as robots
from scipy.io import loadmat, savemat
from scipy.spatial.transform import Rotation

from fuzz.stated_cameras import Files, Stated, posed, sound, stated_camera, stated_infos, yaml_words

_OPENCV = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")


@dataclass(frozen=True)
class Example:
    """Files of a format, and their second reader."""

    format_name: str
    files: Files
    read: Callable[[Files], list[Stated]]


def _from_first(places: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return ``T_cam_first`` of cameras whose ``T_body_cam`` are given."""
    return [np.linalg.inv(place) @ places[0] for place in places]


def _euroc(files: Files) -> list[Stated]:
    cameras = [yaml_words(data) for data in files.values()]
    places = []
    for one in cameras:
        T = np.array([float(value) for value in one["T_BS"]["data"]]).reshape(4, 4)
        places.append(sound(posed(T[:3, :3], T[:3, 3], 1000.0)))
    return [
        stated_camera(one["intrinsics"], one["distortion_coefficients"], T, one["resolution"])
        for one, T in zip(cameras, _from_first(places), strict=True)
    ]


def _camodocal(files: Files) -> list[Stated]:
    (data,) = files.values()
    one = yaml_words(data)
    size, numbers = (one["image_width"], one["image_height"]), one["projection_parameters"]
    names: Sequence[str] = {"PINHOLE": ("fx", "fy"), "MEI": ("gamma1", "gamma2")}.get(
        one["model_type"], ("mu", "mv")
    )
    if one["model_type"] == "KANNALA_BRANDT":
        names, rest = ("mu", "mv", "u0", "v0"), [numbers[key] for key in ("k2", "k3", "k4", "k5")]
    else:
        rest = [one["distortion_parameters"].get(key, 0.0) for key in _OPENCV]
        middle = ("u0", "v0") if one["model_type"] == "MEI" else ("cx", "cy")
        names = (*names, *middle)
    if one["model_type"] == "MEI":
        rest = [one["mirror_parameters"]["xi"], *rest]
    return [stated_camera([numbers[key] for key in names], rest, np.eye(4), size)]


def _orb_slam(files: Files) -> list[Stated]:
    (data,) = files.values()
    one = yaml_words(data)
    size = (one["Camera.width"], one["Camera.height"])
    key = "Stereo.T_c1_c2" if "Stereo.T_c1_c2" in one else "Tlr"
    T = np.array([float(value) for value in one[key]["data"]]).reshape(-1, 4)
    names = robots.FOUR if one["Camera.type"] == "KannalaBrandt8" else _OPENCV
    poses = (np.eye(4), np.linalg.inv(sound(posed(T[:3, :3], T[:3, 3], 1000.0))))
    return [
        stated_camera([one[f"Camera{number}.{name}"] for name in robots.NUMBERS],
                      [one.get(f"Camera{number}.{name}", 0.0) for name in names], pose, size)
        for number, pose in zip((1, 2), poses, strict=True)
    ]  # fmt: skip


def _orb_rectified(files: Files) -> list[Stated]:
    (data,) = files.values()
    one = yaml_words(data)
    letters = {"camera_matrix": "K", "distortion_coefficients": "D", "rectification_matrix": "R",
               "projection_matrix": "P"}  # fmt: skip
    return stated_infos(
        [
            {key: one[f"{side}.{letter}"] for key, letter in letters.items()}
            | {"image_width": one[f"{side}.width"], "image_height": one[f"{side}.height"]}
            for side in ("LEFT", "RIGHT")
        ]
    )


def _basalt(files: Files) -> list[Stated]:
    (data,) = files.values()
    content = json.loads(data.decode("utf-8-sig", "replace"))["value0"]
    places = []
    for one in content["T_imu_cam"]:
        R = Rotation.from_quat([float(one[key]) for key in ("qx", "qy", "qz", "qw")]).as_matrix()
        places.append(posed(R, [float(one[key]) for key in ("px", "py", "pz")], 1000.0))
    found = []
    for camera, T, size in zip(
        content["intrinsics"], _from_first(places), content["resolution"], strict=True
    ):
        values = camera["intrinsics"]
        names = {"kb4": robots.FOUR, "ds": ("xi", "alpha")}.get(camera["camera_type"], _OPENCV)
        rest = [values.get(key, 0.0) for key in names]
        found.append(stated_camera([values[key] for key in robots.NUMBERS], rest, T, size))
    return found


def _ost(files: Files) -> list[Stated]:
    names = {"camera matrix": "camera_matrix", "distortion": "distortion_coefficients",
             "rectification": "rectification_matrix", "projection": "projection_matrix"}  # fmt: skip
    number = r"[-+.\deE]+"
    cameras = []
    for data in files.values():
        for part in data.decode("utf-8-sig", "replace").split("# oST version")[1:]:
            one: dict[str, Any] = {}
            for key, name in names.items():
                rows = rf"^\s*{key}\s*\n((?:\s*{number}(?:[ \t]+{number})+\s*\n)+)"
                one[name] = {"data": re.findall(rows, part, re.MULTILINE)[0].split()}
            for key in ("width", "height"):
                one[f"image_{key}"] = re.findall(rf"^\s*{key}\s*\n\s*({number})", part, re.MULTILINE)[0]
            cameras.append(one)
    return stated_infos(cameras)


def _nerfstudio(files: Files) -> list[Stated]:
    (data,) = files.values()
    one = json.loads(data.decode("utf-8-sig", "replace"))
    names = robots.FOUR if one.get("camera_model") == "OPENCV_FISHEYE" else _OPENCV
    numbers = [float(one["fl_x"]), float(one.get("fl_y", one["fl_x"])), float(one["cx"]) - 0.5]
    numbers.append(float(one["cy"]) - 0.5)
    size = (one["w"], one["h"])
    return [stated_camera(numbers, [one.get(key, 0.0) for key in names], np.eye(4), size)]


def _metashape(files: Files) -> list[Stated]:
    (data,) = files.values()
    root = ET.fromstring(data.decode("utf-8-sig", "replace"))  # noqa: S314 -- made here
    value = {one.tag: (one.text or "").strip() for one in root}
    number = {key: float(value.get(key) or 0.0) for key in ("b1", "cx", "cy", "k1", "k2", "k3", "p1", "p2")}
    width, height, f = float(value["width"]), float(value["height"]), float(value["f"])
    numbers = (f + number["b1"], f, 0.5 * width + number["cx"] - 0.5, 0.5 * height + number["cy"] - 0.5)
    # Metashape's p1 and p2 are OpenCV's p2 and p1.
    rest = [number[key] for key in ("k1", "k2", "p2", "p1", "k3")]
    return [stated_camera(numbers, rest, np.eye(4), (width, height))]


def _bouguet(files: Files) -> list[Stated]:
    (data,) = files.values()
    one = {key: np.ravel(value) for key, value in loadmat(BytesIO(data)).items() if key[0] != "_"}
    turn = Rotation.from_rotvec(one["om"]).as_matrix()
    size = (float(one["nx"][0]), float(one["ny"][0]))
    return [
        stated_camera([*one[f"fc_{side}"], *one[f"cc_{side}"]], one[f"kc_{side}"], T, size)
        for side, T in (("left", np.eye(4)), ("right", posed(turn, one["T"])))
    ]


def _bouguet_file() -> bytes:
    values: dict[str, object] = {"nx": 2048.0, "ny": 1536.0, "T": robots.T[:, None]}
    values["om"] = Rotation.from_matrix(robots.R).as_rotvec()[:, None]
    for side, K, D in (("left", robots.KA, robots.DA), ("right", robots.KB, robots.DB)):
        values |= {f"fc_{side}": K[[0, 1], [0, 1]], f"cc_{side}": K[:2, 2], f"kc_{side}": [*D, 0.013]}
    content = BytesIO()
    savemat(content, values)
    return content.getvalue()


def _examples() -> Mapping[str, Example]:
    """Return an example of each format, and of each form of it that is read in another way."""
    texts: dict[str, tuple[Mapping[str, str], Callable[[Files], list[Stated]]]] = {}
    second = robots.SECOND_FIRST @ robots.ON_BODY
    texts["euroc"] = {"cam0.yaml": robots.euroc(robots.KA, robots.DA, robots.ON_BODY),
                      "cam1.yaml": robots.euroc(robots.KB, robots.DB, second)}, _euroc  # fmt: skip
    lens = "distortion_parameters:\n" + robots.keyed(robots.BROWN, robots.DA, "   ")
    four = robots.four(robots.KA)
    texts["camodocal"] = {"c.yaml": robots.camodocal("PINHOLE", robots.NUMBERS, four, lens)}, _camodocal
    mirror = "mirror_parameters:\n   xi: 1.12\n" + lens
    gammas = ("gamma1", "gamma2", "u0", "v0")
    texts["camodocal.mei"] = {"c.yaml": robots.camodocal("MEI", gammas, four, mirror)}, _camodocal
    kannala = ("k2", "k3", "k4", "k5", "mu", "mv", "u0", "v0")
    values = [*robots.FA, *four]
    texts["camodocal.kb"] = {"c.yaml": robots.camodocal("KANNALA_BRANDT", kannala, values)}, _camodocal
    pair = robots.orb_pair("PinHole", robots.BROWN, (robots.DA, robots.DB), "Stereo.T_c1_c2")
    texts["orb-slam"] = {"s.yaml": pair}, _orb_slam
    pair = robots.orb_pair("KannalaBrandt8", robots.FOUR, (robots.FA, robots.FB), "Tlr")
    texts["orb-slam.fisheye"] = {"s.yaml": pair}, _orb_slam
    texts["orb-slam.rectified"] = {"s.yaml": robots.orb_rectified()}, _orb_rectified
    pair = robots.basalt("kb4", robots.named(robots.KA, robots.FOUR, robots.FA),
                         robots.named(robots.KB, robots.FOUR, robots.FB))  # fmt: skip
    texts["basalt"] = {"c.json": pair}, _basalt
    pair = robots.basalt("ds", robots.named(robots.KA, ("xi", "alpha"), (-0.2, 0.6)),
                         robots.named(robots.KB, ("xi", "alpha"), (-0.19, 0.59)))  # fmt: skip
    texts["basalt.ds"] = {"c.json": pair}, _basalt
    ideal = cv2.stereoRectify(robots.KA, robots.DA, robots.KB, robots.DB, robots.SIZE, robots.R,
                              robots.T[:, None])  # fmt: skip
    pair = robots.ost(("left", robots.KA, np.append(robots.DA, 0.01), ideal[0], ideal[2]),
                      ("right", robots.KB, np.append(robots.DB, 0.01), ideal[1],
                       ideal[3] * [1.0, 1.0, 1.0, 1e-3]))  # fmt: skip
    texts["ost"] = {"ost.txt": pair}, _ost
    texts["nerfstudio"] = {"t.json": robots.transforms("OPENCV", robots.BROWN, robots.DA)}, _nerfstudio
    numbers = {"f": 1891.9, "b1": 1.5, "cx": -6.2, "cy": 14.2, "k1": -0.132, "k2": 0.171, "k3": -0.09,
               "p1": 0.00043, "p2": -0.00071}  # fmt: skip
    texts["metashape"] = {"c.xml": robots.metashape("frame", numbers)}, _metashape
    found = {
        name: Example(name.split(".")[0], {file: text.encode() for file, text in files.items()}, reader)
        for name, (files, reader) in texts.items()
    }
    return found | {"matlab.bouguet": Example("matlab", {"c.mat": _bouguet_file()}, _bouguet)}


ROBOTS = _examples()
