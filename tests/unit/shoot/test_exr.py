import contextlib
import os
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest

from labcal.errors import DiskFullError, InputError, OutputError
from labcal.shoot.exr import read_exr, read_exr_texts, write_exr

LIGHT = np.random.default_rng(1).random((40, 60, 3), dtype=np.float32)


@pytest.mark.parametrize("light", [LIGHT, LIGHT[..., 0]], ids=["colour", "grey"])
def test_light_and_texts_read_back_exactly(tmp_path: Path, light: np.ndarray) -> None:
    write_exr(tmp_path / "a.exr", light, {"labcal:camera": '{"lens": "brown5"}'})
    np.testing.assert_array_equal(read_exr(tmp_path / "a.exr"), light)
    assert read_exr_texts(tmp_path / "a.exr") == {"labcal:camera": '{"lens": "brown5"}'}
    with OpenEXR.File(str(tmp_path / "a.exr")) as exr:  # as other programs see it
        assert set(exr.channels()) == ({"RGB"} if light.ndim == 3 else {"Y"})


def test_an_alpha_channel_is_dropped_and_other_channels_are_passed_over(tmp_path: Path) -> None:
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    whole = np.concatenate([LIGHT, LIGHT[..., :1]], axis=-1)
    OpenEXR.File(header, {"RGBA": whole, "D": LIGHT[..., 2].copy()}).write(str(tmp_path / "a.exr"))
    np.testing.assert_array_equal(read_exr(tmp_path / "a.exr"), LIGHT)


def test_what_is_no_exr_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_text("text")
    with pytest.raises(InputError, match=r"a\.exr is not an OpenEXR file"):
        read_exr(tmp_path / "a.exr")
    with pytest.raises(InputError, match=r"a\.exr is not an OpenEXR file"):
        read_exr_texts(tmp_path / "a.exr")


def test_an_existing_file_is_kept(tmp_path: Path) -> None:
    write_exr(tmp_path / "a.exr", LIGHT, {})
    with pytest.raises(OutputError, match="`force=True`"):
        write_exr(tmp_path / "a.exr", LIGHT[..., 0], {})
    write_exr(tmp_path / "a.exr", LIGHT[..., 0], {}, force=True)
    assert read_exr(tmp_path / "a.exr").ndim == 2
    with pytest.raises(OutputError, match="nowhere"):
        write_exr(tmp_path / "nowhere" / "a.exr", LIGHT, {})


@pytest.mark.parametrize(("code", "kind"), [(28, DiskFullError), (5, OutputError)])
def test_what_the_disk_refuses_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: int, kind: type[OutputError]
) -> None:
    class Refused:
        def __init__(self, *_: Any) -> None:  # noqa: ANN401 -- stands in for OpenEXR's own
            pass

        def write(self, name: str) -> None:
            Path(name).write_bytes(b"half")
            raise RuntimeError(f'Failed to write pixel data to image file "{name}". {os.strerror(code)}.')

    monkeypatch.setattr(OpenEXR, "File", Refused)
    with pytest.raises(OutputError) as caught:
        write_exr(tmp_path / "a.exr", LIGHT, {})
    assert type(caught.value) is kind
    assert list(tmp_path.iterdir()) == []


def test_what_the_library_prints_of_damaged_files_stays_off_the_terminal(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    write_exr(tmp_path / "a.exr", np.ones((64, 64), np.float32), {"labcal:note": "x" * 99})
    content = (tmp_path / "a.exr").read_bytes()
    for at in range(8, 400, 9):
        path = tmp_path / f"{at}.exr"
        path.write_bytes(content[:at] + bytes(24) + content[at + 24 :])
        with contextlib.suppress(InputError):
            read_exr(path)
        with contextlib.suppress(InputError):
            read_exr_texts(path)
    assert capfd.readouterr() == ("", "")
