"""Formats that are read and not written: the same pixels as by OpenCV's or the paper's own formulas."""

import io
import itertools
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np
import pytest
from robot_files import (
    BROWN,
    DA,
    DB,
    FA,
    FB,
    FOUR,
    KA,
    KB,
    NUMBERS,
    ON_BODY,
    SECOND_FIRST,
    SIZE,
    R,
    T,
    basalt,
    camodocal,
    euroc,
    four,
    keyed,
    metashape,
    named,
    orb_pair,
    orb_rectified,
    ost,
    transforms,
)
from scipy.io import savemat

from labcal.cameras.interop.exchange import ReadOptions
from labcal.cameras.interop.foreign_files import foreign_words
from labcal.cameras.interop.registry import FORMATS, READ_ONLY
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.cameras.rig import Rig
from labcal.errors import InputError, LabcalError

Judge = Callable[[np.ndarray], np.ndarray]
SQUARE = np.diag([1893.4, 1893.4, 1.0]) + KA * [[0, 0, 1], [0, 0, 1], [0, 0, 0]]
FIVE = np.array([*DA, -0.09])


def by_brown(K: np.ndarray, D: np.ndarray) -> Judge:
    return lambda p: cv2.projectPoints(p, np.zeros(3), np.zeros(3), K, D)[0][:, 0]


def by_fisheye(K: np.ndarray, D: np.ndarray) -> Judge:
    return lambda p: cv2.fisheye.projectPoints(p[:, None], np.zeros(3), np.zeros(3), K, D)[0][:, 0]


def by_omni(K: np.ndarray, xi: float, D: np.ndarray) -> Judge:
    return lambda p: cv2.omnidir.projectPoints(p[:, None], np.zeros(3), np.zeros(3), K, xi, D)[0][:, 0]


def by_depth(K: np.ndarray, depth: Callable[[np.ndarray], np.ndarray]) -> Judge:
    return lambda p: p[:, :2] / depth(p)[:, None] * [K[0, 0], K[1, 1]] + [K[0, 2], K[1, 2]]


def sphere_depth(xi: float, alpha: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return the divisor of the double-sphere camera (Usenko et al. 2018, eq. 40)."""

    def depth(p: np.ndarray) -> np.ndarray:
        shifted = xi * np.linalg.norm(p, axis=1) + p[:, 2]
        far = np.sqrt(p[:, 0] ** 2 + p[:, 1] ** 2 + shifted**2)
        return alpha * far + (1 - alpha) * shifted

    return depth


def unified_depth(alpha: float, beta: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda p: (
        alpha * np.sqrt(beta * (p[:, 0] ** 2 + p[:, 1] ** 2) + p[:, 2] ** 2) + (1 - alpha) * p[:, 2]
    )


SINGLE: dict[str, tuple[str, str, Judge]] = {
    "euroc": ("cam0.yaml", euroc(KA, DA, ON_BODY), by_brown(KA, DA)),
    "euroc, fisheye": ("cam0.yaml", euroc(KA, FA, ON_BODY, "equidistant"), by_fisheye(KA, FA)),
    "camodocal": (
        "cam0.yaml",
        camodocal("PINHOLE", NUMBERS, four(KA), "distortion_parameters:\n" + keyed(BROWN, DA, "   ")),
        by_brown(KA, DA),
    ),
    "camodocal, unified": (
        "cam0.yaml",
        camodocal(
            "MEI",
            ("gamma1", "gamma2", "u0", "v0"),
            four(KA),
            "mirror_parameters:\n   xi: 0.9\ndistortion_parameters:\n" + keyed(BROWN, DA, "   "),
        ),
        by_omni(KA, 0.9, DA),
    ),
    "camodocal, fisheye": (
        "cam0.yaml",
        camodocal(
            "KANNALA_BRANDT", ("k2", "k3", "k4", "k5", "mu", "mv", "u0", "v0"), [*FA.tolist(), *four(KA)]
        ),
        by_fisheye(KA, FA),
    ),
    "orb-slam": (
        "cam0.yaml",
        "%YAML:1.0\n"
        + keyed(NUMBERS, four(KA), "Camera.")
        + keyed((*BROWN, "k3"), FIVE, "Camera.")
        + "Camera.width: 2048\nCamera.height: 1536\nORBextractor.nFeatures: 1000\n",
        by_brown(KA, FIVE),
    ),
    "basalt": (
        "c.json",
        basalt("ds", named(KA, ("xi", "alpha"), (-0.2, 0.57))),
        by_depth(KA, sphere_depth(-0.2, 0.57)),
    ),
    "basalt, eucm": (
        "c.json",
        basalt("eucm", named(KA, ("alpha", "beta"), (0.6, 1.1))),
        by_depth(KA, unified_depth(0.6, 1.1)),
    ),
    "basalt, ucm": (
        "c.json",
        basalt("ucm", named(KA, ("alpha",), (0.6,))),
        by_depth(KA, unified_depth(0.6, 1.0)),
    ),
    "basalt, pinhole": ("c.json", basalt("pinhole", named(KA)), by_brown(KA, np.zeros(5))),
    "ost": ("ost.txt", ost(("left", KA, FIVE, np.eye(3), np.c_[KA, np.zeros(3)])), by_brown(KA, FIVE)),
    "nerfstudio": ("transforms.json", transforms("OPENCV", BROWN, DA), by_brown(KA, DA)),
    "nerfstudio, fisheye": ("t.json", transforms("OPENCV_FISHEYE", FOUR, FA), by_fisheye(KA, FA)),
    "nerfstudio, of instant-ngp": ("t.json", transforms(None, BROWN, DA), by_brown(KA, DA)),
    "nerfstudio, instant-ngp's fisheye": (
        "t.json",
        transforms(None, FOUR, FA).replace("{", '{"is_fisheye": true, ', 1),
        by_fisheye(KA, FA),
    ),
    "metashape": (
        "frame.xml",
        metashape(
            "frame",
            {
                "f": 1891.9,
                "b1": 1.5,
                "cx": 1017.8 - 1024,
                "cy": 782.2 - 768,
                "k1": -0.132,
                "k2": 0.171,
                "k3": -0.09,
                "p1": 0.00043,
                "p2": -0.00071,
            },
        ),
        by_brown(KA, FIVE),
    ),
    "metashape, fisheye": (
        "fisheye.xml",
        metashape(
            "fisheye",
            {
                "f": 1893.4,
                "cx": 1017.8 - 1024,
                "cy": 782.2 - 768,
                **dict(zip(FOUR, FA.tolist(), strict=True)),
            },
        ),
        by_fisheye(SQUARE, FA),
    ),
}


def rectified() -> tuple[Sequence[np.ndarray], Sequence[np.ndarray]]:
    """Return rotations and projections (m) of the rectified pair."""
    R1, R2, P1, P2, *_ = cv2.stereoRectify(KA, FIVE, KB, FIVE, SIZE, R, T[:, None])
    return (R1, R2), (P1, P2 * [1.0, 1.0, 1.0, 1e-3])


TURNS, IDEALS = rectified()
PAIRS: dict[str, tuple[dict[str, str], tuple[Judge, Judge]]] = {
    "euroc": (
        {
            "cam0/sensor.yaml": euroc(KA, DA, ON_BODY),
            "cam1/sensor.yaml": euroc(KB, DB, SECOND_FIRST @ ON_BODY),
        },
        (by_brown(KA, DA), by_brown(KB, DB)),
    ),
    "orb-slam": (
        {"a.yaml": orb_pair("PinHole", BROWN, (DA, DB), "Stereo.T_c1_c2")},
        (by_brown(KA, DA), by_brown(KB, DB)),
    ),
    "orb-slam, fisheye": (
        {"a.yaml": orb_pair("KannalaBrandt8", FOUR, (FA, FB), "Tlr")},
        (by_fisheye(KA, FA), by_fisheye(KB, FB)),
    ),
    "orb-slam, version 2": ({"a.yaml": orb_rectified()}, (by_brown(KA, DA), by_brown(KB, DB))),
    "basalt": (
        {"c.json": basalt("kb4", named(KA, FOUR, FA), named(KB, FOUR, FB))},
        (by_fisheye(KA, FA), by_fisheye(KB, FB)),
    ),
    "ost": (
        {"ost.txt": ost(("left", KA, FIVE, TURNS[0], IDEALS[0]), ("right", KB, FIVE, TURNS[1], IDEALS[1]))},
        (by_brown(KA, FIVE), by_brown(KB, FIVE)),
    ),
}


@pytest.fixture
def in_camera() -> np.ndarray:
    """200 points in the frame of a camera, mm."""
    return np.random.default_rng(5).uniform(-1.0, 1.0, (200, 3)) * [250.0, 180.0, 100.0] + [0.0, 0.0, 600.0]


def require_pixels(rig: Rig, name: str, judge: Judge, in_camera: np.ndarray) -> None:
    camera = rig.camera(name)
    p = (in_camera - camera.T_cam_world[:3, 3]) @ camera.T_cam_world[:3, :3]
    np.testing.assert_allclose(camera.project(p).q, judge(in_camera), rtol=0.0, atol=1e-5)
    assert camera.size == SIZE


@pytest.mark.parametrize("case", list(SINGLE))
def test_a_camera_is_the_one_that_its_program_means(case: str, tmp_path: Path, in_camera: np.ndarray) -> None:
    file, text, judge = SINGLE[case]
    (tmp_path / file).write_text(text)
    found, read = read_rig_files([tmp_path / file], None)
    assert found.name == case.split(",", maxsplit=1)[0]
    (name,) = read.rig.cameras
    require_pixels(read.rig, name, judge, in_camera)


@pytest.mark.parametrize("case", list(PAIRS))
def test_a_pair_stands_as_its_program_means(case: str, tmp_path: Path, in_camera: np.ndarray) -> None:
    files, judges = PAIRS[case]
    for file, text in files.items():
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text(text)
    found, read = read_rig_files([tmp_path / file for file in files], None)
    assert found.name == case.split(",", maxsplit=1)[0]
    for name, judge in zip(read.rig.cameras, judges, strict=True):
        require_pixels(read.rig, name, judge, in_camera)
    first, second = (read.rig.camera(name).T_cam_world for name in read.rig.cameras)
    stated = second @ np.linalg.inv(first)
    np.testing.assert_allclose(stated[:3, :3], R, atol=1e-7)
    np.testing.assert_allclose(stated[:3, 3], T, atol=1e-3)
    if case == "euroc":
        assert list(read.rig.cameras) == ["cam0", "cam1"]


def test_results_of_bouguets_toolbox(tmp_path: Path, in_camera: np.ndarray) -> None:
    def camera(K: np.ndarray, D: np.ndarray, side: str) -> dict[str, object]:
        fx, fy, cx, cy = four(K)
        numbers: dict[str, object] = {
            "fc": [[fx], [fy]],
            "cc": [[cx], [cy]],
            "kc": D[:, None],
            "alpha_c": 0.0,
        }
        return {f"{name}{side}": value for name, value in numbers.items()}

    size = {"nx": float(SIZE[0]), "ny": float(SIZE[1])}
    stereo = {**camera(KA, FIVE, "_left"), **camera(KB, FIVE, "_right"), "T": T[:, None], **size}
    turns = {"om": cv2.Rodrigues(R)[0], "R": R}
    for key, value in turns.items():
        savemat(tmp_path / f"{key}.mat", {**stereo, key: value})
        rig = read_rig_files([tmp_path / f"{key}.mat"], None)[1].rig
        require_pixels(rig, "left", by_brown(KA, FIVE), in_camera)
        require_pixels(rig, "right", by_brown(KB, FIVE), in_camera)
        np.testing.assert_allclose(rig.camera("right").T_cam_world[:3, :3], R, atol=1e-12)
        np.testing.assert_allclose(rig.camera("right").T_cam_world[:3, 3], T)
    savemat(tmp_path / "one.mat", camera(KA, FIVE, ""))
    with pytest.raises(InputError, match="does not state how large"):
        read_rig_files([tmp_path / "one.mat"], None)
    (record,) = read_rig_files([tmp_path / "one.mat"], None, ReadOptions(size=SIZE))[1].rig.cameras.values()
    assert record.K[0][2] == KA[0, 2]
    savemat(tmp_path / "skew.mat", {**camera(KA, FIVE, ""), **size, "alpha_c": 1e-3})
    with pytest.raises(InputError, match="skew"):
        read_rig_files([tmp_path / "skew.mat"], None)


@pytest.mark.parametrize(
    ("file", "text", "match"),
    [
        ("a.yaml", euroc(KA, DA, ON_BODY, "atan"), "'atan' has no counterpart"),
        ("a.yaml", euroc(KA, DA, ON_BODY).replace("camera\n", "imu\n", 1), "sensor is 'imu'"),
        ("a.yaml", camodocal("SCARAMUZZA", NUMBERS, four(KA)), "'SCARAMUZZA' has no counterpart"),
        ("a.yaml", orb_pair("PinHole", BROWN, (DA, DB), "Other"), "no Stereo.T_c1_c2"),
        ("a.yaml", orb_pair("Spherical", BROWN, (DA, DB), "Tlr"), "'Spherical' has no counterpart"),
        ("a.yaml", "%YAML:1.0\n" + keyed(NUMBERS, four(KA), "Camera."), "does not state how large"),
        ("a.json", basalt("fov", named(KA)), "'fov' has no counterpart"),
        ("a.json", basalt("ds", named(KA, ("xi",), (0.1,))), "has no alpha"),
        ("ost.txt", ost(("left", KA, DA, np.eye(3), np.c_[KA, np.zeros(3)])), "four coefficients"),
        ("a.json", transforms(None, FOUR, FA), "as a fisheye has"),
        ("a.json", transforms(None, BROWN[:3], DA[:3]), "has no p2"),
        ("a.json", basalt("pinhole-radtan8", named(KA, BROWN, DA)), "has no k3"),
        (
            "ost.txt",
            ost(("left", KA, FIVE, np.eye(3), np.c_[KA, np.zeros(3)])).replace("rectification\n", ""),
            "'distortion' should have 1 lines of numbers, but has 4",
        ),
        ("a.json", transforms("EQUIRECTANGULAR", (), ()), "'EQUIRECTANGULAR' has no counterpart"),
        ("a.xml", metashape("frame", {"f": 1900.0, "k4": 0.1}), "Fix them at 0"),
        ("a.xml", metashape("frame", {"f": 1900.0, "b2": 0.1}), "b2 is not zero"),
        ("a.xml", metashape("fisheye", {"f": 1900.0, "p1": 0.1}), "Fix them at 0"),
    ],
)  # fmt: skip
def test_what_labcal_does_not_have_is_refused_by_name(
    file: str, text: str, match: str, tmp_path: Path
) -> None:
    (tmp_path / file).write_text(text)
    with pytest.raises(InputError, match=match):
        read_rig_files([tmp_path / file], None)


def test_cameras_without_places_are_no_rig(tmp_path: Path) -> None:
    text = camodocal("PINHOLE", NUMBERS, four(KA), "distortion_parameters:\n" + keyed(BROWN, DA, "   "))
    for name in ("a.yaml", "b.yaml"):
        (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match="without their places"):
        read_rig_files([tmp_path / "a.yaml", tmp_path / "b.yaml"], None)


@pytest.mark.parametrize("name", list(READ_ONLY))
def test_they_are_not_written(name: str, make_rig: Callable[..., Rig]) -> None:
    assert name not in FORMATS
    with pytest.raises(InputError, match=f"'{name}' are read, not written"):
        READ_ONLY[name].write(make_rig("pinhole"), ".yaml")


@pytest.mark.parametrize("case", list(SINGLE))
def test_damaged_files_raise_errors_of_labcal_alone(case: str, tmp_path: Path) -> None:
    file, text, _ = SINGLE[case]
    rng = np.random.default_rng(3)
    letters = list('0123456789.-e+[]{}:,<>/" \nk\x00é')
    for _ in range(60):
        mutant = list(text)
        for place in rng.integers(0, len(mutant), rng.integers(1, 4)):
            mutant[place] = str(rng.choice(letters))
        cut = len(mutant) if rng.random() < 0.7 else int(rng.integers(0, len(mutant)))
        (tmp_path / file).write_text("".join(mutant[:cut]))
        try:
            read_rig_files([tmp_path / file], None)
        except LabcalError:
            continue


def test_one_text_is_of_one_format() -> None:
    texts = [text for _, text, _ in SINGLE.values()] + [
        text for files, _ in PAIRS.values() for text in files.values()
    ]
    for text, one in itertools.product(texts, FORMATS.values()):
        assert not one.recognises(text)


FOREIGN = {
    "KITTI": b"calib_time: 09-Jan-2012\nK_00: 1 0 2 0 1 2 0 0 1\nD_00: 0 0 0 0 0\n",
    "Middlebury": b"cam0=[3979.9 0 1244.8; 0 3979.9 1019.5; 0 0 1]\ncam1=[1 0 1; 0 1 1; 0 0 1]\n",
    "ZED": b"[LEFT_CAM_HD]\nfx=700\n",
    "DaVis": b'<Calibration><CoordinateMapper CameraIdentifier="1"/></Calibration>',
    "Qualisys": b'<calibration><camera serial="1"><fov_video left="0"/></camera></calibration>',
    "Vicon": b'<Cameras FORMAT_VERSION="1.2"></Cameras>',
    "project of Metashape": b'<document version="2.0.0">\n <chunk label="C"></chunk></document>',
    "OpenSfM": b'{"v2": {"projection_type": "brown"}}',
    "TheiaSfM": b'{"priors": [{"CameraIntrinsicsPrior": {}}]}',
    "AliceVision": b'{"intrinsics": [{"intrinsicId": "1"}]}',
    "RealSense": b'{"width": 640, "ppx": 320.1, "ppy": 240.2}',
    "Open3D": b'{"intrinsic_matrix": [1, 0, 0, 0, 1, 0, 2, 2, 1]}',
    "Bouguet": b"%-- Focal length:\nfc = [ 1200.1 ; 1201.2 ];\n",
    "cahvor": b"Model = CAHVOR = perspective, distortion\n",
    "a target": b"kind: charuco\nname: b\n",
    "COLMAP keeps its features": b"SQLite format 3\0\0\0",
    "images.txt": b"# Image list\n1 1.0 0 0 0 0.5 -1e-3 2 1 a.png\n10 20 -1\n",
    "points": b"ply\nformat ascii 1.0\n",
    "a target of Kalibr": b"target_type: 'aprilgrid'\ntagCols: 6\n",
    "an IMU": b"imu0:\n  rostopic: /imu0\n",
    "Kalibr's results": b"Calibration results\n====\nCamera-system parameters:\n\tcam0 (/cam0/image_raw):\n",
    "a shoot": b'{"format": "labcal-shoot"}',
    "numbers without names": b"1.2e3 0.0 640.5\n0 1.2e3 480\n0 0 1\n",
    "empty": b"\n",
    "a picture": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
    "pickle": b"\x80\x04\x95\x1a\0\0\0",
    "HDF5": b"\x89HDF\r\n\x1a\n\0\0",
}  # fmt: skip


@pytest.mark.parametrize("what", list(FOREIGN))
def test_files_of_other_programs_are_named_with_another_way(what: str, tmp_path: Path) -> None:
    path = tmp_path / "camera.any"
    path.write_bytes(FOREIGN[what])
    with pytest.raises(InputError, match=rf"It seems to be .*{what}.*\. \w.*\.$"):
        read_rig_files([path], None)


def test_one_array_of_numpy_is_named(tmp_path: Path) -> None:
    held = io.BytesIO()
    np.save(held, KA)
    (tmp_path / "mtx.npy").write_bytes(held.getvalue())
    with pytest.raises(InputError, match=r"one array of NumPy.*numpy\.savez"):
        read_rig_files([tmp_path / "mtx.npy"], None)


@pytest.mark.parametrize("text", ["\n" * 30_000, "{ " * 10_000, "K1" * 10_000, " " * 30_000])
def test_no_pattern_takes_the_square_of_a_files_length(text: str) -> None:
    """Before, 30,000 empty lines took OpenCV's patterns 48 s."""
    begun = time.process_time()
    assert not FORMATS["opencv"].recognises(text)
    foreign_words(text)
    assert time.process_time() - begun < 2.0
