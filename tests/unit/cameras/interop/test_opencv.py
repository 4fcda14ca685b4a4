"""OpenCV reads what labcal writes, labcal reads what OpenCV writes, and both project alike."""

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.cameras.interop.exchange import ReadOptions, ReadRig, SourceText, Unit
from labcal.cameras.interop.opencv import read_opencv, write_opencv
from labcal.cameras.interop.rig_files import baseline_mm, read_rig_files
from labcal.cameras.rig import Rig
from labcal.errors import InputError

MakeRig = Callable[..., Rig]
LENSES = ("pinhole", "brown-k1k2", "brown5", "rational8", "thin-prism12", "tilted14", "fisheye-kb4")
SUFFIXES = (".yml", ".xml")
K1 = np.array([[900.5, 0.0, 640.25], [0.0, 905.5, 355.75], [0.0, 0.0, 1.0]])
K2 = np.array([[910.5, 0.0, 630.25], [0.0, 915.5, 365.75], [0.0, 0.0, 1.0]])
D1, D2 = np.array([-0.31, 0.12, 1e-3, -2e-3, 0.03]), np.array([-0.29, 0.11, -1e-3, 2e-3, 0.04])
TURN, T = np.array([0.02, -0.11, 0.03]), np.array([-62.5, 0.7, 1.2])
R = cv2.Rodrigues(TURN)[0]
SIZE = {"image_width": 1280, "image_height": 720}
PAIR = {"M1": K1, "D1": D1, "M2": K2, "D2": D2, **SIZE}


def storage(path: Path, mode: int = cv2.FILE_STORAGE_WRITE, **values: object) -> Path:
    file = cv2.FileStorage(str(path), mode)
    for key, value in values.items():
        file.write(key, value)
    file.release()
    return path


def read(*paths: Path, **given: object) -> ReadRig:
    return read_rig_files(paths, None, ReadOptions(**given))[1]


def require_pair(found: ReadRig) -> None:
    first, second = found.rig.cameras.values()
    for record, K, dist in ((first, K1, D1), (second, K2, D2)):
        np.testing.assert_allclose(record.K, K)
        np.testing.assert_allclose(record.dist, dist)
        assert record.size == (1280, 720)
    np.testing.assert_allclose(np.array(second.T_cam_world)[:3], np.c_[R, T], atol=1e-9)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("lens", LENSES)
def test_opencv_reads_a_pair_and_projects_alike(
    lens: str, suffix: str, tmp_path: Path, make_rig: MakeRig, points: np.ndarray
) -> None:
    rig = make_rig(lens)
    path = tmp_path / f"pair{suffix}"
    path.write_text(write_opencv(rig, suffix).files[0].text)
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    found = {key: file.getNode(key).mat() for key in ("M1", "D1", "M2", "D2", "R", "T")}
    assert file.getNode("image_width").real() == 640.0
    assert file.getNode("camera_name2").string() == "right-2"
    np.testing.assert_array_equal(found["D1"].ravel(), rig.cameras["left"].dist[: found["D1"].size])
    rvec, _ = cv2.Rodrigues(found["R"])
    for name, K, dist, turn, shift in (
        ("left", found["M1"], found["D1"], np.zeros((3, 1)), np.zeros((3, 1))),
        ("right-2", found["M2"], found["D2"], rvec, found["T"]),
    ):
        if lens == "fisheye-kb4":
            q, _ = cv2.fisheye.projectPoints(points[:, None], turn, shift, K, dist)
        else:
            q, _ = cv2.projectPoints(points, turn, shift, K, dist)
        seen = rig.camera(name).project(points)
        assert seen.ok.sum() > 100
        np.testing.assert_allclose(q[:, 0][seen.ok], seen.q[seen.ok], atol=1e-8)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_opencv_writes_is_read_to_the_last_digit(suffix: str, tmp_path: Path) -> None:
    K = np.array([[700.1, 0.0, 1000 / 3], [0.0, 690.2, 237.1], [0.0, 0.0, 1.0]])
    dist = np.array([-0.3, 1e-17, 2 / 3e3, -1e-3, 1e20 / 3e22])
    camera = {"camera_matrix": K, "distortion_coefficients": dist[:, None], "avg_reprojection_error": 0.1}
    path = storage(tmp_path / f"mono{suffix}", image_width=640, image_height=480, **camera)
    (record,) = read(path).rig.cameras.values()
    np.testing.assert_array_equal(record.K, K)
    np.testing.assert_array_equal(record.dist, dist)
    assert record.size == (640, 480)
    np.testing.assert_array_equal(record.T_cam_world, np.eye(4))


def test_a_camera_without_its_picture_size_or_with_skew_is_refused() -> None:
    text = (
        "%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
        "   data: [ 700., 0., 320., 0., 700., 240., 0., 0., 1. ]\n"
        "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
        "   data: [ 0., 0., 0., 0., 0. ]\n"
    )
    size = "image_width: 640\nimage_height: 480\n"
    source = Path("a.yml")
    with pytest.raises(InputError, match=r"`size='1280x960'`\. Or add the keys image_width and image_height"):
        read_opencv([SourceText(source, text)])
    with pytest.raises(InputError, match=r"has a skew of 0\.5"):
        read_opencv([SourceText(source, text.replace("700., 0., 320.", "700., 0.5, 320.") + size)])
    with pytest.raises(InputError, match="size of a picture"):
        read_opencv([SourceText(source, text + size.replace("640", "-640"))])
    with pytest.raises(InputError, match="without its pose"):
        read_opencv([SourceText(source, text + size), SourceText(Path("b.yml"), text + size)])
    assert read_opencv([SourceText(source, text + size)]).rig.cameras["a"].lens == "pinhole"


@pytest.mark.parametrize(
    ("key", "word", "scale", "unit"),
    [
        ("unit", "cm", 0.1, Unit.MILLIMETRES),
        ("units", "m", 1e-3, Unit.METRES),
        ("unit", "mm", 1.0, Unit.MILLIMETRES),
        ("lengthUnit", "Inches", 1.0 / 25.4, Unit.MILLIMETRES),
        ("world_units", "metres", 1e-3, Unit.METRES),
    ],
)
@pytest.mark.parametrize("form", ["yml", "xml", "npz", "json", "intrinsics"])
def test_a_stated_unit_is_honoured(
    form: str, key: str, word: str, scale: float, unit: Unit, tmp_path: Path
) -> None:
    path, pose = tmp_path / f"pair.{form}", {"R": R, "T": T * scale}
    if form == "npz":
        np.savez(path, **PAIR, **pose, **{key: word})
    elif form == "json":
        content = {"left": {"K": K1, "D": D1}, "right": {"K": K2, "D": D2}, "stereo": {**pose, key: word}}
        path.write_text(json.dumps(content | SIZE, default=lambda array: array.tolist()))
    elif form == "intrinsics":  # and the pose in a file beside them
        path = storage(tmp_path / "intrinsics.yml", **PAIR)
        storage(tmp_path / "extrinsics.yml", **pose, **{key: word})
    else:
        storage(path, **PAIR, **pose, **{key: word})
    found = read(path)
    require_pair(found)
    assert found.unit is unit
    assert any("lengths are multiplied by" in note for note in found.notes) == (word in {"cm", "Inches"})
    other = Unit.METRES if word in {"mm", "cm", "Inches"} else Unit.MILLIMETRES
    with pytest.raises(InputError, match=rf"in {word} \(the unit in .*states otherwise\. Leave that out"):
        read(path, unit=other)


def test_a_stated_unit_of_a_camera_alone_and_one_that_is_none(tmp_path: Path) -> None:
    camera = {"camera_matrix": K1, "distortion_coefficients": D1, **SIZE}
    (record,) = read(storage(tmp_path / "a.yml", **camera, R=R, T=T / 10.0, unit="cm")).rig.cameras.values()
    np.testing.assert_allclose(np.array(record.T_cam_world)[:3, 3], T)
    for word in ("cubits", "1000"):
        with pytest.raises(InputError, match=rf"one unit of length, mm, cm, m, .*but is '{word}'\. Correct"):
            read(storage(tmp_path / "b.yml", **PAIR, R=R, T=T, unit=word))
    with pytest.raises(InputError, match="but is 'cm' and 'mm'"):
        read(storage(tmp_path / "c.yml", **PAIR, R=R, T=T, unit="cm", length_unit="mm"))
    # Units of pixels and angles, and those of a sensor, are none of the pose.
    text = json.dumps(PAIR | {"R": R, "T": T}, default=lambda array: array.tolist())
    for more in ('"unit": "px"', '"sensor": {"pitch": 3.45, "unit": "um"}'):
        (tmp_path / "d.json").write_text(f"{text[:-1]}, {more}}}")
        require_pair(read(tmp_path / "d.json"))


def test_squares_that_are_too_small_for_mm_are_asked_about(tmp_path: Path) -> None:
    for square in (0.1, 0.999):
        path = storage(tmp_path / "a.yml", **PAIR, R=R, T=T / 50.0, square_size=square)
        with pytest.raises(InputError, match=rf"squares of {square} \(square_size\).*`unit='m'` or"):
            read(path)
    assert baseline_mm(read(path, unit=Unit.METRES).rig) == pytest.approx(20.0 * np.linalg.norm(T))
    for square in (1.0, 25.0):
        require_pair(read(storage(path, **PAIR, R=R, T=T, square_size=square)))
    camera = {"camera_matrix": K1, "distortion_coefficients": D1, **SIZE, "square_size": 0.1}
    assert read(storage(path, **camera)).rig.cameras["a"].size == (1280, 720)  # it has no length


def three_files(folder: Path, keys: tuple[str, str, str, str], names: tuple[str, str]) -> list[Path]:
    """A file a camera, and one of R and T."""
    values = zip(names, (keys[:2], keys[2:]), ((K1, D1), (K2, D2)), strict=True)
    files = [
        storage(folder / name, **SIZE, **dict(zip(pair, one, strict=True))) for name, pair, one in values
    ]
    return [*files, storage(folder / "stereo.yml", R=R, T=T, E=np.eye(3))]


@pytest.mark.parametrize(
    "keys",
    [("M1", "D1", "M2", "D2"), ("K_left", "D_left", "K_right", "D_right"), ("M0", "D0", "M1", "D1"),
     ("cameraMatrixL", "distCoeffsL", "cameraMatrixR", "distCoeffsR")],
)  # fmt: skip
def test_a_pair_in_three_files_with_the_keys_of_a_pair(
    keys: tuple[str, str, str, str], tmp_path: Path
) -> None:
    # The second camera's file comes first by its name; the keys tell which one is the first camera.
    files = three_files(tmp_path, keys, ("z.yml", "a.yml"))
    for given in (files, files[::-1], [tmp_path]):
        found = read(*given)
        require_pair(found)
        assert list(found.rig.cameras) == ["z", "a"]
        assert found.notes == (
            "R and T of stereo.yml are taken to map coordinates of z.yml to those of a.yml.",
        )


def test_keys_that_do_not_tell_the_first_camera_leave_it_to_the_order(tmp_path: Path) -> None:
    files = three_files(tmp_path, ("M1", "D1", "M1", "D1"), ("a.yml", "b.yml"))
    require_pair(read(*files))
    (tmp_path / "one").mkdir()
    require_pair(read(*three_files(tmp_path / "one", ("K", "D", "K_right", "D_right"), ("a.yml", "b.yml"))))


def test_a_part_of_a_pair_is_told_as_that(tmp_path: Path) -> None:
    path = storage(tmp_path / "leftonly.yml", camera_matrix_left=K1, dist_left=D1, **SIZE)
    with pytest.raises(
        InputError, match=r"holds one camera of a pair, camera_matrix_left, and not the other"
    ):
        read(path)
    for given in (path, path.rename(tmp_path / "second.yml")):
        with pytest.raises(
            InputError, match=r"`key='camera_matrix=camera_matrix_left'`, or name the keys of"
        ):
            read(storage(given, camera_matrix_left=K1, dist_left=D1, **SIZE))
    (record,) = read(path, key={"camera_matrix": "camera_matrix_left"}).rig.cameras.values()
    np.testing.assert_allclose(record.dist, D1)
    (alone := tmp_path / "alone").mkdir()
    with pytest.raises(
        InputError, match=r"holds R and T, but no camera\. Give it together with the files of"
    ):
        read(storage(alone / "extr.yml", R=R, T=T))
    cameras = storage(tmp_path / "cameras.yml", **PAIR)
    pose = storage(alone / "extr.yml", R=R, T=T)
    require_pair(read(cameras, pose))
    with pytest.raises(
        InputError, match=r"two cameras, but is given with leftonly\.yml, which holds no R and T"
    ):
        read(cameras, pose, path)
    with pytest.raises(InputError, match=r"two cameras, but several poses R, T of the second one are given"):
        read(cameras, pose, storage(tmp_path / "second.yml", R=R, T=2.0 * T))


def test_files_beside_one_do_not_make_it_fail(tmp_path: Path) -> None:
    third = {"M3": K1, "D3": D2, "R12": R, "T12": T, "R13": R, "T13": 2.0 * T}
    storage(tmp_path / "three.yml", **PAIR, **third)
    cameras = storage(tmp_path / "cameras.yml", **PAIR)
    with pytest.raises(InputError, match=r"cameras\.yml holds two cameras, but no pose"):
        read(cameras)
    pose = storage(tmp_path / "extr.yml", R=R, T=T)
    for given in (cameras, pose):
        require_pair(read(given))


@pytest.mark.parametrize(("right", "left"), [("derecha", "izquierda"), ("cam_dx", "cam_sx"), ("R", "L")])
def test_the_first_camera_of_a_folder_is_the_left_one(right: str, left: str, tmp_path: Path) -> None:
    for name, focal in ((right, 900.0), (left, 700.0)):
        written(
            tmp_path / f"{name}.yml",
            camera_matrix=np.array([[focal, 0, 320], [0, focal, 240], [0, 0, 1]]),
            distortion_coefficients=np.zeros((1, 5)),
            image_width=640,
            image_height=480,
        )
    written(tmp_path / "stereo.yml", R=np.eye(3), T=np.array([[-60.0], [0.0], [0.0]]))
    _, read = read_rig_files([tmp_path], None)
    assert list(read.rig.cameras) == [left.replace("_", "-"), right.replace("_", "-")]
    assert f"map coordinates of {left}.yml to those of {right}.yml" in read.notes[-1]
    ordered = [tmp_path / f"{name}.yml" for name in (right, left, "stereo")]
    _, read = read_rig_files(ordered, None)
    assert next(iter(read.rig.cameras)) == right.replace("_", "-")  # as they are given


def written(path: Path, **values: object) -> None:
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for key, value in values.items():
        storage.write(key, value)
    storage.release()
