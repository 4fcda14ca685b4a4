"""Files of cameras as programs for robots and photogrammetry write them, and what they mean by OpenCV."""

import json
from collections.abc import Mapping, Sequence

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

KA = np.array([[1893.4, 0.0, 1017.3], [0.0, 1891.9, 781.7], [0.0, 0.0, 1.0]])
KB = np.array([[1902.2, 0.0, 1009.6], [0.0, 1903.1, 758.2], [0.0, 0.0, 1.0]])
DA = np.array([-0.132, 0.171, -0.00071, 0.00043])
DB = np.array([-0.128, 0.149, 0.00052, -0.00037])
FA = np.array([0.0213, -0.0107, 0.0061, -0.0022])
FB = np.array([0.0191, -0.0088, 0.0049, -0.0018])
SIZE = (2048, 1536)
R = cv2.Rodrigues(np.array([0.012, -0.21, 0.008]))[0]
T = np.array([-247.3, -2.2, 21.4])
"""Of the second camera from the first one, mm."""
ON_BODY = np.eye(4)
ON_BODY[:3, :3] = cv2.Rodrigues(np.array([1.2, -1.2, 1.2]))[0]
ON_BODY[:3, 3] = [0.05, 0.02, -0.01]
"""``T_cam_body`` of the first camera, m."""
SECOND_FIRST = np.eye(4)
SECOND_FIRST[:3, :3], SECOND_FIRST[:3, 3] = R, T / 1000.0
FOUR = ("k1", "k2", "k3", "k4")
BROWN = ("k1", "k2", "p1", "p2")
NUMBERS = ("fx", "fy", "cx", "cy")


def four(K: np.ndarray) -> list[float]:
    return [float(K[0, 0]), float(K[1, 1]), float(K[0, 2]), float(K[1, 2])]


def flat(matrix: np.ndarray) -> str:
    return f"[{', '.join(repr(float(value)) for value in np.ravel(matrix))}]"


def keyed(names: Sequence[str], values: Sequence[float], before: str = "") -> str:
    return "".join(f"{before}{name}: {float(value)!r}\n" for name, value in zip(names, values, strict=True))


def opencv_matrix(key: str, values: np.ndarray) -> str:
    rows, cols = np.atleast_2d(values).shape
    return f"{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n   data: {flat(values)}\n"


def euroc(K: np.ndarray, D: np.ndarray, T_cam_body: np.ndarray, model: str = "radial-tangential") -> str:
    return (
        "# General sensor definitions.\nsensor_type: camera\ncomment: cam0\n\nT_BS:\n  cols: 4\n  rows: 4\n"
        f"  data: {flat(np.linalg.inv(T_cam_body))}\nrate_hz: 20\nresolution: [2048, 1536]\n"
        f"camera_model: pinhole\nintrinsics: {flat(four(K))} #fu, fv, cu, cv\ndistortion_model: {model}\n"
        f"distortion_coefficients: {flat(D)}\n"
    )


def camodocal(model: str, projection: Sequence[str], values: Sequence[float], rest: str = "") -> str:
    lines = keyed(projection, values, "   ")
    return (
        f"%YAML:1.0\n---\nmodel_type: {model}\ncamera_name: camera\nimage_width: 2048\nimage_height: 1536\n"
        f"{rest}projection_parameters:\n{lines}"
    )


def orb_pair(kind: str, names: Sequence[str], dists: Sequence[np.ndarray], pose_key: str) -> str:
    T_first_second = np.linalg.inv(SECOND_FIRST)
    rows = T_first_second if pose_key.startswith("Stereo") else T_first_second[:3]
    cameras = "".join(
        keyed(NUMBERS, four(K), f"Camera{number}.") + keyed(names, D, f"Camera{number}.")
        for number, K, D in zip((1, 2), (KA, KB), dists, strict=True)
    )
    return (
        f'%YAML:1.0\n\nFile.version: "1.0"\nCamera.type: "{kind}"\n{cameras}Camera.width: 2048\n'
        f"Camera.height: 1536\nCamera.fps: 20\n{opencv_matrix(pose_key, rows)}"
    )


def orb_rectified() -> str:
    """Return a pair of ORB-SLAM2, with its original cameras and what rectifies them."""
    ideal = cv2.stereoRectify(KA, DA, KB, DB, SIZE, R, T[:, None])
    text = "%YAML:1.0\n" + keyed(NUMBERS, four(ideal[2]), "Camera.") + "Camera.width: 2048\n"
    for side, K, D, turn, P in (
        ("LEFT", KA, DA, ideal[0], ideal[2]),
        ("RIGHT", KB, DB, ideal[1], ideal[3] * [1.0, 1.0, 1.0, 1e-3]),
    ):
        text += f"{side}.height: 1536\n{side}.width: 2048\n"
        for letter, matrix in (("D", D), ("K", K), ("R", turn), ("P", P)):
            text += opencv_matrix(f"{side}.{letter}", matrix)
    return text


def basalt(kind: str, *cameras: Mapping[str, float]) -> str:
    places = []
    for T_cam_imu in (ON_BODY, SECOND_FIRST @ ON_BODY)[: len(cameras)]:
        T_imu_cam = np.linalg.inv(T_cam_imu)
        turn = Rotation.from_matrix(T_imu_cam[:3, :3]).as_quat()
        names = ("px", "py", "pz", "qx", "qy", "qz", "qw")
        places.append(dict(zip(names, [*map(float, T_imu_cam[:3, 3]), *map(float, turn)], strict=True)))
    content = {
        "T_imu_cam": places,
        "intrinsics": [{"camera_type": kind, "intrinsics": dict(one)} for one in cameras],
        "resolution": [list(SIZE)] * len(cameras),
        "vignette": [],
    }
    return json.dumps({"value0": content}, indent=1)


def named(K: np.ndarray, names: Sequence[str] = (), values: Sequence[float] = ()) -> dict[str, float]:
    """Return the numbers of a camera by their names."""
    return dict(zip((*NUMBERS, *names), [*four(K), *map(float, values)], strict=True))


def ost(*cameras: tuple[str, np.ndarray, np.ndarray, np.ndarray, np.ndarray]) -> str:
    def rows(matrix: np.ndarray) -> str:
        return "\n".join(" ".join(f"{value:.9f}" for value in row) for row in np.atleast_2d(matrix))

    return "\n".join(
        "# oST version 5.0 parameters\n\n\n[image]\n\nwidth\n2048\n\nheight\n1536\n\n"
        f"[narrow_stereo/{name}]\n\ncamera matrix\n{rows(K)}\n\ndistortion\n{rows(D)}\n\n"
        f"rectification\n{rows(turn)}\n\nprojection\n{rows(P)}\n"
        for name, K, D, turn, P in cameras
    )


def transforms(model: str | None, names: Sequence[str], values: Sequence[float]) -> str:
    fx, fy, cx, cy = four(KA)
    content: dict[str, object] = {
        "fl_x": fx,
        "fl_y": fy,
        "cx": cx + 0.5,
        "cy": cy + 0.5,
        "w": 2048,
        "h": 1536,
    }
    content |= dict(zip(names, map(float, values), strict=True))
    content |= {} if model is None else {"camera_model": model}
    content["frames"] = [{"file_path": f"{n}.png", "transform_matrix": np.eye(4).tolist()} for n in (1, 2)]
    return json.dumps(content)


def metashape(projection: str, values: Mapping[str, float]) -> str:
    numbers = "".join(f"  <{name}>{value!r}</{name}>\n" for name, value in values.items())
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<calibration>\n  <projection>{projection}</projection>\n'
        f"  <width>2048</width>\n  <height>1536</height>\n{numbers}  <date>2026-01-01T00:00:00Z</date>\n"
        "</calibration>\n"
    )
