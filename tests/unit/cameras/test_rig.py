"""rig.json and the records in it."""

import json
from pathlib import Path

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig, write_rig
from labcal.errors import InputError, OutputError


def a_camera(shift: float = 0.0) -> Camera:
    K = np.array([[700.1, 0.0, 322.4], [0.0, 690.2, 237.1], [0.0, 0.0, 1.0]])
    T = np.eye(4)
    T[:3, 3] = [1 / 3 + shift, 2e-17, -1e9]
    return Camera(K, "brown5", np.array([-0.3, 0.1, 1e-3, -2e-3, 1 / 7]), T, (640, 480))


RIG = Rig.of({"left": a_camera(), "right-2": a_camera(5.0)})


def test_a_rig_reads_back_exactly(tmp_path: Path) -> None:
    write_rig(tmp_path / "rig.json", RIG)
    back = read_rig(tmp_path / "rig.json")
    assert back == RIG
    assert tuple(back.cameras) == ("left", "right-2")
    for name in RIG.cameras:
        for part in ("K", "dist", "T_cam_world"):
            np.testing.assert_array_equal(getattr(back.camera(name), part), getattr(RIG.camera(name), part))
    np.testing.assert_array_equal(back.camera("right-2").T_cam_world, a_camera(5.0).T_cam_world)


def test_the_file_has_the_keys_that_others_rely_on(tmp_path: Path) -> None:
    write_rig(tmp_path / "rig.json", RIG)
    left = json.loads((tmp_path / "rig.json").read_text())["cameras"]["left"]
    assert set(left) == {"K", "lens", "dist", "T_cam_world", "size"}
    assert np.shape(left["K"]) == (3, 3)
    assert np.shape(left["T_cam_world"]) == (4, 4)
    assert len(left["dist"]) >= 5
    assert left["size"] == [640, 480]


def test_a_pinhole_is_padded_to_five_coefficients() -> None:
    camera = Camera(np.diag([700.0, 700.0, 1.0]), "pinhole", np.zeros(5), np.eye(4), (9, 9))
    assert CameraRecord.of(camera).dist == (0.0,) * 5


def test_a_rig_is_not_replaced_unasked(tmp_path: Path) -> None:
    write_rig(tmp_path / "rig.json", RIG)
    with pytest.raises(OutputError, match="`force=True`"):
        write_rig(tmp_path / "rig.json", RIG)
    write_rig(tmp_path / "rig.json", RIG, force=True)


def test_a_missing_camera_is_named() -> None:
    with pytest.raises(InputError, match=r"named 'middle'\. Known: left, right-2"):
        RIG.camera("middle")


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("format", "labcal-shoot", "format"),
        ("format_version", 2, "format_version"),
        ("cameras", {}, "cameras"),
        ("more", 1, "more: this key is not known"),
    ],
)
def test_what_is_no_rig_is_refused(tmp_path: Path, key: str, value: object, said: str) -> None:
    path = tmp_path / "rig.json"
    path.write_text(json.dumps(json.loads(RIG.model_dump_json()) | {key: value}))
    with pytest.raises(InputError, match=said):
        read_rig(path)


@pytest.mark.parametrize("content", [b"", b"{", b"\xff\xfe{", b"[1]"])
def test_a_damaged_rig_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "rig.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"rig\.json (is not a rig|is not valid JSON|cannot be read)"):
        read_rig(path)


def test_a_missing_rig_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_rig(tmp_path / "rig.json")
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        read_rig(tmp_path)


def test_an_impossible_camera_in_a_rig_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "rig.json"
    path.write_text(RIG.model_dump_json().replace("700.1", "NaN"))
    with pytest.raises(InputError, match="NaN is no number of JSON"):
        read_rig(path)


def test_a_file_of_another_program_is_to_be_converted(tmp_path: Path) -> None:
    path = tmp_path / "camchain.yaml"
    path.write_text("cam0:\n  camera_model: pinhole\n")
    with pytest.raises(InputError, match=r"convert it first: labcal convert .*camchain\.yaml rig\.json"):
        read_rig(path)
    path.write_text('{"format": "labcal-rig", "version": 1, "cameras": {')
    with pytest.raises(InputError, match=r"char \d+\)\.$"):
        read_rig(path)
