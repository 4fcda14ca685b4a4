"""Files of OpenCV's own programs and of all that cv::FileStorage writes: forms, keys and poses."""

import json
import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.io import loadmat, savemat

from labcal.cameras.interop.exchange import ReadOptions, ReadRig
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.errors import InputError

K1 = np.array([[900.5, 0.0, 640.25], [0.0, 905.5, 355.75], [0.0, 0.0, 1.0]])
K2 = np.array([[910.5, 0.0, 630.25], [0.0, 915.5, 365.75], [0.0, 0.0, 1.0]])
D1, D2 = np.array([-0.31, 0.12, 1e-3, -2e-3, 0.03]), np.array([-0.29, 0.11, -1e-3, 2e-3, 0.04])
TURN, T = np.array([0.02, -0.11, 0.03]), np.array([-62.5, 0.7, 1.2])
R = cv2.Rodrigues(TURN)[0]
POSE = np.vstack([np.c_[R, T], [0.0, 0.0, 0.0, 1.0]])
SIZE = {"image_width": 1280, "image_height": 720}
PAIR = {"M1": K1, "D1": D1, "M2": K2, "D2": D2, **SIZE}
BASE64 = cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_BASE64


def storage(path: Path, mode: int = cv2.FILE_STORAGE_WRITE, **values: object) -> Path:
    file = cv2.FileStorage(str(path), mode)
    for key, value in values.items():
        file.write(key, value)
    file.release()
    return path


def read(*paths: Path, **given: object) -> ReadRig:
    return read_rig_files(paths, None, ReadOptions(**given))[1]


def require_pair(found: ReadRig, dist: tuple[np.ndarray, np.ndarray] = (D1, D2)) -> None:
    first, second = found.rig.cameras.values()
    for record, K, one in ((first, K1, dist[0]), (second, K2, dist[1])):
        np.testing.assert_allclose(record.K, K)
        np.testing.assert_allclose(record.dist, one)
        assert record.size == (1280, 720)
    np.testing.assert_allclose(np.array(second.T_cam_world)[:3], np.c_[R, T], atol=1e-9)


def test_the_size_of_the_interactive_calibration(tmp_path: Path) -> None:
    path = tmp_path / "cameraParameters.xml"
    deviations = {"cameraMatrix_std_dev": np.ones(4), "dist_coeffs_std_dev": np.ones(5)}
    size = {"calibrationDate": "today", "framesCount": 30, "cameraResolution": np.array([1280, 720])}
    storage(path, **size, cameraMatrix=K1, dist_coeffs=D1, **deviations, avg_reprojection_error=0.3)
    (record,) = read(path).rig.cameras.values()
    np.testing.assert_allclose(record.K, K1)
    assert record.size == (1280, 720)
    with pytest.raises(InputError, match="1280x720, which `size` contradicts"):
        read(path, size=(640, 480))


@pytest.mark.parametrize("suffix", ["yml", "xml", "json"])
def test_matrices_in_base64(suffix: str, tmp_path: Path) -> None:
    path = storage(tmp_path / f"pair.{suffix}", BASE64, **PAIR, R=R, T=T[:, None])
    assert "MWQgICAg" in path.read_text()
    require_pair(read(path))
    storage(path, BASE64, **{**PAIR, "D1": D1.astype(np.float32)}, R=R, T=T.reshape(1, 1, 3))
    require_pair(read(path), (D1.astype(np.float32), D2))
    whole = path.read_text()
    at = whole.index("MWQgICAg")
    for damaged in (whole[: at + 40] + "*" + whole[at + 41 :], whole[:at] + "MWQ" + whole[at + 8 :]):
        path.write_text(damaged)
        with pytest.raises(InputError, match=r"the base64 of M1 is damaged.*without cv::FileStorage::BASE64"):
            read(path)
    path.write_text(whole[: at + 32] + whole[at + 40 :])  # six bytes less
    with pytest.raises(InputError, match="the base64 of M1 is damaged"):
        read(path)


def test_maps_in_one_line(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", camera_matrix=K1, distortion_coefficients=D1)
    flow = cv2.FILE_NODE_MAP | cv2.FILE_NODE_FLOW
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_APPEND)
    file.startWriteStruct("image_size", flow)
    file.write("width", 1280)
    file.write("height", 720)
    file.endWriteStruct()
    file.startWriteStruct("about", flow)
    file.write("camera_name", "left eye")
    file.write("fisheye", 0)
    file.startWriteStruct("seen", cv2.FILE_NODE_SEQ | cv2.FILE_NODE_FLOW)
    file.write("", 3)
    file.endWriteStruct()
    file.endWriteStruct()
    file.release()
    assert "{ width:1280, height:720 }" in path.read_text()
    (name, record), *_ = read(path).rig.cameras.items()
    assert (name, record.size) == ("left-eye", (1280, 720))
    for lens, line in (("fisheye-kb4", "fisheye:1"), ("brown5", "fisheye:0")):
        storage(path, camera_matrix=K1, distortion_coefficients=D1[:4], **SIZE)
        path.write_text(path.read_text() + f'about: {{ name:"a", {line} }}\n')
        assert next(iter(read(path).rig.cameras.values())).lens == lens


def test_a_matrix_without_its_numbers_is_refused(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", camera_matrix=K1, **SIZE)
    for damaged in ("", " !!opencv-matrix", " !!binary { a:1 }", " { a:1, a:2 }"):
        whole = path.read_text()
        path.write_text(f"{whole}distortion_coefficients:{damaged}\n")
        with pytest.raises(InputError, match=r"a\.yml"):
            read(path)
        path.write_text(whole)


@pytest.mark.parametrize("rows", [3, 4])
@pytest.mark.parametrize("form", ["yml", "json", "npz"])
def test_a_pose_in_one_matrix(form: str, rows: int, tmp_path: Path) -> None:
    path = tmp_path / f"pair.{form}"

    def written(**values: object) -> Path:
        if form == "npz":
            np.savez(path, **values)
        elif form == "json":
            path.write_text(json.dumps(values, default=lambda array: array.tolist()))
        else:
            storage(path, **values)
        return path

    require_pair(read(written(**PAIR, RT=POSE[:rows])))
    require_pair(read(written(**PAIR, transformation=POSE[:rows]), key={"R": "transformation"}))
    require_pair(read(path, key={"R": "transformation", "T": "transformation"}))
    with pytest.raises(InputError, match=r"or `key='R=KEY'` of a matrix \[R T\]"):
        read(path)
    written(camera_matrix=K2, dist_coeffs=D2, **SIZE, RT=POSE[:rows])
    for key in (None, {"camera_matrix": "camera_matrix", "R": "RT"}):
        (record,) = read(path, key=key).rig.cameras.values()
        np.testing.assert_allclose(np.array(record.T_cam_world), POSE, atol=1e-9)
    (record,) = read(path, key={"camera_matrix": "camera_matrix"}).rig.cameras.values()
    np.testing.assert_array_equal(record.T_cam_world, np.eye(4))


def test_a_pose_in_one_matrix_is_not_turned_over(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", **PAIR, RT=POSE.T.copy())
    with pytest.raises(InputError, match="last row of RT should be 0 0 0 1"):
        read(path)
    turned = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 5.0, 0.0]])
    with pytest.raises(InputError, match=r"RT should have rows of 4 numbers, \[R t\]"):
        read(storage(path, **PAIR, RT=turned))
    with pytest.raises(InputError, match="so that `key` should not name T"):
        read(storage(path, **PAIR, whole=POSE, shift=T), key={"R": "whole", "T": "shift"})
    require_pair(read(storage(path, **PAIR, R=R, T=T, RT=np.eye(4))))  # as R and T state it


def test_a_pair_of_omnidir(tmp_path: Path) -> None:
    """With rvec and tvec of the second camera; the boards' poses are extrinsic_parameters."""
    first, second = {"camera_matrix_1": K1, "xi_1": 1.1}, {"camera_matrix_2": K2, "xi_2": 1.2}
    first["distortion_coefficients_1"], second["distortion_coefficients_2"] = D1[:4], D2[:4]
    boards = {"extrinsic_parameters": np.ones((7, 6))}
    path = storage(tmp_path / "a.xml", nFrames=7, flags=0, **first, **second, rvec=TURN, tvec=T, **boards)
    found = read(path, size=(1280, 720))
    require_pair(found, (np.r_[1.1, D1[:4]], np.r_[1.2, D2[:4]]))
    assert {record.lens for record in found.rig.cameras.values()} == {"omni-radtan"}


@pytest.mark.parametrize("omnidirectional", [False, True])
def test_cameras_of_the_calibration_of_many(omnidirectional: bool, tmp_path: Path) -> None:  # noqa: FBT001 -- parametrised
    """A pose maps coordinates of the first camera to those of the camera, in 32 bits."""
    third = POSE @ POSE
    values: dict[str, object] = {"nCameras": 3}
    for number, (K, D, pose) in enumerate(((K1, D1, np.eye(4)), (K2, D2, POSE), (K2, D1, third))):
        values |= {f"camera_matrix_{number}": K, f"camera_distortion_{number}": D[None, :4]}
        values |= {f"xi_{number}": 1.0 + 0.1 * number} if omnidirectional else {}
        values[f"camera_pose_{number}"] = pose.astype(np.float32)
    boards = {"meanReprojectError": 0.2, "pose_timestamp_7": POSE}
    path = storage(tmp_path / "a.xml", **values, **boards)
    given = {"size": (1280, 720)} | ({} if omnidirectional else {"lens": "brown5"})
    cameras = read(path, **given).rig.cameras
    assert list(cameras) == ["camera-0", "camera-1", "camera-2"]
    np.testing.assert_allclose(cameras["camera-1"].T_cam_world, POSE, atol=1e-5)
    np.testing.assert_allclose(cameras["camera-2"].T_cam_world, third, atol=1e-5)
    lens, dist = ("omni-radtan", np.r_[1.1, D2[:4]]) if omnidirectional else ("brown5", np.r_[D2[:4], 0.0])
    assert cameras["camera-1"].lens == lens
    np.testing.assert_allclose(cameras["camera-1"].dist, dist)
    keys = {"M1": "camera_matrix_0", "D1": "camera_distortion_0", "M2": "camera_matrix_1",
            "D2": "camera_distortion_1", "R": "camera_pose_1"}  # fmt: skip
    if not omnidirectional:
        np.testing.assert_allclose(
            read(path, **given, key=keys).rig.cameras["right"].T_cam_world, POSE, atol=1e-5
        )
    for lost in ("camera_pose_1", "camera_matrix_2"):
        storage(path, **{key: one for key, one in values.items() if key != lost})
        with pytest.raises(InputError, match=r"states 3 cameras \(nCameras\), but has not camera_matrix"):
            read(path, **given)
    storage(path, **{**values, "nCameras": 2})
    with pytest.raises(InputError, match=r"states 2 cameras \(nCameras\)"):
        read(path, **given)


@pytest.mark.parametrize("keys", [("M1", "D1", "M2", "D2"), ("mtxL", "distL", "mtxR", "distR")])
def test_matrices_in_a_mat_file_are_sent_to_numpy(keys: tuple[str, ...], tmp_path: Path) -> None:
    values = dict(zip(keys, (K1, D1, K2, D2), strict=True)) | {"R": R, "T": T, "imageSize": [1280.0, 720.0]}
    for content, inside, simple in (
        (values, "", False),
        ({"s": values}, ", simplify_cells=True)['s']", True),
    ):
        savemat(tmp_path / "rig.mat", content)
        words = re.escape(f"numpy.savez('rig.npz', **scipy.io.loadmat('rig.mat'{inside or ')'})")
        with pytest.raises(InputError, match=words):
            read(tmp_path / "rig.mat")
        found = loadmat(tmp_path / "rig.mat", simplify_cells=simple)
        np.savez(tmp_path / "rig.npz", **(found["s"] if simple else found))
        require_pair(read(tmp_path / "rig.npz"))


def test_a_fisheye_of_matlab_is_told_as_that(tmp_path: Path) -> None:
    lens = {"MappingCoefficients": [800.0, -1e-4, 1e-7, -1e-10], "ImageSize": [720.0, 1280.0],
            "DistortionCenter": [640.0, 360.0], "StretchMatrix": np.eye(2)}  # fmt: skip
    for content in ({"p": lens}, {"cameraParams": {"Intrinsics": lens}}, lens):
        savemat(tmp_path / "a.mat", content)
        with pytest.raises(InputError, match=r"a fisheye of MATLAB .* no other way of saving it helps"):
            read(tmp_path / "a.mat")
    savemat(tmp_path / "a.mat", {"a": np.eye(4)})
    with pytest.raises(InputError, match="toStruct"):
        read(tmp_path / "a.mat")
