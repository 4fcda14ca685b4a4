"""What files of other systems do not say is asked for or told; it is never settled in silence."""

import json
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.cameras.interop.exchange import NOTHING_GIVEN, Home, ReadOptions, ReadRig, Unit
from labcal.cameras.interop.labcal_rig import LABCAL
from labcal.cameras.interop.registry import FORMATS, format_to_write
from labcal.cameras.interop.rig_files import baseline_mm, read_rig_files, write_rig_files
from labcal.cameras.rig import Rig
from labcal.cli import main
from labcal.errors import InputError

MakeRig = Callable[..., Rig]
K1 = np.array([[1210.0, 0.0, 655.5], [0.0, 1208.0, 470.25], [0.0, 0.0, 1.0]])
K2 = np.array([[1195.0, 0.0, 622.0], [0.0, 1194.0, 488.5], [0.0, 0.0, 1.0]])
D1, D2 = np.array([[-0.21, 0.08, 6e-4, -4e-4, 0.0]]), np.array([[-0.19, 0.06, -3e-4, 8e-4, 0.0]])
R = cv2.Rodrigues(np.array([0.01, 0.16, -0.004]))[0]
T = np.array([[-118.0], [1.5], [9.0]])
SIZE = (1280, 960)
APART_MM = float(np.linalg.norm(T))


def storage(path: Path, **values: object) -> Path:
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for key, value in values.items():
        file.write(key, value)
    file.release()
    return path


def read(*paths: Path, **given: object) -> Rig:
    return read_rig_files(list(paths), None, ReadOptions(**given))[1].rig


@pytest.fixture
def four(tmp_path: Path) -> Path:
    """A camera with four coefficients that does not say whose they are."""
    return storage(
        tmp_path / "four.yml",
        image_width=SIZE[0],
        image_height=SIZE[1],
        camera_matrix=K1,
        distortion_coefficients=np.array([[0.031, -0.012, 0.004, -0.001]]),
    )


def test_four_coefficients_are_asked_about(four: Path) -> None:
    with pytest.raises(InputError, match="`lens='brown5'` or `lens='fisheye-kb4'`"):
        read(four)
    (fisheye,), (brown,) = (read(four, lens=lens).cameras.values() for lens in ("fisheye-kb4", "brown5"))
    assert (fisheye.lens, fisheye.dist) == ("fisheye-kb4", (0.031, -0.012, 0.004, -0.001, 0.0))
    assert (brown.lens, brown.dist) == ("brown5", (0.031, -0.012, 0.004, -0.001, 0.0))
    v = np.array([[0.0, np.sin(np.pi / 4), np.cos(np.pi / 4)]])
    expected, _ = cv2.fisheye.projectPoints(
        v[:, None], np.zeros(3), np.zeros(3), K1, np.array(fisheye.dist[:4])
    )
    np.testing.assert_allclose(fisheye.camera().project(v).q, expected[:, 0], atol=1e-9)
    assert np.abs(brown.camera().project(v).q - expected[:, 0]).max() > 20.0
    for name in ("prescription", "rational8", "browny"):
        with pytest.raises(InputError, match="does not determine whose coefficients these are"):
            read(four, lens=name)


@pytest.mark.parametrize(
    ("key", "value", "lens"),
    [
        ("fisheye_model", 1, "fisheye-kb4"),
        ("fisheye_model", 0, "brown5"),
        ("distortion_model", "equidistant", "fisheye-kb4"),
        ("camera_model", "KANNALA_BRANDT", "fisheye-kb4"),
        ("distortion_model", "plumb_bob", "brown5"),
    ],
)
def test_a_file_may_say_itself_whose_they_are(four: Path, key: str, value: object, lens: str) -> None:
    text = four.read_text()
    four.write_text(text + f"{key}: {value}\n")
    assert next(iter(read(four).cameras.values())).lens == lens
    other = "brown5" if lens == "fisheye-kb4" else "fisheye-kb4"
    with pytest.raises(InputError, match=r"states otherwise\. Leave that out"):
        read(four, lens=other)


def test_metres_are_not_taken_for_millimetres(tmp_path: Path) -> None:
    path = storage(tmp_path / "metres.yml", M1=K1, D1=D1, M2=K2, D2=D2, R=R, T=T / 1000.0)
    with pytest.raises(InputError, match=r"would be 0\.1184 mm apart.*`unit='mm'` or `unit='m'`"):
        read(path, size=SIZE)
    assert baseline_mm(read(path, size=SIZE, unit=Unit.METRES)) == pytest.approx(APART_MM, rel=1e-12)
    assert baseline_mm(read(path, size=SIZE, unit=Unit.MILLIMETRES)) == pytest.approx(APART_MM / 1000.0)


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "labcal"])
def test_the_unit_of_every_format_can_be_named(name: str, tmp_path: Path, make_rig: MakeRig) -> None:
    chosen, rig = FORMATS[name], make_rig("pinhole")
    path = tmp_path / ("model" if chosen.home is Home.FOLDER else f"rig{chosen.suffixes[0]}")
    files = write_rig_files(path, chosen, chosen.write(rig, chosen.suffixes[0]), force=False)
    paths = [path] if chosen.home is Home.FOLDER else files
    meant = baseline_mm(rig)
    assert meant is not None
    for unit in (None, *Unit):
        given = ReadOptions(unit=unit, size=(640, 480) if name == "matchid" else None)
        if name == "anipose" and unit is Unit.METRES:
            with pytest.raises(InputError, match="state themselves that lengths are in mm"):
                read_rig_files(paths, name, given)
            continue
        read_back = read_rig_files(paths, name, given)[1]
        found = read_back.rig
        scale = 1.0 if unit is None else unit.mm / chosen.unit.mm
        assert read_back.unit is (unit or chosen.unit)
        assert baseline_mm(found) == pytest.approx(meant * scale, rel=1e-12)
        centre = found.camera(next(iter(found.cameras))).centre
        np.testing.assert_allclose(
            found.camera(list(found.cameras)[1]).K, rig.camera("right-2").K, rtol=1e-14
        )
        np.testing.assert_allclose(centre, 0.0, atol=1e-9)


def test_the_picture_size_is_honoured(tmp_path: Path, four: Path) -> None:
    path = storage(tmp_path / "pair.yml", M1=K1, D1=D1, M2=K2, D2=D2, R=R, T=T)
    with pytest.raises(InputError, match="`size='1280x960'`"):
        read(path)
    assert {record.size for record in read(path, size=SIZE).cameras.values()} == {SIZE}
    assert next(iter(read(four, lens="brown5", size=SIZE).cameras.values())).size == SIZE
    with pytest.raises(InputError, match="is no size of a picture"):
        read(path, size=(10**9, 10**9))
    with pytest.raises(InputError, match="states a picture size of 1280x960, which `size` contradicts"):
        read(four, lens="brown5", size=(640, 480))


@pytest.mark.parametrize("name", ["labcal", "mrcal", "kalibr", "ros", "colmap"])
def test_what_does_not_apply_to_a_format_is_refused(name: str, tmp_path: Path, make_rig: MakeRig) -> None:
    chosen = FORMATS[name]
    path = tmp_path / ("model" if chosen.home is Home.FOLDER else f"rig{chosen.suffixes[0]}")
    rig = make_rig("pinhole", count=1)
    files = write_rig_files(path, chosen, chosen.write(rig, chosen.suffixes[0]), force=False)
    paths = [path] if chosen.home is Home.FOLDER else files
    for option, value in (
        ("size", SIZE),
        ("lens", "brown5"),
        *((("unit", Unit.METRES),) * (name == "labcal")),
    ):
        with pytest.raises(InputError, match=f"`{option}` does not apply to files of the format '{name}'"):
            read_rig_files(paths, name, ReadOptions(**{option: value}))


def test_files_of_intrinsics_and_extrinsics_are_one_pair(tmp_path: Path) -> None:
    intrinsics = storage(tmp_path / "intrinsics.yml", M1=K1, D1=D1, M2=K2, D2=D2)
    extrinsics = storage(tmp_path / "extrinsics.yml", R=R, T=T, Q=np.eye(4))
    for paths in ((intrinsics, extrinsics), (extrinsics, intrinsics), (intrinsics,), (extrinsics,)):
        rig = read(*paths, size=SIZE)
        assert [record.K[0][0] for record in rig.cameras.values()] == [1210.0, 1195.0]
        assert baseline_mm(rig) == pytest.approx(APART_MM, rel=1e-12)
    _, found = read_rig_files([intrinsics], None, ReadOptions(size=SIZE))
    assert f"R and T are read from {extrinsics}" in found.notes[0]
    storage(tmp_path / "other.yml", R=R, T=2.0 * T)
    with pytest.raises(InputError, match=r"could be extrinsics\.yml or other\.yml"):
        read(intrinsics, size=SIZE)
    (alone := tmp_path / "alone").mkdir()
    with pytest.raises(InputError, match=r"labcal convert intrinsics\.yml extrinsics\.yml"):
        read(storage(alone / "intrinsics.yml", M1=K1, D1=D1, M2=K2, D2=D2), size=SIZE)


def test_usual_keys_of_other_programs_are_read(tmp_path: Path) -> None:
    old = storage(
        tmp_path / "old.xml",
        image_Width=1280, image_Height=960, Camera_Matrix=K1, Distortion_Coefficients=D1.T,
    )  # fmt: skip
    one = storage(
        tmp_path / "one.yml",
        image_width=1280, image_height=960, camera_matrix=K1, distortion_coefficients=D1[0],
    )  # fmt: skip
    for path in (old, one):
        (record,) = read(path).cameras.values()
        assert (record.K[0][0], record.dist, record.size) == (1210.0, tuple(D1[0]), SIZE)
    sides = storage(
        tmp_path / "sides.yml",
        cameraMatrixL=K1, distCoeffsL=D1, cameraMatrixR=K2, distCoeffsR=D2, R=R, T=T,
    )  # fmt: skip
    assert [record.K[0][0] for record in read(sides, size=SIZE).cameras.values()] == [1210.0, 1195.0]
    strange = storage(tmp_path / "strange.yml", camera_matrix=K1, bending=D1)
    with pytest.raises(InputError, match=r"Its keys are camera_matrix, bending; name those of a pair"):
        read(strange, size=SIZE)


def test_cameras_on_an_imu_are_placed_to_each_other(tmp_path: Path) -> None:
    T0, T1 = np.eye(4), np.eye(4)
    T0[:3, :3], T0[:3, 3] = cv2.Rodrigues(np.array([0.0, 0.0, 1.5708]))[0], [0.02, -0.01, 0.005]
    T1[:3, :3], T1[:3, 3] = R, T[:, 0] / 1000.0
    blocks = ["%YAML:1.0\n"]
    for number, (K, pose) in enumerate(((K1, T0), (K2, T1 @ T0))):
        rows = "".join(f"    - {row}\n" for row in pose.tolist())
        blocks.append(
            f"cam{number}:\n  T_cam_imu:\n{rows}  camera_model: pinhole\n  distortion_model: radtan\n"
            f"  distortion_coeffs: {D1[0, :4].tolist()}\n"
            f"  intrinsics: {K[[0, 1, 0, 1], [0, 1, 2, 2]].tolist()}\n  resolution: [1280, 960]\n"
        )
    (tmp_path / "imu.yaml").write_text("\n".join(blocks))
    rig = read(tmp_path / "imu.yaml")
    assert baseline_mm(rig) == pytest.approx(APART_MM, rel=1e-9)
    np.testing.assert_allclose(rig.camera("cam1").T_cam_world[:3, :3], R, atol=1e-9)


def test_counts_that_ros_takes_and_what_it_prints(tmp_path: Path) -> None:
    K, five, none = K1.ravel().tolist(), D1[0].tolist(), np.eye(3).ravel().tolist()
    matrix = "  rows: 3\n  cols: 3\n  data: {}\n"
    P = [1210.0, 0.0, 655.5, 0.0, 0.0, 1208.0, 470.25, 0.0, 0.0, 0.0, 1.0, 0.0]
    for model, numbers, lens in (
        ("plumb_bob", [*five, 0.0, 0.0, 0.0], "brown5"),
        ("plumb_bob", five[:4], "brown5"),
        ("rational_polynomial", five, "brown5"),
        ("''", [0.0, 0.0], None),
        ("''", [], "pinhole"),
        ("none", [0.0] * 5, "pinhole"),
        ("none", five, None),
        ("rational_polynomial", [*five, 0.01, 0.02, 0.003, *[0.0] * 6], "rational8"),
    ):
        (tmp_path / "info.yaml").write_text(
            f"image_width: 1280\nimage_height: 960\ncamera_name: front\ncamera_matrix:\n{matrix.format(K)}"
            f"distortion_model: {model}\ndistortion_coefficients:\n  data: {numbers}\n"
            f"rectification_matrix:\n{matrix.format(none)}projection_matrix:\n  data: {P}\n"
        )
        if lens is None:
            with pytest.raises(InputError, match=r"distortion"):
                read(tmp_path / "info.yaml")
            continue
        (record,) = read(tmp_path / "info.yaml").cameras.values()
        assert (record.lens, record.dist[:2]) == (lens, (0.0, 0.0) if lens == "pinhole" else (-0.21, 0.08))
    (tmp_path / "echo.yaml").write_text(
        "header:\n  frame_id: front_optical\nheight: 960\nwidth: 1280\ndistortion_model: plumb_bob\n"
        f"d: {five}\nk: {K}\nr: {none}\np: {P}\nbinning_x: 0\n---\nheader:\n  frame_id: x\n"
    )
    rig = read(tmp_path / "echo.yaml")
    assert (list(rig.cameras), rig.camera("front-optical").K[0, 0]) == (["front-optical"], 1210.0)


def test_the_lens_of_a_colmap_camera_with_many_images(tmp_path: Path) -> None:
    (tmp_path / "cameras.txt").write_text("1 OPENCV 1280 960 1210 1208 656.0 470.75 -0.21 0.08 6e-4 -4e-4\n")
    lines = "".join(f"{n} 1 0 0 0 0.1 {0.1 * n} 1 1 img{n}.png\n\n" for n in (1, 2, 3))
    (tmp_path / "images.txt").write_text(lines)
    _, found = read_rig_files([tmp_path], None)
    assert "took 3 images: its lens is read" in found.notes[0]
    (record,) = found.rig.cameras.values()
    assert record.K[0][2] == 655.5
    binary = tmp_path / "binary"
    binary.mkdir()
    entry = struct.pack("<QIiQQ8d", 1, 1, 4, *SIZE, 1210.0, 1208.0, 656.0, 470.75, -0.21, 0.08, 6e-4, -4e-4)
    (binary / "cameras.bin").write_bytes(entry)
    for path in (binary, binary / "cameras.bin", tmp_path / "cameras.txt"):
        (same,) = read_rig_files([path], None)[1].rig.cameras.values()
        assert same == record
    (binary / "cameras.bin").write_bytes(entry[:-1])
    with pytest.raises(InputError, match="ends too early"):
        read_rig_files([binary], "colmap-binary")


def test_a_second_format_whose_files_end_in_json(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, make_rig: MakeRig
) -> None:
    """Formats are told by what a file holds; where that fits several, they are named."""
    rig = make_rig("pinhole", count=1)

    def made_up(_sources: object, _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
        return ReadRig(rig)

    other = replace(LABCAL, name="made-up", recognises=lambda text: '"intrinsics"' in text, read=made_up)
    monkeypatch.setitem(FORMATS, "made-up", other)
    ours, theirs, both = (tmp_path / f"{name}.json" for name in ("ours", "theirs", "both"))
    ours.write_text(LABCAL.write(rig, ".json").files[0].text)
    theirs.write_text(json.dumps({"intrinsics": [1, 2, 3]}))
    both.write_text(ours.read_text().replace('"cameras"', '"intrinsics": 1, "cameras"'))
    assert read_rig_files([ours], None)[0].name == "labcal"
    assert read_rig_files([theirs], None)[0].name == "made-up"
    with pytest.raises(InputError, match=r"of several formats: labcal, made-up\. Say which: `from_format="):
        read_rig_files([both], None)
    assert read_rig_files([both], "made-up")[0].name == "made-up"
    assert format_to_write(tmp_path / "new.json").name == "labcal"


def test_convert_tells_unit_baseline_and_folds(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folded = np.array([[-0.6, 0.0, 0.0, 0.0, 0.0]])
    storage(Path("pair.yml"), M1=K1, D1=D1, M2=K2, D2=folded, R=R, T=T / 1000.0)
    words = ("convert", "pair.yml", "rig.json", "--size", "1280x960", "--json")
    assert main(words) == 2
    assert "--unit mm or --unit m" in capsys.readouterr().err
    assert main([*words, "--unit", "m"]) == 0
    told = capsys.readouterr()
    document = json.loads(told.out)
    assert (document["unit"], document["baseline_mm"]) == ("m", pytest.approx(APART_MM))
    assert "taken for m: the first two cameras are 118.352 mm apart" in told.err
    (note,) = document["notes"]
    assert "of the picture of right sees no direction" in note
