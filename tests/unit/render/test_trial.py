import sys
from pathlib import Path

import pytest

from labcal.errors import DeviceError
from labcal.render import trial
from labcal.render.llvm import VARIABLE


def test_a_picture_is_rendered_here() -> None:
    assert trial.try_render().startswith("Mitsuba 3.")


def test_a_library_that_is_none_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake = tmp_path / "libLLVM.so"
    fake.write_bytes(b"not a library")
    monkeypatch.setenv(VARIABLE, str(fake))
    with pytest.raises(DeviceError, match="trial picture failed"):
        trial.try_render()


@pytest.mark.skipif(sys.platform == "win32", reason="no signals there")
def test_a_process_that_aborts_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake = tmp_path / "python"
    fake.write_text("#!/bin/sh\necho 'LLVM ERROR: Cannot select' >&2\necho more >&2\nkill -ABRT $$\n")
    fake.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(fake))
    with pytest.raises(DeviceError, match=r"exit status -6: LLVM ERROR: Cannot select\)"):
        trial.try_render()


def test_the_advice_fits_the_reason() -> None:
    assert "libatomic1" in trial._advice("ImportError: libatomic.so.1: cannot open shared object file")
    assert "mitsuba" in trial._advice("ModuleNotFoundError: No module named 'mitsuba'")
    assert "LLVM" in trial._advice("LLVM ERROR: Cannot select")
