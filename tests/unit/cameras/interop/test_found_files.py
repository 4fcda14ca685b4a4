"""Camera files as other programs write them, with numbers of their own."""

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
import scipy.io

from labcal import pipeline
from labcal.cameras.interop.exchange import ReadOptions, Unit
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.interop.rig_files import baseline_mm, read_rig_files, write_rig_files
from labcal.cameras.rig import Rig
from labcal.cli import main
from labcal.errors import InputError

MakeRig = Callable[..., Rig]
K1 = np.array([[1000.5, 0.0, 511.25], [0.0, 998.5, 380.0], [0.0, 0.0, 1.0]])
K2 = np.array([[1010.5, 0.0, 500.0], [0.0, 1009.0, 390.5], [0.0, 0.0, 1.0]])
D1, D2 = (-0.2, 0.07, 1e-3, -2e-3, 0.01), (-0.18, 0.05, -1e-3, 1e-3, 0.02)
R = cv2.Rodrigues(np.array([0.02, -0.2, 0.01]))[0]
T = np.array([-90.0, 2.0, 7.0])
SIZE = (1024, 768)


def read(*paths: Path, **given: object) -> Rig:
    return read_rig_files(list(paths), None, ReadOptions(**given))[1].rig


def require_pair(rig: Rig, apart: float = float(np.linalg.norm(T))) -> None:
    first, second = (rig.camera(name) for name in rig.cameras)
    for camera, K, D in ((first, K1, D1), (second, K2, D2)):
        np.testing.assert_allclose(camera.K, K, rtol=1e-15)
        np.testing.assert_array_equal(camera.dist, D)
        assert camera.size == SIZE
    T_second_first = second.T_cam_world @ np.linalg.inv(first.T_cam_world)
    np.testing.assert_allclose(T_second_first[:3, :3], R, atol=1e-12)
    assert baseline_mm(rig) == pytest.approx(apart)


def mat(path: Path, content: dict[str, object]) -> Path:
    scipy.io.savemat(path, content, do_compression=True)
    return path


def matlab_camera(K: np.ndarray, D: tuple[float, ...]) -> dict[str, object]:
    """What toStruct makes of cameraParameters: of row vectors, pixels from 1."""
    K = K + np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    return {
        "RadialDistortion": [D[0], D[1], D[4]], "TangentialDistortion": [D[2], D[3]],
        "ImageSize": [SIZE[1], SIZE[0]], "IntrinsicMatrix": K.T, "WorldUnits": "millimeters",
    }  # fmt: skip


def test_matlab_counts_pixels_from_one_and_has_row_vectors(tmp_path: Path) -> None:
    stereo = {
        "CameraParameters1": matlab_camera(K1, D1), "CameraParameters2": matlab_camera(K2, D2),
        "RotationOfCamera2": R.T, "TranslationOfCamera2": T,
    }  # fmt: skip
    require_pair(read(mat(tmp_path / "a.mat", {"stereoParams": stereo})))
    require_pair(read(mat(tmp_path / "b.mat", stereo)))
    later = {key: value for key, value in stereo.items() if key[-1] == "1" or key[:6] == "Camera"}
    later["PoseCamera2"] = {"R": R, "Translation": T}
    require_pair(read(mat(tmp_path / "c.mat", {"stereoParams": later})))
    (alone,) = read(mat(tmp_path / "d.mat", {"cameraParams": matlab_camera(K1, D1)})).cameras.values()
    assert (alone.K[0][2], alone.K[1][2]) == (511.25, 380.0)
    contradicting = matlab_camera(K1, D1) | {"K": K1}
    with pytest.raises(InputError, match="contradict each other"):
        read(mat(tmp_path / "e.mat", {"cameraParams": contradicting}))
    with pytest.raises(InputError, match="toStruct"):
        read(mat(tmp_path / "f.mat", {"stereoParams": 1.0}))


def test_scipy_reads_what_is_written_for_matlab(tmp_path: Path, make_rig: MakeRig) -> None:
    rig = make_rig("brown5")
    chosen = FORMATS["matlab"]
    (path,) = write_rig_files(tmp_path / "rig.mat", chosen, chosen.write(rig, ".mat"), force=False)
    pair = scipy.io.loadmat(path, simplify_cells=True)["stereoParams"]
    assert pair["CameraParameters1"]["IntrinsicMatrix"][2, 0] == rig.camera("left").K[0, 2] + 1.0
    T_cam = rig.camera("right-2").T_cam_world
    np.testing.assert_array_equal(pair["RotationOfCamera2"].T, T_cam[:3, :3])
    np.testing.assert_array_equal(pair["TranslationOfCamera2"], T_cam[:3, 3])


def toml(fisheye: str = "", scale: float = 1.0) -> str:
    rows = []
    for number, (K, D, rotation, t) in enumerate((
        (K1, D1, np.zeros(3), np.zeros(3)), (K2, D2, cv2.Rodrigues(R)[0].ravel(), T * scale)
    )):  # fmt: skip
        rows.append(
            f'[cam_{number}]\nname = "c{number}"\nsize = [ 1024.0, 768.0,]\nmatrix = {K.tolist()}\n'
            f"distortions = {list(D)}\nrotation = {rotation.tolist()}\n"
            f"translation = {t.tolist()}\n{fisheye}\n"
        )
    return "\n".join([*rows, "[metadata]\nadjusted = false\nerror = 0.3\n"])


def test_toml_of_aniposelib_in_either_unit(tmp_path: Path) -> None:
    path = tmp_path / "calibration.toml"
    path.write_text(toml())
    with pytest.raises(InputError, match=r"90\.29 apart.*`unit='mm'` or `unit='m'`"):
        read(path)  # 90 mm, or 90 m
    require_pair(read(path, unit=Unit.MILLIMETRES))
    path.write_text(toml("fisheye = false", 1e-3))
    _, found = read_rig_files([path], None)
    require_pair(found.rig)
    assert found.unit is Unit.METRES
    path.write_text(toml().replace("[cam_", "[cameras."))
    require_pair(read(path, unit=Unit.MILLIMETRES))
    four = toml().replace(", 0.01]", "]").replace(", 0.02]", "]")
    path.write_text(four)
    with pytest.raises(InputError, match="`lens='brown5'` or `lens='fisheye-kb4'`"):
        read(path, unit=Unit.MILLIMETRES)
    lenses = {one.lens for one in read(path, unit=Unit.MILLIMETRES, lens="fisheye-kb4").cameras.values()}
    assert lenses == {"fisheye-kb4"}


def test_caldat_of_matchid(tmp_path: Path) -> None:
    angles = (1.5, -11.0, 0.25)
    x, y, z = (np.radians(one) for one in angles)
    turn = cv2.Rodrigues(np.array([0, 0, z]))[0] @ cv2.Rodrigues(np.array([0, y, 0]))[0]
    turn = turn @ cv2.Rodrigues(np.array([x, 0, 0]))[0]
    lines = []
    for number, (K, D) in enumerate(((K1, D1), (K2, D2))):
        values = (K[0, 0], K[1, 1], 0, D[0], D[1], D[4], D[2], D[3], K[0, 2], K[1, 2])
        labels = ("Fx [pixels]", "Fy [pixels]", "Fs [pixels]", "Kappa 1", "Kappa 2", "Kappa 3", "P1", "P2",
                  "Cx [pixels]", "Cy [pixels]")  # fmt: skip
        lines += [f"Cam{number}_{label};{value}" for label, value in zip(labels, values, strict=True)]
    lines += [f"{label} [mm];{value}" for label, value in zip(("Tx", "Ty", "Tz"), T, strict=True)]
    lines += [f"{label} [deg];{value}" for label, value in zip(("Theta", "Phi", "Psi"), angles, strict=True)]
    path = tmp_path / "a.caldat"
    path.write_text("\n".join(lines))
    rig = read(path, size=SIZE)
    np.testing.assert_allclose(rig.camera("cam1").T_cam_world[:3, :3], turn, atol=1e-14)
    np.testing.assert_array_equal(rig.camera("cam1").dist, D2)
    path.write_text("\n".join(lines[:4] + lines[5:]))
    with pytest.raises(InputError, match="Kappa 2 should be a finite number"):
        read(path, size=SIZE)


def test_a_moving_rig_of_colmap_keeps_its_cameras_places(tmp_path: Path, make_rig: MakeRig) -> None:
    rig = make_rig("brown5")
    chosen = FORMATS["colmap"]
    files = {one.label: one.text for one in chosen.write(rig, "").files}
    first = [line for line in files["images.txt"].splitlines() if line and line[0] != "#"]
    shifted = " ".join([*first[0].split()[:5], "10", "20", "30", "1", "b/0.png"]).replace("1 ", "7 ", 1)
    files["images.txt"] = "\n\n".join([first[0].replace("left.png", "b/1.png"), shifted, ""])
    files["frames.txt"] = ""
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    _, found = read_rig_files([tmp_path], None)
    assert "whose reference sensor is the world" in found.notes[0]
    for record, meant in zip(found.rig.cameras.values(), rig.cameras.values(), strict=True):
        np.testing.assert_allclose(record.T_cam_world, meant.T_cam_world, atol=1e-12)
    (tmp_path / "rigs.txt").unlink()
    with pytest.raises(InputError, match="took 2 images, and no rig gives it a place"):
        read_rig_files([tmp_path], None)


def test_images_and_rigs_of_colmap_that_contradict_each_other(tmp_path: Path, make_rig: MakeRig) -> None:
    for one in FORMATS["colmap"].write(make_rig("pinhole"), "").files:
        (tmp_path / one.label).write_text(
            str(one.text).replace("-180.3", "-185.3") if one.label == "rigs.txt" else one.text
        )
    with pytest.raises(InputError, match="another place than its rig and frame give it"):
        read_rig_files([tmp_path], None)


def test_keys_that_a_user_names(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = cv2.FileStorage(str(tmp_path / "a.yml"), cv2.FILE_STORAGE_WRITE)
    for key, value in (
        ("KL", K1),
        ("kL", np.array([D1])),
        ("KR", K2),
        ("kR", np.array([D2])),
        ("R", R),
        ("T", T),
    ):
        file.write(key, value)
    file.release()
    path, out = str(tmp_path / "a.yml"), str(tmp_path / "o.json")
    assert main(["convert", path, out, "--size", "1024x768"]) == 2
    assert "Its keys are KL, kL, KR, kR, R, T" in capsys.readouterr().err
    words = ["convert", path, out, "--size", "1024x768", "--key", "M1=KL,D1=kL"]
    assert main([*words, "--key", "M2=KR", "--key", "D2=kR"]) == 0
    require_pair(Rig.load(out))
    words = ["convert", path, out, "--size", "1024x768", "--force", "--key"]
    assert main([*words, "camera_matrix=KR,distortion_coefficients=kR"]) == 0
    (record,) = Rig.load(out).cameras.values()
    assert record.K[0][0] == 1010.5
    np.testing.assert_array_equal(record.T_cam_world, np.eye(4))
    capsys.readouterr()
    assert main([*words, "camera_matrix=nothing"]) == 2
    assert "has KL, kL, KR, kR, R, T" in capsys.readouterr().err


def test_what_is_understood_of_cameras(tmp_path: Path) -> None:
    pair = {
        "CameraParameters1": matlab_camera(K1, (0.0,) * 5), "CameraParameters2": matlab_camera(K2, D2),
        "RotationOfCamera2": R.T, "TranslationOfCamera2": T,
    }  # fmt: skip
    found = pipeline.understand(mat(tmp_path / "a.mat", {"stereoParams": pair}))
    first, second = found.cameras.values()
    assert (found.unit, found.baseline_mm) == ("mm", pytest.approx(np.linalg.norm(T)))
    np.testing.assert_allclose(
        first.corners_undistorted_px, [(0, 0), (1023, 0), (1023, 767), (0, 767)], atol=1e-9
    )
    corner = cv2.undistortPoints(np.array([[[1023.0, 767.0]]]), K2, np.array(D2), P=K2,
                                 criteria=(cv2.TERM_CRITERIA_COUNT, 200, 0))  # fmt: skip
    np.testing.assert_allclose(second.corners_undistorted_px[2], corner[0, 0], atol=1e-6)
    across = np.degrees(np.arctan(511.25 / 1000.5) + np.arctan((1023 - 511.25) / 1000.5))
    assert first.field_of_view_deg[0] == pytest.approx(across, abs=0.01)
    assert found.notes == []


def test_a_principal_point_outside_of_the_picture_is_told(tmp_path: Path) -> None:
    camera = matlab_camera(K1, D1) | {"ImageSize": [300, 400]}
    found = pipeline.understand(mat(tmp_path / "a.mat", {"cameraParams": camera}))
    assert "the principal point of a, (511.2, 380.0) px, lies outside" in found.notes[0]


def test_a_camera_that_states_its_place_the_other_way_round(tmp_path: Path) -> None:
    """T_imu_cam is the inverse of T_cam_imu, and either may be there."""
    T0, T1 = np.eye(4), np.eye(4)
    T0[:3, :3], T0[:3, 3] = cv2.Rodrigues(np.array([0.3, -1.2, 0.4]))[0], [0.05, 0.01, -0.02]
    T1[:3, :3], T1[:3, 3] = R, T / 1000.0
    places = ("T_cam_imu", T0), ("T_imu_cam", np.linalg.inv(T1 @ T0))
    text = ""
    for number, (key, pose) in enumerate(places):
        rows = "".join(f"  - {row}\n" for row in pose.tolist())
        text += (
            f"cam{number}:\n  {key}:\n{rows}  camera_model: pinhole\n  distortion_model: equidistant\n"
            "  distortion_coeffs: [0.01, -0.02, 0.003, 0]\n  intrinsics: [500, 501, 320, 240]\n"
            "  resolution: [640, 480]\n"
        )
    (tmp_path / "a.yaml").write_text(text)
    rig = read(tmp_path / "a.yaml")
    assert baseline_mm(rig) == pytest.approx(np.linalg.norm(T), rel=1e-9)
    np.testing.assert_allclose(rig.camera("cam1").T_cam_world[:3, :3], R, atol=1e-9)


def test_several_documents_of_ros(tmp_path: Path) -> None:
    K, P = K1.ravel().tolist(), [1000.5, 0.0, 511.25, 0.0, 0.0, 998.5, 380.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    message = (
        "header:\n  stamp:\n    sec: {}\n  frame_id: front\nheight: 768\nwidth: 1024\n"
        f"distortion_model: plumb_bob\nd: {list(D1)}\nk: {K}\nr: {np.eye(3).ravel().tolist()}\np: {P}\n"
    )
    path = tmp_path / "echo.yaml"
    path.write_text(message.format(1) + "---\n" + message.format(2) + "---\n")
    (record,) = read(path).cameras.values()
    assert (record.K[0][0], record.dist) == (1000.5, D1)
    path.write_text(message.format(1) + "---\n" + message.format(2).replace("1000.5", "1001.5"))
    with pytest.raises(InputError, match="2 documents that state different cameras of one name"):
        read(path)
    other = message.format(2).replace("front", "rear")
    apart = other.replace("1000.5, 0.0, 511.25, 0.0, 0.0", "1000.5, 0.0, 511.25, -120.06, 0.0")
    path.write_text(message.format(1) + "---\n" + apart + "---\n" + message.format(3))
    pair = read(path)
    assert list(pair.cameras) == ["front", "rear"]
    assert baseline_mm(pair) == pytest.approx(120.0)
    path.write_text(message.format(1) + "---\n" + other.replace("[-0", "[-1"))
    with pytest.raises(
        InputError, match=r"does not state how far apart.*each document, in a file of its own"
    ):
        read(path)


@pytest.mark.parametrize("word", ["0700.5", "1_000", "0x3E8", "17:00"])
def test_numbers_are_decimal(tmp_path: Path, word: str) -> None:
    """YAML 1.1 takes some of these for numbers that nobody wrote."""
    matrix = f"  rows: 3\n  cols: 3\n  dt: d\n  data: [{word}, 0, 511, 0, 998, 380, 0, 0, 1]\n"
    path = tmp_path / "a.yml"
    path.write_text(
        f"%YAML:1.0\n---\nimage_width: 1024\nimage_height: 768\ncamera_matrix: !!opencv-matrix\n{matrix}"
        "distortion_coefficients: [0, 0, 0, 0, 0]\n"
    )
    if word == "0700.5":
        assert read(path).camera("a").K[0, 0] == 700.5
        return
    with pytest.raises(InputError, match="should be a finite number"):
        read(path)


def test_only_what_is_understood_needs_no_output(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = mat(tmp_path / "a.mat", {"cameraParams": matlab_camera(K1, D1)})
    for words in (["--check", str(path)], [str(path), "--check"]):
        assert main(["convert", *words, "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["source"] == "matlab"
    assert main(["convert", str(path), "--json"]) == 2
    assert "OUT" in capsys.readouterr().out
    # An option may stand between the paths.
    assert main(["convert", str(path), "--to", "labcal", str(tmp_path / "rig.json")]) == 0
