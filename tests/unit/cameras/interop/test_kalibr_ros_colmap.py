"""Kalibr, ROS and COLMAP: files as their own programs write them, and what cannot be read."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from labcal.cameras.interop.colmap import write_colmap
from labcal.cameras.interop.exchange import ReadRig, SourceText
from labcal.cameras.interop.kalibr import read_kalibr, write_kalibr
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.cameras.interop.ros import read_ros, write_ros
from labcal.cameras.rig import Rig
from labcal.errors import InputError

MakeRig = Callable[..., Rig]
CHAIN = """cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.2, 0.06, 1e-3, 0.0005]
  distortion_model: radtan
  intrinsics: [461.5, 460.25, 362.5, 246.125]
  resolution: [752, 480]
  rostopic: /rig/left_eye/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.0005]
  - [0.0, 0.0, 1.0, 0.25]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0]
  camera_model: pinhole
  distortion_coeffs: [-0.01, 0.05, -0.04, 0.01]
  distortion_model: equidistant
  intrinsics: [458.0, 457.0, 367.0, 248.0]
  resolution: [752, 480]
  rostopic: /rig/right_eye/image_raw
"""


def chain(text: str) -> ReadRig:
    return read_kalibr([SourceText(Path("camchain.yaml"), text)])


def test_a_chain_of_kalibr() -> None:
    cameras = chain(CHAIN).rig.cameras
    assert list(cameras) == ["left-eye", "right-eye"]
    left, right = cameras.values()
    assert (left.lens, left.dist) == ("brown5", (-0.2, 0.06, 0.001, 0.0005, 0.0))
    assert left.K == ((461.5, 0.0, 362.5), (0.0, 460.25, 246.125), (0.0, 0.0, 1.0))
    assert (right.lens, right.dist, right.size) == (
        "fisheye-kb4",
        (-0.01, 0.05, -0.04, 0.01, 0.0),
        (752, 480),
    )
    np.testing.assert_allclose(np.array(right.T_cam_world)[:3, 3], [-110.0, 0.5, 250.0])


@pytest.mark.parametrize(
    ("model", "intrinsics", "lens"),
    [
        ("pinhole", "[461.5, 460.25, 362.5, 246.125]", "pinhole"),
        ("ds", "[-0.2, 0.55, 461.5, 460.25, 362.5, 246.125]", "double-sphere"),
        ("omni", "[0.9, 461.5, 460.25, 362.5, 246.125]", "omni-radtan"),
    ],
)
def test_zeros_are_no_distortion(model: str, intrinsics: str, lens: str, tmp_path: Path) -> None:
    camera = f"cam0:\n  camera_model: {model}\n  intrinsics: {intrinsics}\n  resolution: [752, 480]\n"
    none = f"{camera}  distortion_model: none\n  distortion_coeffs: "
    plain, zeros = (chain(f"{none}{one}\n").rig.cameras["cam0"] for one in ("[]", "[0, 0, 0.0, 0]"))
    assert zeros == plain
    assert zeros.lens == lens
    with pytest.raises(InputError, match="model 'none', but distortion_coeffs are not all 0"):
        chain(f"{none}[0, 0, 0.1, 0]\n")
    path = tmp_path / "sensor.yaml"
    rows = np.eye(4).ravel().tolist()
    text = (f"sensor_type: camera\nT_BS:\n  data: {rows}\ncamera_model: pinhole\nresolution: [752, 480]\n"
            "intrinsics: [461.5, 460.25, 362.5, 246.125]\ndistortion_model: none\n")  # fmt: skip
    path.write_text(f"{text}distortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n")
    (record,) = read_rig_files([path], "euroc")[1].rig.cameras.values()
    assert record.lens == "pinhole"
    path.write_text(f"{text}distortion_coefficients: [0.0, 0.0, 0.0, 0.2]\n")
    with pytest.raises(InputError, match="distortion_coefficients are not all 0"):
        read_rig_files([path], "euroc")


def test_a_third_camera_of_kalibr_follows_the_second(make_rig: MakeRig) -> None:
    text = write_kalibr(make_rig("pinhole", count=3), ".yaml").files[0].text
    assert text.count("T_cn_cnm1") == 2
    rows = text.rpartition("T_cn_cnm1:")[2]
    t = [float(line.rpartition(",")[2].strip(" ]")) for line in rows.splitlines()[1:4]]
    np.testing.assert_allclose(t, [-0.1803, 0.0061, 0.0257], rtol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("camera_model: pinhole", "camera_model: ocam", "camera model 'ocam'"),
        ("distortion_model: radtan", "distortion_model: fov", "distortion 'fov'"),
        ("[461.5, 460.25, 362.5, 246.125]", "[461.5, 460.25]", "intrinsics should hold 4 numbers"),
        ("[752, 480]", "[752, -480]", "no size of a picture"),
        ("-0.11]", ".nan]", "finite number"),
        ("[1.0, 0.0, 0.0, -0.11]", "[2.0, 0.0, 0.0, -0.11]", "rigid"),
        ("cam0:", "camera0:", "no camera 'cam0'"),
    ],
)
def test_chains_that_cannot_be_read(old: str, new: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        chain(CHAIN.replace(old, new))


def test_a_rounded_rotation_is_mended_and_that_is_said() -> None:
    turn = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix()
    text = CHAIN
    for at, t in enumerate(("-0.11", "0.0005", "0.25")):
        old = ", ".join(str(float(value)) for value in np.eye(3)[at])
        new = ", ".join(f"{value:.4f}" for value in turn[at])
        text = text.replace(f"[{old}, {t}]", f"[{new}, {t}]")
    read = chain(text)
    R = np.array(read.rig.cameras["right-eye"].T_cam_world)[:3, :3]
    np.testing.assert_allclose(R, turn, atol=1e-4)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-14)
    assert "rounded" in read.notes[0]


def test_ros_files_rectify_as_they_should(make_rig: MakeRig, points: np.ndarray) -> None:
    rig = make_rig("brown5")
    first = None
    for file, record in zip(write_ros(rig, ".yaml").files, rig.cameras.values(), strict=True):
        blocks = file.text.split("data: [")[1:]
        _, _, R, P = (np.array(block.partition("]")[0].split(","), dtype=np.float64) for block in blocks)
        P = P.reshape(3, 4)
        assert P[1, 3] == P[2, 3] == 0.0
        R = R.reshape(3, 3)
        first = R if first is None else first
        seen = rig.camera(file.label).project(points)
        stop = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 100, 1e-12)
        q = seen.q[seen.ok][:, None]
        flat = cv2.undistortPoints(q, np.array(record.K), np.array(record.dist), R=R, P=P, criteria=stop)
        # What ROS documents: P images points of the first camera's rectified frame, metres.
        u, v, w = P @ np.vstack([first @ points[seen.ok].T / 1000.0, np.ones(seen.ok.sum())])
        assert seen.ok.sum() > 100
        np.testing.assert_allclose(flat[:, 0], np.column_stack([u / w, v / w]), atol=1e-6)


def test_ros_files_of_cameras_calibrated_alone_have_no_pose(make_rig: MakeRig) -> None:
    texts = [write_ros(make_rig("pinhole", count=1), ".yaml").files[0].text for _ in range(2)]
    with pytest.raises(InputError, match="do not state how far apart"):
        read_ros([SourceText(Path(f"{n}.yaml"), text) for n, text in enumerate(texts)])


def test_colmap_counts_from_the_corner_of_a_pixel(make_rig: MakeRig) -> None:
    cameras = write_colmap(make_rig("pinhole", count=1), "").files[0].text
    assert "1 PINHOLE 640 480 700.1 690.2 322.9 237.6" in cameras


def colmap(folder: Path, cameras: str, images: str) -> ReadRig:
    folder.mkdir(exist_ok=True)
    (folder / "cameras.txt").write_text(f"# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n{cameras}\n")
    (folder / "images.txt").write_text(f"# Image list\n{images}")
    return read_rig_files([folder], None)[1]


def test_simple_models_of_colmap_and_lines_of_points(tmp_path: Path) -> None:
    images = "1 1 0 0 0 1 2 3 7 a/left.png\n10.5 20.5 -1 30 40 5\n2 0 1 0 0 0 0 9 8 right.jpg\n\n"
    cameras = "7 SIMPLE_RADIAL 640 480 700 320.5 240.5 -0.1\n8 RADIAL_FISHEYE 640 480 500 320.5 240.5 0.1 0.2"
    read = colmap(tmp_path / "model", cameras, images).rig.cameras
    assert list(read) == ["left", "right"]
    left, right = read.values()
    assert (left.lens, left.dist) == ("brown-k1k2", (-0.1, 0.0, 0.0, 0.0, 0.0))
    assert left.K == ((700.0, 0.0, 320.0), (0.0, 700.0, 240.0), (0.0, 0.0, 1.0))
    assert (right.lens, right.dist) == ("fisheye-kb4", (0.1, 0.2, 0.0, 0.0, 0.0))
    turned = [[1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 9.0], [0.0, 0.0, 0.0, 1.0]]
    np.testing.assert_allclose(right.T_cam_world, turned, atol=1e-15)


@pytest.mark.parametrize(
    ("cameras", "images", "said"),
    [
        ("1 FOV 640 480 1 2 3 4 5", "1 1 0 0 0 0 0 0 1 a.png\n\n", "model FOV has no counterpart"),
        ("1 PINHOLE 640 480 1 2 3", "1 1 0 0 0 0 0 0 1 a.png\n\n", "should hold 4 numbers"),
        ("1 PINHOLE 640", "1 1 0 0 0 0 0 0 1 a.png\n\n", "ends too early"),
        (
            "1 PINHOLE 640 480 9 9 9 9\n2 PINHOLE 640 480 9 9 9 9",
            "1 1 0 0 0 0 0 0 1 a.png\n\n2 1 0 0 0 0 0 0 1 b.png\n\n3 1 0 0 0 0 0 0 2 c.png\n\n",
            "took 2 images",
        ),
        ("1 PINHOLE 640 480 9 9 9 9", "1 2 0 0 0 0 0 0 1 a.png\n\n", "quaternion"),
        ("1 PINHOLE 640 480 9 9 9 9", "1 1 0 0\n\n", "no line of an image"),
        ("1 PINHOLE 640 480 -9 9 9 9", "1 1 0 0 0 0 0 0 1 a.png\n\n", "positive focal lengths"),
    ],
)
def test_models_of_colmap_that_cannot_be_read(tmp_path: Path, cameras: str, images: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        colmap(tmp_path / "model", cameras, images)
