"""Forms in which other people's programs keep OpenCV's matrices, and what they state by readers of their own.

As in :mod:`fuzz.stated_cameras`, whose rules hold here, too.
"""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import robot_files as robots
from scipy.spatial.transform import Rotation

from fuzz.stated_cameras import Files, Stated, of_K, posed, stated_camera, yaml_words
from fuzz.stated_robots import Example

_SIZE = "image_width: 2048\nimage_height: 1536\n"
_DA, _DB = np.append(robots.DA, 0.013), np.append(robots.DB, 0.011)


def _numbers(content: Mapping[str, Any], key: str) -> list[float]:
    value = content[key]
    rows = value["data"] if isinstance(value, dict) else value
    return [float(one) for row in rows for one in (row if isinstance(row, list) else [row])]


def _nested(files: Files) -> list[Stated]:
    (data,) = files.values()
    one = yaml_words(data.replace(b"\t", b" "))
    pose = posed(_numbers(one["stereo"], "R"), _numbers(one["stereo"], "T"))
    return [
        stated_camera(of_K(_numbers(one[side], "K")), _numbers(one[side], "D"), T, one[side]["resolution"])
        for side, T in (("left", np.eye(4)), ("right", pose))
    ]


def _placed(files: Files) -> list[Stated]:
    left, right, stereo = (yaml_words(data) for data in files.values())
    T = posed(_numbers(stereo, "R"), _numbers(stereo, "T"))
    return [_alone(one, "camera_matrix", "distortion_coefficients", pose)
            for one, pose in ((left, np.eye(4)), (right, T))]  # fmt: skip


def _alone(one: Mapping[str, Any], matrix: str, lens: str, T: np.ndarray) -> Stated:
    size = (one["image_width"], one["image_height"])
    return stated_camera(of_K(_numbers(one, matrix)), _numbers(one, lens), T, size)


def _turned(files: Files) -> list[Stated]:
    (data,) = files.values()
    one = yaml_words(data)
    turn = Rotation.from_rotvec(_numbers(one, "rvec")).as_matrix()
    return [_alone(one, "Camera_Matrix", "DistCoeffs", posed(turn, _numbers(one, "tvec")))]


def _omnidir(files: Files) -> list[Stated]:
    (data,) = files.values()
    one = yaml_words(data)
    size = (one["image_width"], one["image_height"])
    rest = [float(one["xi"]), *_numbers(one, "D")]
    return [stated_camera(of_K(_numbers(one, "K")), rest, np.eye(4), size)]


def _forms() -> Mapping[str, Example]:
    """Return an example of each form."""

    def storage(**matrices: np.ndarray) -> bytes:
        lines = [robots.opencv_matrix(key, values) for key, values in matrices.items()]
        return f"%YAML:1.0\n---\n{_SIZE}{''.join(lines)}".encode()

    def side(K: np.ndarray, D: np.ndarray) -> dict[str, object]:
        return {"K": K.tolist(), "D": D.tolist(), "resolution": list(robots.SIZE)}

    pose = {"R": robots.R.tolist(), "T": robots.T.tolist()}
    nested = {"left": side(robots.KA, _DA), "right": side(robots.KB, _DB), "stereo": pose}
    placed = {
        "left.yml": storage(camera_matrix=robots.KA, distortion_coefficients=_DA),
        "right.yml": storage(camera_matrix=robots.KB, distortion_coefficients=_DB),
        "stereo.yml": storage(R=robots.R, T=robots.T[:, None]).replace(_SIZE.encode(), b""),
    }
    turn = Rotation.from_matrix(robots.R).as_rotvec()
    # The pose first, since one that is cut off leaves no trace.
    turned = storage(rvec=turn, tvec=robots.T, Camera_Matrix=robots.KA, DistCoeffs=_DA)
    omnidir = storage(K=robots.KA, D=robots.DA) + b"xi: 1.12\n"
    return {
        "opencv.nested": Example("opencv", {"c.json": json.dumps(nested, indent=1).encode()}, _nested),
        "opencv.placed": Example("opencv", placed, _placed),
        "opencv.turned": Example("opencv", {"c.yml": turned}, _turned),
        "opencv.omnidir": Example("opencv", {"c.yml": omnidir}, _omnidir),
    }


FORMS = _forms()
