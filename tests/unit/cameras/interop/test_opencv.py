"""OpenCV reads what labcal writes, labcal reads what OpenCV writes, and both project alike."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.cameras.interop.exchange import SourceText
from labcal.cameras.interop.opencv import read_opencv, write_opencv
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.cameras.rig import Rig
from labcal.errors import InputError

MakeRig = Callable[..., Rig]
LENSES = ("pinhole", "brown-k1k2", "brown5", "rational8", "thin-prism12", "tilted14", "fisheye-kb4")
SUFFIXES = (".yml", ".xml")


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("lens", LENSES)
def test_opencv_reads_a_pair_and_projects_alike(
    lens: str, suffix: str, tmp_path: Path, make_rig: MakeRig, points: np.ndarray
) -> None:
    rig = make_rig(lens)
    path = tmp_path / f"pair{suffix}"
    path.write_text(write_opencv(rig, suffix).files[0].text)
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    found = {key: storage.getNode(key).mat() for key in ("M1", "D1", "M2", "D2", "R", "T")}
    assert storage.getNode("image_width").real() == 640.0
    assert storage.getNode("camera_name2").string() == "right-2"
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
    path = tmp_path / f"mono{suffix}"
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    storage.write("image_width", 640)
    storage.write("image_height", 480)
    storage.write("camera_matrix", K)
    storage.write("distortion_coefficients", dist[:, None])
    storage.write("avg_reprojection_error", 0.1)
    storage.release()
    _, read = read_rig_files([path], None)
    (record,) = read.rig.cameras.values()
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
