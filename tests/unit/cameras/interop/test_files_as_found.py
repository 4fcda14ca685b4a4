"""Files of ROS, Kalibr, MATLAB, MatchID and mrcal as they are found, and of programs that are not read."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from labcal.cameras.interop.exchange import ReadOptions, ReadRig, Unit
from labcal.cameras.interop.registry import READ
from labcal.cameras.interop.rig_files import baseline_mm, read_rig_files
from labcal.errors import InputError, LabcalError

K = np.array([[1420.5, 0.0, 801.25], [0.0, 1418.25, 588.75], [0.0, 0.0, 1.0]])
D = [-0.31, 0.12, 7e-4, -1.1e-3, 0.02]
R, T = Rotation.from_rotvec([0.03, -0.21, 0.011]).as_matrix(), np.array([-212.4, 3.5, 18.25])
APART_MM = float(np.linalg.norm(T))
CAM = """cam{n}:
  camera_model: pinhole
  distortion_coeffs: [-0.31, 0.12, 0.0007, -0.0011]
  distortion_model: {model}
  intrinsics: [1420.5, 1418.25, 801.25, 588.75]
  resolution: [1600, 1200]
"""
STEP = """  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.1]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
"""


def read(*paths: Path, **given: object) -> ReadRig:
    return read_rig_files(paths, None, ReadOptions(**given))[1]


def camera_info(count: int) -> str:
    matrices = {
        "camera_matrix": (3, 3, K),
        "distortion_coefficients": (1, count, np.array(D[:count])),
        "rectification_matrix": (3, 3, np.eye(3)),
        "projection_matrix": (3, 4, np.c_[K, np.zeros(3)]),
    }
    text = "image_width: 1600\nimage_height: 1200\ncamera_name: left\n"
    for key, (rows, cols, values) in matrices.items():
        text += f"{key}:\n  rows: {rows}\n  cols: {cols}\n  data: {values.ravel().tolist()}\n"
    return text  # fmt: skip


def test_an_old_camera_info_does_not_state_its_model(tmp_path: Path) -> None:
    path = tmp_path / "left.yaml"
    path.write_text(camera_info(5))
    assert read_rig_files([path], None)[0].name == "ros"
    for model in ("", "distortion_model: ''\n", "distortion_model:\n"):
        path.write_text(camera_info(5) + model)
        assert list(next(iter(read(path).rig.cameras.values())).dist) == D
        path.write_text(camera_info(4) + model)  # Brown's or the fisheye's
        with pytest.raises(
            InputError, match=r"plumb_bob .* or equidistant .*: `lens='brown5'` or `lens='fish"
        ):
            read(path)
        for lens in ("brown5", "fisheye-kb4"):
            (record,) = read(path, lens=lens).rig.cameras.values()
            assert (record.lens, list(record.dist)) == (lens, [*D[:4], 0.0])
    path.write_text(camera_info(4) + "distortion_model: none\n")
    with pytest.raises(InputError, match="states the distortion model 'none', but has coefficients that are"):
        read(path)
    for count, model in ((5, ""), (4, "distortion_model: plumb_bob\n")):
        path.write_text(camera_info(count) + model)
        with pytest.raises(InputError, match="`lens` does not apply to files of the format 'ros'"):
            read(path, lens="fisheye-kb4")


def test_warnings_of_topic_echo_are_skipped(tmp_path: Path) -> None:
    rows = {"d": D, "k": K.ravel(), "r": np.eye(3).ravel(), "p": np.c_[K, np.zeros(3)].ravel()}
    text = "header:\n  frame_id: left\nheight: 1200\nwidth: 1600\ndistortion_model: plumb_bob\n"
    text += "".join(f"{key}:\n" + "".join(f"- {value!r}\n" for value in map(float, values))
                    for key, values in rows.items())  # fmt: skip
    text += "binning_x: 0\nbinning_y: 0\nroi:\n  x_offset: 0\n  do_rectify: false\n---\n"
    path = tmp_path / "info.yaml"
    path.write_text("A message was lost!!!\n\ttotal count change:1\n\ttotal count: 1---\n" + text * 2)
    (record,) = read(path).rig.cameras.values()
    assert list(record.dist) == D


def test_no_camera_of_a_chain_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "chain.yaml"
    path.write_text(CAM.format(n=0, model="radtan") + CAM.format(n=2, model="radtan") + STEP)
    with pytest.raises(InputError, match=r"has cam2, but no camera 'cam1' before it"):
        read(path)
    path.write_text(CAM.format(n=1, model="radtan"))
    with pytest.raises(InputError, match="no camera chain of Kalibr: it has no camera 'cam0'"):
        read(path)
    path.write_text(CAM.format(n=0, model="radtan") + CAM.format(n=1, model="radtan"))
    with pytest.raises(InputError, match=r"does not state where cam1 is: it has no T_cn_cnm1"):
        read(path)
    path.write_text(CAM.format(n=0, model="equi") + CAM.format(n=1, model="equi") + STEP)
    found = read(path).rig
    assert {record.lens for record in found.cameras.values()} == {"fisheye-kb4"}
    assert baseline_mm(found) == pytest.approx(100.0)


def struct(**more: object) -> dict[str, object]:
    return {"RadialDistortion": [[-0.31, 0.12, 0.02]], "TangentialDistortion": [[7e-4, -1.1e-3]],
            "ImageSize": [[1200.0, 1600.0]], **more}  # fmt: skip


@pytest.mark.parametrize(
    ("unit", "scale"), [("mm", 1.0), ("m", 1e-3), ("meters", 1e-3), ("cm", 0.1), ("inches", 1.0 / 25.4)]
)
def test_world_units_of_matlab(unit: str, scale: float, tmp_path: Path) -> None:
    one_based = K + np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    camera = struct(K=one_based, WorldUnits=unit)
    pose = {"A": np.vstack([np.c_[R, scale * T], [0.0, 0.0, 0.0, 1.0]])}
    path = tmp_path / "rig.mat"
    savemat(path, {"s": {"CameraParameters1": camera, "CameraParameters2": camera, "PoseCamera2": pose}})
    found = read_rig_files([path], None)[1]
    assert baseline_mm(found.rig) == pytest.approx(APART_MM)
    first, second = found.rig.cameras.values()
    np.testing.assert_allclose(np.array(second.T_cam_world)[:3, :3], R, atol=1e-12)
    np.testing.assert_allclose(first.K, K)
    assert any("are multiplied by" in note for note in found.notes) == (unit in {"cm", "inches"})
    if unit == "m":
        with pytest.raises(InputError, match="state themselves that lengths are in m"):
            read(path, unit=Unit.MILLIMETRES)


def test_world_units_that_are_none(tmp_path: Path) -> None:
    camera = struct(K=K, WorldUnits="squares")
    pair = {"CameraParameters1": camera, "CameraParameters2": camera, "RotationOfCamera2": R.T}
    savemat(tmp_path / "rig.mat", {"s": {**pair, "TranslationOfCamera2": T}})
    with pytest.raises(InputError, match=r"should be one unit of length, mm, cm, m, .*but is 'squares'"):
        read(tmp_path / "rig.mat")


def test_focal_lengths_of_matlab_in_place_of_a_matrix(tmp_path: Path) -> None:
    values = struct(FocalLength=[[1420.5, 1418.25]], PrincipalPoint=[[802.25, 589.75]], Skew=0.0)
    savemat(tmp_path / "a.mat", {"intrinsics": values})
    (record,) = read(tmp_path / "a.mat").rig.cameras.values()
    np.testing.assert_allclose(record.K, K)
    savemat(tmp_path / "a.mat", {"intrinsics": {**values, "K": K}})
    with pytest.raises(InputError, match="contradict each other"):
        read(tmp_path / "a.mat")


def caldat(angles: np.ndarray, unit: str) -> list[str]:
    lines = []
    for number in (0, 1):
        labels = {"Fx [pixels]": K[0, 0], "Fy [pixels]": K[1, 1], "Fs [pixels]": 0.0, "Kappa 1": D[0],
                  "Kappa 2": D[1], "Kappa 3": D[4], "P1": D[2], "P2": D[3], "Cx [pixels]": K[0, 2],
                  "Cy [pixels]": K[1, 2]}  # fmt: skip
        lines += [f"Cam{number}_{label};{float(value)!r}" for label, value in labels.items()]
    lines += [f"{label} [mm];{value!r}" for label, value in zip(("Tx", "Ty", "Tz"), T.tolist(), strict=True)]
    turns = zip(("Theta", "Phi", "Psi"), angles.tolist(), strict=True)
    return lines + [f"{label}{unit};{value!r}" for label, value in turns]


@pytest.mark.parametrize("unit", [" [rad]", "[Radians]", " [deg]", "[\u00b0]", ""])
def test_angles_of_caldat_are_in_the_unit_of_their_labels(unit: str, tmp_path: Path) -> None:
    angles = Rotation.from_matrix(R).as_euler("xyz", degrees="ad" not in unit)
    path = tmp_path / "a.caldat"
    path.write_text("\n".join(caldat(angles, unit)))
    found = read(path, size=(1600, 1200))
    np.testing.assert_allclose(np.array(list(found.rig.cameras.values())[1].T_cam_world)[:3], np.c_[R, T])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "Phi [rad]",
            "Phi [deg]",
            r"should be in \[deg\] or in \[rad\], all three, but are in \[deg\] and \[rad\]",
        ),
        ("Phi [rad]", "Phi", r"all three, but are in none and \[rad\]"),
        ("[rad]", "[gon]", r"but are in \[gon\]\. Convert"),
        ("Cam1_Fx [pixels]", "Cam1_Fx [mm]", r"'Cam1_Fx \[mm\]' should be in \[pixels\]"),
        ("Cam0_Kappa 1", "Cam0_Kappa 1 [1/mm^2]", "should have no unit"),
    ],
)
def test_units_that_no_caldat_has(old: str, new: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "a.caldat"
    path.write_text("\n".join(caldat(np.zeros(3), " [rad]")).replace(old, new))
    with pytest.raises(InputError, match=words):
        read(path, size=(1600, 1200))


def test_caldat_with_decimal_commas_and_in_metres(tmp_path: Path) -> None:
    lines = caldat(Rotation.from_matrix(R).as_euler("xyz", degrees=True), " [deg]")
    path = tmp_path / "a.caldat"
    path.write_text("\n".join(lines).replace(".", ","))
    found = read(path, size=(1600, 1200))
    np.testing.assert_allclose(np.array(list(found.rig.cameras.values())[1].T_cam_world)[:3], np.c_[R, T])
    path.write_text("\n".join(lines).replace("1420.5", "1420,5"))  # a damaged number among others
    with pytest.raises(InputError, match="Cam0_Fx should be a finite number"):
        read(path, size=(1600, 1200))
    path.write_text("\n".join(lines).replace("[mm]", "[m]"))
    with pytest.raises(InputError, match="state themselves that lengths are in m"):
        read(path, size=(1600, 1200), unit=Unit.MILLIMETRES)
    path.write_text("\n".join(lines).replace("[mm]", "[in]"))
    with pytest.raises(InputError, match="should be in mm or in m"):
        read(path, size=(1600, 1200))


def test_two_poses_of_mrcal_that_differ(tmp_path: Path) -> None:
    path = tmp_path / "a.cameramodel"
    content = {"lensmodel": "LENSMODEL_PINHOLE", "intrinsics": [600.0, 600.0, 319.5, 239.5],
               "extrinsics": [0.0] * 6, "rt_cam_ref": [0.0] * 6, "imagersize": [640, 480]}  # fmt: skip
    path.write_text(repr(content))
    assert len(read(path).rig.cameras) == 1
    path.write_text(repr({**content, "rt_cam_ref": [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]}))
    with pytest.raises(InputError, match="extrinsics and rt_cam_ref contradict each other"):
        read(path)


@pytest.mark.parametrize(("old", "lens"), [("OPENCV8", "rational8"), ("NONE", "pinhole")])
def test_files_of_mrcal_of_2019(old: str, lens: str, tmp_path: Path) -> None:
    more = [-0.02, 0.03, 2e-4, 5e-4, 0.0196, 0.01, -0.05, 0.04] if old != "NONE" else []
    content = {"distortion_model": f"DISTORTION_{old}", "intrinsics": [1761, 1761, 1965, 1087, *more],
               "extrinsics": [0.2, 0.1, -0.01, 2.0, 2, -2.5], "imagersize": [4000, 2200]}  # fmt: skip
    (tmp_path / "a.cameramodel").write_text(f"{content!r}\n")
    (record,) = read(tmp_path / "a.cameramodel").rig.cameras.values()
    assert (record.lens, list(record.dist)[: len(more)]) == (lens, more)


def test_a_pair_of_orb_slam_is_not_read_as_one_camera(tmp_path: Path) -> None:
    numbers = "".join(f"{name}: {value}\n" for name, value in
                      zip(("fx", "fy", "cx", "cy"), (700.0, 699.0, 320.0, 240.0), strict=True))  # fmt: skip
    first, second = (numbers.replace("f", f"{side}.f").replace("c", f"{side}.c") for side in
                     ("Camera1", "Camera2"))  # fmt: skip
    path, size = tmp_path / "a.yaml", "Camera.width: 640\nCamera.height: 480\n"
    path.write_text(size + first + second.replace("Camera2.fx", "Camera2.f"))
    with pytest.raises(InputError, match=r"is of a pair \(Camera2.*has no Camera2.fx"):
        read(path)
    path.write_text('Camera.type: "Rectified"\n' + size + first)
    with pytest.raises(InputError, match=r"is of a pair \(Rectified\), but has no Stereo.b"):
        read(path)
    path.write_text(size + first + "Camera.bf: 40.0\n")
    assert "one camera is read" in read(path).notes[0]


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (json.dumps({"cameraData": [[0, {"distortionCoeff": 1, "intrinsicMatrix": 1}]]}), "DepthAI"),
        (json.dumps({"CalibrationInformation": {"Cameras": []}}), "Azure Kinect"),
        (json.dumps({"cameras": {"a": {"K": 1}}, "camera_poses": {}}), "Multical"),
        ("RadTan 0.5 0.6 0.49 0.51 -0.2 0.1 0.0 0.0\n640 480\ncrop\n640 480\n", "DSO"),
        ("extrinsic\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n\nintrinsic\n1 0 1\n0 1 1\n0 0 1\n", "MVSNet"),
        ("# Bundle file v0.3\n1 0\n1000 0 0\n", "Bundler"),
        ("NVM_V3\n\n1\na.jpg 1000 1 0 0 0 0 0 0 0.1 0\n", "VisualSFM"),
        ('ParGroup: Cam1: Internal Parameters;\nCamType: "area_scan_division";\n', "HALCON"),
        ("Pix4D camera calibration file 0\nF 3.6\n", "Pix4D"),
        ("[CAMERA_PARAMS_LEFT]\nresolution = [640 480]\n", "MRPT"),
        ("cameras:\n- camera:\n    intrinsics: 1\n    distortion: 2\n  T_B_C:\n    rows: 4\n", "SVO"),
        ("P0: 7.2e+02 0 6.1e+02 0 0 7.2e+02 1.7e+02 0 0 0 1 0\n", "KITTI"),
        ("CameraIntrinsics:\n  CameraMatrix:\n    CX: 957.1\n    CY: 594.3\n", "Zivid"),
    ],
)
def test_programs_whose_files_are_not_read_are_named(text: str, what: str, tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text(text)
    with pytest.raises(InputError, match=rf"is of no format that is read here\. It seems to be .*{what}"):
        read(path)


@pytest.mark.parametrize("text", ["", "# oST v", "a: 1\n", "{}", "[]", "<a/>", "1 2 3\n", "\0"])
@pytest.mark.parametrize("name", list(READ))
def test_a_format_that_is_named_wrongly_is_an_error(name: str, text: str, tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text(text)
    with pytest.raises(LabcalError):
        read_rig_files([tmp_path / "a.txt"], name)


def test_what_has_no_matrix_is_left_out_with_a_note(tmp_path: Path) -> None:
    matrix = ", ".join(str(row) for row in K.tolist())
    text = f"[cam_0]\nsize = [1600, 1200]\nmatrix = [{matrix}]\ndistortions = {D}\n\n"
    (tmp_path / "a.toml").write_text(text + "[cam_1]\nsize = [1600, 1200]\n\n[metadata]\nerror = 0.2\n")
    found = read(tmp_path / "a.toml")
    assert found.notes == ("[cam_1] has no matrix: it is left out.",)
    assert list(found.rig.cameras) == ["cam-0"]
    (tmp_path / "a.toml").write_text(text + '[metadata]\nunits = "cm"\n')
    with pytest.raises(InputError, match="the unit 'cm' is neither mm nor m"):
        read(tmp_path / "a.toml")


def test_a_truncated_model_of_colmap_is_told(tmp_path: Path) -> None:
    path = tmp_path / "cameras.bin"
    path.write_bytes(bytes([1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]))
    with pytest.raises(InputError, match="damaged, truncated or a part"):
        read(path)


def test_the_first_camera_of_an_ost_is_not_left_out(tmp_path: Path) -> None:
    (tmp_path / "ost.txt").write_text("[image]\n\nwidth\n640\n\n# oST version 5.0 parameters\n\n[image]\n")
    with pytest.raises(InputError, match="it should begin with '# oST version'"):
        read(tmp_path / "ost.txt")
