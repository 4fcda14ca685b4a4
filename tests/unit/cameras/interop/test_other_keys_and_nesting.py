"""Matrices of OpenCV under names, in shapes and at depths that other people's programs give them."""

import json
import tarfile
from collections.abc import Mapping
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.cameras.interop.exchange import ReadOptions, ReadRig, Unit
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.errors import InputError

K1 = np.array([[1420.5, 0.0, 801.25], [0.0, 1418.25, 588.75], [0.0, 0.0, 1.0]])
K2 = np.array([[1398.125, 0.0, 790.5], [0.0, 1396.5, 611.375], [0.0, 0.0, 1.0]])
D1, D2 = np.array([-0.31, 0.12, 7e-4, -1.1e-3, 0.02]), np.array([-0.29, 0.1, -4e-4, 9e-4, 0.013])
TURN, T = np.array([0.03, -0.21, 0.011]), np.array([-212.4, 3.5, 18.25])
R = cv2.Rodrigues(TURN)[0]
SIZE = (1600, 1200)
GIVEN = ReadOptions(size=SIZE)
HEAD = "%YAML:1.0\n---\n"


def matrix(key: str, values: np.ndarray, dt: str = "d") -> str:
    rows, cols = np.atleast_2d(values).shape
    data = ", ".join(repr(float(one)) for one in values.ravel())
    return f"{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: {dt}\n   data: [ {data} ]\n"


def storage(path: Path, **matrices: np.ndarray) -> Path:
    path.write_text(HEAD + "".join(matrix(key, values) for key, values in matrices.items()))
    return path


def document(path: Path, content: Mapping[str, object]) -> Path:
    path.write_text(json.dumps(content, default=lambda array: array.tolist()))
    return path


def read(*paths: Path, **given: object) -> ReadRig:
    return read_rig_files(paths, None, ReadOptions(**given))[1]


def require_pair(read: ReadRig, second_size: tuple[int, int] = SIZE) -> None:
    first, second = read.rig.cameras.values()
    np.testing.assert_allclose(first.K, K1)
    np.testing.assert_allclose(second.K, K2)
    np.testing.assert_allclose(first.dist, D1)
    np.testing.assert_allclose(second.dist, D2)
    np.testing.assert_allclose(np.array(second.T_cam_world)[:3], np.c_[R, T], atol=1e-9)
    assert (first.size, second.size) == (SIZE, second_size)


@pytest.mark.parametrize(
    "keys",
    [
        ("l_intrinsic", "l_distortion", "r_intrinsic", "r_distortion"),
        ("CM1", "D1", "CM2", "D2"),
        ("leftCameraMatrix", "leftDistCoeffs", "rightCameraMatrix", "rightDistCoeffs"),
        ("LEFT_K", "LEFT_D", "RIGHT_K", "RIGHT_D"),
        ("intrinsicMatrixL", "distortionCoeffsL", "intrinsicMatrixR", "distortionCoeffsR"),
        ("intrinsics1", "distortion1", "intrinsics2", "distortion2"),
        ("CameraMatrix-Left", "Dist_Coefs-Left", "CameraMatrix-Right", "Dist_Coefs-Right"),
    ],
)
def test_capitals_and_separators_do_not_matter(keys: tuple[str, ...], tmp_path: Path) -> None:
    pose = {"Rotation_Matrix": R, "Translation_Vector": T}
    path = storage(tmp_path / "a.yml", **dict(zip(keys, (K1, D1, K2, D2), strict=True)), **pose)
    require_pair(read(path, size=SIZE))


@pytest.mark.parametrize("pose", [("rotation", "translation"), ("rotation_matrix", "translation_matrix")])
def test_names_of_a_pose(pose: tuple[str, str], tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", M1=K1, D1=D1, M2=K2, D2=D2, **{pose[0]: R, pose[1]: T})
    require_pair(read(path, size=SIZE))


def test_the_pose_of_one_camera_as_a_rotation_vector_is_not_dropped(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", camera_matrix=K1, dist_coeffs=D1, rvec=TURN, tvec=T)
    (record,) = read(path, size=SIZE).rig.cameras.values()
    np.testing.assert_allclose(np.array(record.T_cam_world)[:3], np.c_[R, T], atol=1e-12)
    np.savez(tmp_path / "a.npz", mtx=K1, dist=D1, rvec=TURN, tvec=T, rvecs=np.ones((5, 3)))
    (record,) = read(tmp_path / "a.npz", size=SIZE).rig.cameras.values()
    np.testing.assert_allclose(np.array(record.T_cam_world)[:3], np.c_[R, T], atol=1e-12)


def test_openpose_calls_a_pose_camera_matrix(tmp_path: Path) -> None:
    files = []
    for name, K, D, pose in (("a", K1, D1, np.eye(3, 4)), ("b", K2, D2, np.c_[R, T / 1000.0])):
        path = tmp_path / f"{name}.yml"
        files.append(storage(path, CameraMatrix=pose, Intrinsics=K, Distortion=np.r_[D, np.zeros(3)]))
    require_pair(read(*files, size=SIZE, unit=Unit.METRES))


def test_two_cameras_and_a_file_that_places_them(tmp_path: Path) -> None:
    files = [storage(tmp_path / "left.yml", camera_matrix=K1, distortion_coefficients=D1),
             storage(tmp_path / "right.yml", camera_matrix=K2, distortion_coefficients=D2)]  # fmt: skip
    pose = storage(tmp_path / "stereo.yml", R=R, T=T)
    found = read(*files, pose, size=SIZE)
    require_pair(found)
    assert "map coordinates of left.yml to those of right.yml" in found.notes[0]
    assert list(found.rig.cameras) == ["left", "right"]
    require_pair(read(tmp_path, size=SIZE))
    with pytest.raises(InputError, match="two cameras and a file with R and T"):
        read(*files, size=SIZE)


@pytest.mark.parametrize("label", ["a", "b", "c", "d", "e", "f"])
def test_keys_within_keys(label: str, tmp_path: Path) -> None:
    left, right, pose = {"K": K1, "D": D1}, {"K": K2, "D": D2}, {"R": R, "T": T}
    sized = [{**one, "image_size": SIZE} for one in (left, right)]
    contents = {
        "a": {"Left": left, "Right": right, **pose, "image_size": SIZE},
        "b": {"cam0": left, "cam1": right, **pose, "resolution": {"width": 1600, "height": 1200}},
        "c": {"camera1": {"mtx": K1, "dist": D1}, "camera2": {"mtx": K2, "dist": D2}, "stereo": pose,
              "image_size": SIZE},
        "d": {"left": left, "right": right, "extrinsics": pose, "image_size": SIZE},
        "e": {"left": sized[0], "right": sized[1], **pose},
        "f": {"left": left, "right": right, "stereo": {"rotation": R, "T": T}, "resolution": SIZE},
    }  # fmt: skip
    require_pair(read(document(tmp_path / "a.json", contents[label])))


def test_each_camera_may_have_a_size_of_its_own(tmp_path: Path) -> None:
    left = {"K": K1, "D": D1, "image_size": SIZE}
    right = {"K": K2, "D": D2, "image_size": (1580, 1210)}
    path = document(tmp_path / "a.json", {"left": left, "right": right, "R": R, "T": T})
    require_pair(read(path), (1580, 1210))
    with pytest.raises(InputError, match="states a picture size of 1600x1200"):
        read(path, size=(640, 480))


@pytest.mark.parametrize("key", ["resolution", "frame_size", "imageSize", "DIM"])
def test_names_of_the_size_and_contradictions(key: str, tmp_path: Path) -> None:
    content = {"mtx": K1, "dist": [D1], key: SIZE}
    (record,) = read(document(tmp_path / "a.json", content)).rig.cameras.values()
    assert record.size == SIZE
    with pytest.raises(InputError, match="1600x1200, which `size` contradicts"):
        read(tmp_path / "a.json", size=(640, 480))
    twice = document(tmp_path / "b.json", {**content, "image_width": 800, "image_height": 600})
    with pytest.raises(InputError, match="several sizes of the pictures, 800x600 and 1600x1200"):
        read(twice)


def test_photonvision(tmp_path: Path) -> None:
    def held(values: np.ndarray) -> dict[str, object]:
        rows, cols = np.atleast_2d(values).shape
        return {"rows": rows, "cols": cols, "type": 6, "data": values.ravel().tolist()}

    content = {"resolution": {"width": 1600.0, "height": 1200.0}, "cameraIntrinsics": held(K1),
               "distCoeffs": held(D1), "observations": [{"snapshot": 1}] * 30,
               "lensmodel": "LENSMODEL_OPENCV"}  # fmt: skip
    (record,) = read(document(tmp_path / "a.json", content)).rig.cameras.values()
    np.testing.assert_allclose(record.K, K1)
    assert record.size == SIZE


def test_the_unified_lens_of_omnidir_is_not_taken_for_brown(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", camera_matrix=K1, distortion_coefficients=D1[:4], xi=np.array([1.2]))
    (record,) = read(path, size=SIZE).rig.cameras.values()
    assert (record.lens, record.dist) == ("omni-radtan", (1.2, *D1[:4]))
    with pytest.raises(InputError, match=r"has xi.*states otherwise"):
        read(path, size=SIZE, lens="brown5")
    storage(path, camera_matrix=K1, distortion_coefficients=D1)
    path.write_text(path.read_text() + "camera_model: double_sphere\n")
    with pytest.raises(InputError, match="states the lens 'double_sphere'"):
        read(path, size=SIZE)


def test_shapes_that_do_not_fit_are_refused_and_channels_count(tmp_path: Path) -> None:
    data = ", ".join(map(repr, D1.tolist()))
    fits = (
        f'distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 1\n   dt: "5d"\n   data: [{data}]\n'
    )
    path = tmp_path / "a.yml"
    path.write_text(HEAD + matrix("camera_matrix", K1) + fits)
    (record,) = read(path, size=SIZE).rig.cameras.values()
    np.testing.assert_allclose(record.dist, D1)
    lost = f"distortion_coefficients: !!opencv-nd-matrix\n   sizes: [ 8 ]\n   dt: d\n   data: [{data}]\n"
    path.write_text(HEAD + matrix("camera_matrix", K1) + lost)
    with pytest.raises(InputError, match="states 8 numbers, but holds 5"):
        read(path, size=SIZE)


def test_a_transposed_camera_matrix_is_told_as_that(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", intrinsicMatrix=K1.T, distortionCoefficients=D1, R=R.T, T=T)
    with pytest.raises(InputError, match=r"is transposed.*as MATLAB"):
        read(path, size=SIZE)


def test_some_keys_of_a_pair_may_be_named_alone(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", cameraMatrixL=K1, kappaL=D1, cameraMatrixR=K2, kappaR=D2, R=R, T=T)
    with pytest.raises(InputError, match=r"has no D1.*kappaL.*`key='D1=KEY'`"):
        read(path, size=SIZE)
    require_pair(read(path, size=SIZE, key={"D1": "kappaL", "D2": "kappaR"}))
    with pytest.raises(InputError, match="names camera_matrix, of one camera, and D1, of a pair"):
        read(path, size=SIZE, key={"camera_matrix": "cameraMatrixL", "D1": "kappaL"})


def test_keys_are_named_of_files_that_no_format_takes_for_its_own(tmp_path: Path) -> None:
    path = document(tmp_path / "a.json", {"lens": {"eins": K1, "zwei": D1}})
    with pytest.raises(InputError, match=r"There are eins, zwei, lens_eins, lens_zwei"):
        read(path, size=SIZE)
    keys = {"camera_matrix": "eins", "distortion_coefficients": "lens_zwei"}
    (record,) = read(path, size=SIZE, key=keys).rig.cameras.values()
    np.testing.assert_allclose(record.dist, D1)


@pytest.mark.parametrize("form", ["cam_{}_K", "camera_{}_camera_matrix", "mtx{}", "M{}", "camera_matrix_{}"])
@pytest.mark.parametrize("first", [0, 1])
def test_a_third_camera_is_not_left_out(form: str, first: int, tmp_path: Path) -> None:
    matrices = {form.format(number): K for number, K in enumerate((K1, K2, K1), start=first)}
    path = storage(tmp_path / "a.yml", **matrices, R=R, T=T)
    with pytest.raises(InputError, match="holds more than two cameras"):
        read(path, size=SIZE)


def test_numbers_with_names_are_no_matrix(tmp_path: Path) -> None:
    path = document(tmp_path / "a.json", {"fx": 700.0, "fy": 700.0, "cx": 320.0, "cy": 240.0, "k1": 0.1})
    with pytest.raises(InputError, match=r"has fx, fy, cx, cy: write them as a matrix"):
        read(path, size=SIZE)


def test_a_key_that_is_named_is_used(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", camera_matrix=K1, distortion_coefficients=D1, turn=R)
    with pytest.raises(InputError, match=r"names R or T, but .* has not both"):
        read(path, size=SIZE, key={"R": "turn"})


def test_half_a_pose_is_not_left_out(tmp_path: Path) -> None:
    for keys in ({"R": R, "t": T}, {"rvec": TURN, "tvec_": T}, {"tvec": T}, {"T": T, "Q": R}):
        camera = {"camera_matrix": K1, "distortion_coefficients": D1}
        path = storage(tmp_path / "a.yml", **camera, **{key.rstrip("_"): one for key, one in keys.items()})
        if "tvec_" in keys:
            text = path.read_text()
            path.write_text(text[: text.rindex("data:")])
        with pytest.raises(InputError, match=r"a pose has both|should hold 3 numbers"):
            read(path, size=SIZE)
    path = storage(tmp_path / "a.yml", **camera, R=R, P=np.eye(3, 4))  # of a rectified picture
    assert read(path, size=SIZE).rig.cameras["a"].T_cam_world[0][:3] == (1.0, 0.0, 0.0)


def test_the_pose_of_a_board_is_not_taken_for_that_of_a_pair(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", M1=K1, D1=D1, M2=K2, D2=D2, rvec=TURN, tvec=T)
    with pytest.raises(InputError, match="no pose R, T of the second one"):
        read(path, size=SIZE)
    storage(path, M1=K1, D1=D1, M2=K2, D2=D2)
    storage(tmp_path / "board.yml", rvec=TURN, tvec=T)
    with pytest.raises(InputError, match="no pose R, T of the second one"):
        read(path, size=SIZE)


def test_documents_that_are_appended(tmp_path: Path) -> None:
    path = tmp_path / "a.yml"
    for mode, matrices in ((cv2.FILE_STORAGE_WRITE, {"M1": K1, "D1": D1, "M2": K2, "D2": D2}),
                           (cv2.FILE_STORAGE_APPEND, {"R": R, "T": T})):  # fmt: skip
        file = cv2.FileStorage(str(path), mode)
        for key, values in matrices.items():
            file.write(key, values)
        file.release()
    require_pair(read(path, size=SIZE))
    path.write_text(path.read_text() + "...\n---\n" + matrix("M1", K2))
    with pytest.raises(InputError, match="the key M1 occurs twice, in two documents"):
        read(path, size=SIZE)


def test_keys_within_keys_of_xml(tmp_path: Path) -> None:
    def held(key: str, values: np.ndarray) -> str:
        rows, cols = np.atleast_2d(values).shape
        data = " ".join(repr(float(one)) for one in values.ravel())
        shape = f"<rows>{rows}</rows><cols>{cols}</cols><dt>d</dt>"
        return f'<{key} type_id="opencv-matrix">{shape}<data>{data}</data></{key}>'

    path = tmp_path / "a.xml"
    left, right = held("K", K1) + held("D", D1), held("K", K2) + held("D", D2)
    size = "<images><_>a.png</_><_>b.png</_></images><size><width>1600</width><height>1200</height></size>"
    path.write_text(
        f"<opencv_storage><left>{left}</left><right>{right}</right>{held('R', R)}{held('T', T)}{size}"
        "</opencv_storage>"
    )
    require_pair(read(path))
    path.write_text(path.read_text().replace("</left>", f"{held('K', K2)}</left>"))
    with pytest.raises(InputError, match="the key K occurs twice"):
        read(path)


@pytest.mark.parametrize("keys", [("camera_matrix", "dist"), ("one", "two")])
def test_objects_of_python_are_told(keys: tuple[str, str], tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text(f"{keys[0]}: !!python/tuple\n- [1, 2]\n{keys[1]}: [0, 0, 0, 0, 0]\n")
    with pytest.raises(InputError, match=r"objects of Python.*array\.tolist\(\)"):
        read(path, size=SIZE)


def test_archives_and_bags_of_ros_are_told(tmp_path: Path) -> None:
    (tmp_path / "ost.yaml").write_text("image_width: 1\n")
    with tarfile.open(tmp_path / "calibrationdata.tar.gz", "w:gz") as archive:
        archive.add(tmp_path / "ost.yaml", "ost.yaml")
    with pytest.raises(InputError, match=r"is an archive \(tar\).*ost\.yaml"):
        read(tmp_path / "calibrationdata.tar.gz")
    (tmp_path / "a.bag").write_bytes(b"#ROSBAG V2.0\n\0")
    with pytest.raises(InputError, match="a bag of ROS"):
        read(tmp_path / "a.bag")


def test_coefficients_beside_a_matrix_that_is_named(tmp_path: Path) -> None:
    path = storage(tmp_path / "a.yml", cameraMatrixL=K1, distCoeffsL=D1, cameraMatrixR=K2, distCoeffsR=D2)
    for name, K, D in (("cameraMatrixL", K1, D1), ("cameraMatrixR", K2, D2)):
        (record,) = read(path, size=SIZE, key={"camera_matrix": name}).rig.cameras.values()
        np.testing.assert_allclose(record.K, K)
        np.testing.assert_allclose(record.dist, D)
    storage(path, one=K1, lens=D1)
    with pytest.raises(InputError, match=r"has no distortion_coefficients.*Its keys are one, lens; name"):
        read(path, size=SIZE, key={"camera_matrix": "one"})
