"""Keys and forms in which other people's programs write OpenCV's matrices, and COLMAP's two forms at once."""

import gzip
import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.cameras.interop.exchange import ReadOptions
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.interop.rig_files import baseline_mm, read_rig_files
from labcal.cameras.rig import Rig
from labcal.errors import InputError

MakeRig = Callable[..., Rig]
K1 = np.array([[905.5, 0.0, 512.25], [0.0, 907.0, 380.5], [0.0, 0.0, 1.0]])
K2 = np.array([[921.0, 0.0, 498.0], [0.0, 919.5, 391.75], [0.0, 0.0, 1.0]])
D1, D2 = np.array([-0.17, 0.06, -7e-4, 5e-4, 0.0]), np.array([-0.16, 0.05, 4e-4, -6e-4, 0.0])
R = cv2.Rodrigues(np.array([-0.02, 0.21, 0.006]))[0]
T = np.array([-143.0, 2.2, 15.0])
SIZE = (1024, 768)
GIVEN = ReadOptions(size=SIZE)


def matrix(key: str, values: np.ndarray) -> str:
    rows, cols = np.atleast_2d(values).shape
    data = ", ".join(repr(float(one)) for one in values.ravel())
    return f"{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n   data: [ {data} ]\n"


def pair(keys: tuple[str, str, str, str], pose: str = matrix("R", R) + matrix("T", T[:, None])) -> str:
    cameras = zip(keys, (K1, D1, K2, D2), strict=True)
    return "%YAML:1.0\n---\n" + "".join(matrix(key, values) for key, values in cameras) + pose


def require_pair(path: Path) -> None:
    rig = read_rig_files([path], None, GIVEN)[1].rig
    first, second = (rig.camera(name) for name in rig.cameras)
    np.testing.assert_allclose(first.K, K1)
    np.testing.assert_allclose(second.K, K2)
    np.testing.assert_allclose(second.dist[:4], D2[:4])
    np.testing.assert_allclose(second.T_cam_world[:3, :3], R, atol=1e-12)
    assert baseline_mm(rig) == pytest.approx(np.linalg.norm(T))


@pytest.mark.parametrize(
    "keys",
    [
        ("mtx1", "dist1", "mtx2", "dist2"),
        ("mtxL", "distL", "mtxR", "distR"),
        ("K0", "D0", "K1", "D1"),
        ("left_camera_matrix", "left_dist_coeffs", "right_camera_matrix", "right_dist_coeffs"),
        ("camera_matrix_0", "distortion_coefficients_0", "camera_matrix_1", "distortion_coefficients_1"),
        ("LEFT.K", "LEFT.D", "RIGHT.K", "RIGHT.D"),
        ("cam_matrix_left", "dist_left", "cam_matrix_right", "dist_right"),
        ("Camera_Matrix_1", "Distortion_Coefficients_1", "Camera_Matrix_2", "Distortion_Coefficients_2"),
    ],
)
def test_keys_of_a_pair(keys: tuple[str, str, str, str], tmp_path: Path) -> None:
    (tmp_path / "a.yml").write_text(pair(keys))
    require_pair(tmp_path / "a.yml")


def test_a_rotation_vector_and_long_names_of_the_pose(tmp_path: Path) -> None:
    path = tmp_path / "a.yml"
    pose = matrix("rotation_matrix", cv2.Rodrigues(R)[0]) + matrix("translation_vector", T[:, None])
    path.write_text(pair(("M1", "D1", "M2", "D2"), pose))
    require_pair(path)


def test_three_cameras_are_no_pair(tmp_path: Path) -> None:
    path = tmp_path / "a.yml"
    path.write_text(pair(("K0", "D0", "K1", "D1")) + matrix("K2", K2) + matrix("D2", D2))
    with pytest.raises(InputError, match=r"more than two cameras.*`key='M1=KEY"):
        read_rig_files([path], None, GIVEN)


def test_two_keys_of_one_camera_that_differ(tmp_path: Path) -> None:
    path = tmp_path / "a.yml"
    path.write_text("%YAML:1.0\n---\n" + matrix("camera_matrix", K1) + matrix("K", K2) + matrix("D", D1))
    with pytest.raises(InputError, match=r"camera_matrix and K, which differ.*`key='camera_matrix="):
        read_rig_files([path], None, GIVEN)
    (record,) = read_rig_files([path], None, ReadOptions(SIZE, key={"camera_matrix": "K"}))[
        1
    ].rig.cameras.values()
    assert record.K[0][0] == K2[0, 0]


def test_a_pose_is_not_taken_from_a_file_with_matrices_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "a.yml").write_text(pair(("M1", "D1", "M2", "D2"), ""))
    (tmp_path / "b.yml").write_text(pair(("one", "D_one", "two", "D_two")))
    with pytest.raises(InputError, match=r"no pose R, T.*there are M1, D1, M2, D2"):
        read_rig_files([tmp_path / "a.yml"], None, GIVEN)


def test_archives_of_numpy(tmp_path: Path) -> None:
    path = tmp_path / "stereo.npz"
    views = {"rvecs": np.zeros((300, 3)), "names": np.array(["a", "b"])}
    np.savez(path, mtxL=K1, distL=D1[None], mtxR=K2, distR=D2[None], R=R, T=T[:, None], **views)
    require_pair(path)
    np.savez_compressed(path, mtx=K1, dist=D1[None], image_size=np.array(SIZE))
    (record,) = read_rig_files([path], None)[1].rig.cameras.values()
    assert (record.K[1][2], record.size) == (380.5, SIZE)
    np.savez(path, mtx=K1, dist=np.array([object()]))
    with pytest.raises(InputError, match="has no distortion_coefficients"):
        read_rig_files([path], None, GIVEN)
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(InputError, match="damaged"):
        read_rig_files([path], None, GIVEN)


def test_plain_json_and_yaml_and_what_is_within_a_key(tmp_path: Path) -> None:
    alone = {"camera_matrix": K1.tolist(), "dist_coeff": [D1.tolist()]}
    left = {"camera_matrix": K1.tolist(), "dist": D1.tolist()}
    right = {"camera_matrix": K2.tolist(), "dist": D2.tolist()}
    nested = {"left": left, "right": right, "R": R.tolist(), "T": T.tolist()}
    for ending, indent in ((".json", None), (".json", "\t"), (".yaml", 1)):
        path = tmp_path / f"a{ending}"
        path.write_text(json.dumps(alone, indent=indent))
        (record,) = read_rig_files([path], None, GIVEN)[1].rig.cameras.values()
        assert record.dist[0] == -0.17
        path.write_text(json.dumps(nested, indent=indent))
        require_pair(path)


def test_a_pair_in_one_line_of_json_and_its_size_as_a_matrix(tmp_path: Path) -> None:
    """Its keys are of one letter and a number, which alone tell the format."""
    content = {"K1": K1, "D1": D1[None], "K2": K2, "D2": D2[None], "Rot": R, "Trans": T[:, None]}
    (tmp_path / "a.json").write_text(json.dumps({key: value.tolist() for key, value in content.items()}))
    require_pair(tmp_path / "a.json")
    size = "imageSize: !!opencv-matrix\n   rows: 1\n   cols: 2\n   dt: i\n   data: [ 1024, 768 ]\n"
    (tmp_path / "a.yml").write_text(pair(("M1", "D1", "M2", "D2")) + size)
    assert read_rig_files([tmp_path / "a.yml"], None)[1].rig.camera("left").size == SIZE


def test_packed_and_wide_texts(tmp_path: Path) -> None:
    text = pair(("M1", "D1", "M2", "D2"))
    path = tmp_path / "a.yml.gz"
    path.write_bytes(gzip.compress(text.encode()))
    require_pair(path)
    path.write_bytes(gzip.compress(text.encode())[:-20])
    with pytest.raises(InputError, match="truncated"):
        read_rig_files([path], None, GIVEN)
    path = tmp_path / "a.yml"
    path.write_bytes(text.encode("utf-16"))
    require_pair(path)
    with zipfile.ZipFile(tmp_path / "cal.z3d", "w") as archive:
        archive.writestr("project.xml", "<project/>")
    with pytest.raises(InputError, match=r"archive.*project\.xml"):
        read_rig_files([tmp_path / "cal.z3d"], None)


def test_a_folder_with_both_forms_of_colmap(tmp_path: Path, make_rig: MakeRig) -> None:
    rig, home = make_rig("brown5"), tmp_path / "sparse"
    home.mkdir()
    for name in ("colmap", "colmap-binary"):
        for one in FORMATS[name].write(rig, "").files:
            data = one.text.encode() if isinstance(one.text, str) else one.text
            (home / one.label).write_bytes(data)
    _, found = read_rig_files([home], None)
    assert "the same cameras as text and in binary form" in found.notes[0]
    assert list(found.rig.cameras) == list(rig.cameras)
    for one in FORMATS["colmap"].write(make_rig("brown-k1k2"), "").files:
        (home / one.label).write_text(str(one.text))
    with pytest.raises(InputError, match=r"differ.*newer.*`from_format='colmap'`"):
        read_rig_files([home], None)
    assert read_rig_files([home], "colmap-binary")[1].rig.cameras["left"].lens == "brown5"
    with pytest.raises(InputError, match=f"Give {home}"):
        read_rig_files([tmp_path], None)


def test_kalibr_that_contradicts_itself(tmp_path: Path) -> None:
    def camera(number: int, *poses: tuple[str, np.ndarray]) -> str:
        rows = "".join(
            f"  {key}:\n" + "".join(f"  - {row}\n" for row in pose.tolist()) for key, pose in poses
        )
        size = "  intrinsics: [500, 501, 320, 240]\n  resolution: [640, 480]\n"
        lens = "  camera_model: pinhole\n  distortion_model: radtan\n  distortion_coeffs: [0, 0, 0, 0]\n"
        return f"cam{number}:\n{lens}{size}{rows}"

    step, on_imu, away = np.eye(4), np.eye(4), np.eye(4)
    step[:3, :3], step[:3, 3], away[0, 3] = R, T / 1000.0, 0.004
    path = tmp_path / "a.yaml"
    first = camera(0, ("T_cam_imu", on_imu))
    path.write_text(first + camera(1, ("T_cam_imu", step @ on_imu), ("T_cn_cnm1", step)))
    assert baseline_mm(read_rig_files([path], None)[1].rig) == pytest.approx(np.linalg.norm(T))
    path.write_text(first + camera(1, ("T_cam_imu", away @ step), ("T_cn_cnm1", step)))
    with pytest.raises(InputError, match="contradict each other"):
        read_rig_files([path], None)
    path.write_text(first + camera(1, ("T_cam_imu", step), ("T_imu_cam", step)))
    with pytest.raises(InputError, match="T_cam_imu and T_imu_cam of cam1 contradict"):
        read_rig_files([path], None)


def test_ros_message_that_is_cut_off_and_one_of_a_part(tmp_path: Path) -> None:
    K, P = K1.ravel().tolist(), [900.0, 0.0, 512.0, 0.0, 0.0, 900.0, 380.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    message = (
        "header:\n  frame_id: front\nheight: 768\nwidth: 1024\ndistortion_model: plumb_bob\n"
        f"d: {D1.tolist()}\nk: {K}\nr: {np.eye(3).ravel().tolist()}\np: {P}\nbinning_x: 0\nbinning_y: 0\n"
        "roi:\n  x_offset: 0\n  height: 0\n  width: 0\n  do_rectify: false\n"
    )
    path = tmp_path / "a.yaml"
    path.write_text(message + "---\n" + message[: message.index("900.0, 380.0")] + "900.0]\n")
    (record,) = read_rig_files([path], None)[1].rig.cameras.values()
    assert record.K[0][0] == 905.5
    path.write_text(message.replace("binning_x: 0", "binning_x: 2"))
    assert "binning" in read_rig_files([path], None)[1].notes[0]


@pytest.mark.parametrize(
    ("old", "new"), [("rotation_3x3_matrix", "rotation_matrix"), ('"K1"', '"Kl"'), ('"ROW 1"', '"ROW 5"')]
)
def test_dice_with_a_name_that_it_does_not_have(
    old: str, new: str, tmp_path: Path, make_rig: MakeRig
) -> None:
    path = tmp_path / "a.xml"
    text = str(FORMATS["dice"].write(make_rig("brown5"), ".xml").files[0].text)
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match="is not known in a camera system file"):
        read_rig_files([path], None)


def test_a_table_of_toml_that_has_lost_its_name(tmp_path: Path, make_rig: MakeRig) -> None:
    text = str(FORMATS["anipose"].write(make_rig("brown5"), ".toml").files[0].text)
    path = tmp_path / "a.toml"
    path.write_text(text.replace("[cam_0]\n", ""))
    with pytest.raises(InputError, match="outside of any table"):
        read_rig_files([path], None)
