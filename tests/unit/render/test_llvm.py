import os
import platform
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import NoReturn

import pytest

from labcal.errors import DeviceError
from labcal.render import llvm

packaged = pytest.mark.skipif(
    (platform.system(), platform.machine()) != ("Linux", "x86_64"),
    reason="the package is for Linux on x86-64",
)


@pytest.fixture(autouse=True)
def unset(monkeypatch: pytest.MonkeyPatch) -> None:
    # Set first, so that monkeypatch restores what the code under test sets.
    monkeypatch.setenv(llvm.VARIABLE, "")
    monkeypatch.delenv(llvm.VARIABLE)


@pytest.fixture
def no_package(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> NoReturn:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(llvm, "files", missing)


@packaged
def test_the_packaged_library_is_chosen_and_told_to_drjit() -> None:
    library = llvm.ensure_llvm()
    assert library.name.startswith("libLLVM.so.")
    assert library.read_bytes()[:4] == b"\x7fELF"
    assert os.environ[llvm.VARIABLE] == str(library)
    assert llvm.ensure_llvm() == library


def test_the_users_choice_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mine = tmp_path / "libLLVM.so"
    mine.touch()
    monkeypatch.setenv(llvm.VARIABLE, str(mine))
    assert llvm.ensure_llvm() == mine
    assert os.environ[llvm.VARIABLE] == str(mine)


def test_a_users_choice_that_is_no_file_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(llvm.VARIABLE, str(tmp_path / "gone.so"))
    with pytest.raises(DeviceError, match=r"gone\.so, which is not a file"):
        llvm.ensure_llvm()


@pytest.mark.usefixtures("no_package")
@pytest.mark.parametrize(
    ("system", "machine", "said"),
    [
        ("Linux", "x86_64", llvm.PACKAGE),
        ("Linux", "aarch64", "distribution"),
        ("Darwin", "arm64", "brew install llvm"),
        ("Windows", "AMD64", "win64"),
        ("FreeBSD", "amd64", "Install LLVM"),
    ],
)
def test_without_a_library_every_system_gets_its_advice(
    system: str, machine: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(platform, "system", lambda: system)
    monkeypatch.setattr(platform, "machine", lambda: machine)
    monkeypatch.setattr(llvm, "_USUAL_PLACES", {})
    with pytest.raises(DeviceError, match=said):
        llvm.ensure_llvm()
    assert llvm.VARIABLE not in os.environ


@pytest.mark.usefixtures("no_package")
def test_an_installed_library_is_found_where_it_usually_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    library = tmp_path / "libLLVM.dylib"
    library.touch()
    monkeypatch.setattr(platform, "system", lambda: "Darwin")
    monkeypatch.setattr(llvm, "_USUAL_PLACES", {"Darwin": (str(tmp_path / "absent"), str(library))})
    assert llvm.ensure_llvm() == library
