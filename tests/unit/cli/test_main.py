"""The frame: exit status, JSON, messages, and what is not imported."""

import errno
import json
import os
import subprocess
import sys
from argparse import Namespace
from dataclasses import dataclass

import pytest

from labcal.cli import VERBS, doctor, main
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import DeviceError, DiskFullError, InputError, OutputError

HEAVY = {"mitsuba", "drjit", "torch", "cv2", "scipy", "sklearn", "dask", "matplotlib", "numba"}


@dataclass(frozen=True)
class Answer:
    value: float


def run_labcal(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "labcal", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ | environment)


def heavy_modules_after(code: str) -> set[str]:
    report = f"{code}\nimport sys\nsys.stderr.write('modules ' + ' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", report], capture_output=True, text=True, check=True)
    return HEAVY & set(done.stderr.rpartition("modules ")[2].split())


def replace_doctor(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    def run(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - the form of a verb
        raise error

    monkeypatch.setattr(doctor, "run", run)


def test_importing_the_package_imports_nothing_heavy() -> None:
    assert heavy_modules_after("import labcal") == set()
    assert heavy_modules_after("import scipy") == {"scipy"}  # the test can see one


@pytest.mark.parametrize("words", [["--help"], *([verb, "--help"] for verb in VERBS)], ids=" ".join)
def test_help_imports_nothing_heavy_and_ends_with_an_example(words: list[str]) -> None:
    code = f"from labcal.cli import main\nassert main({words!r}) == 0"
    assert heavy_modules_after(code) == set()
    assert "\nexample:\n  labcal " in run_labcal(*words).stdout


def test_no_arguments_is_wrong_use_and_shows_the_help() -> None:
    done = run_labcal()
    assert done.returncode == ExitStatus.UNUSABLE
    assert done.stdout == ""
    assert "usage: labcal" in done.stderr


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (["tagret", "list"], "'target'"),
        (["target", "lst"], "'list'"),
        (["target", "list", "--jsn"], "'--json'"),
        (["target", "show", "rings-10x9"], "'rings-10x8'"),
        (["target", "export", "rings-10x8", "-o", "x.pmg"], "'png'"),
    ],
)
def test_a_misspelled_word_offers_the_nearest(
    words: list[str], hint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == ExitStatus.UNUSABLE
    told = capsys.readouterr()
    assert hint in told.err
    assert "Traceback" not in told.err
    assert told.out == ""


def test_an_option_is_not_abbreviated(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["target", "list", "--js"]) == ExitStatus.UNUSABLE
    assert "--json" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "status", "kind", "said"),
    [
        (InputError("Bad."), 2, "InputError", "Bad."),
        (OutputError("Taken."), 2, "OutputError", "Taken."),
        (
            PermissionError(errno.EACCES, "Permission denied", "/x"),
            2,
            "PermissionError",
            "/x: Permission denied",
        ),
        (DiskFullError("Full."), 3, "DiskFullError", "Full."),
        (OSError(errno.ENOSPC, "No space left", "/y"), 3, "OSError", "disk is full: /y"),
        (DeviceError("No LLVM."), 3, "DeviceError", "No LLVM."),
        (ZeroDivisionError("division by zero"), 3, "ZeroDivisionError", "LABCAL_TRACEBACK=1"),
        (MemoryError(), 3, "MemoryError", "--workers"),
        (KeyboardInterrupt(), 130, "KeyboardInterrupt", "Interrupted"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_an_error_becomes_a_message_a_status_and_a_document(
    error: BaseException,
    status: int,
    kind: str,
    said: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    replace_doctor(monkeypatch, error)
    assert main(["doctor", "--json"]) == status
    told = capsys.readouterr()
    document = json.loads(told.out)
    assert document["error"]["kind"] == kind
    assert document["error"]["status"] == status
    assert said in document["error"]["message"]
    assert document["error"]["message"] in told.err
    assert "Traceback" not in told.err


def test_the_traceback_is_shown_on_request(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    replace_doctor(monkeypatch, ZeroDivisionError())
    monkeypatch.setenv("LABCAL_TRACEBACK", "1")
    assert main(["doctor"]) == ExitStatus.FAILED
    assert "Traceback (most recent call last)" in capsys.readouterr().err


def test_wrong_arguments_are_a_document_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["target", "show", "--json"]) == ExitStatus.UNUSABLE
    document = json.loads(capsys.readouterr().out)
    assert "NAME" in document["error"]["message"]


def test_what_libraries_print_stays_off_stdout() -> None:
    # From C, from Python and from a child: all but the document goes to stderr.
    code = """
import os, subprocess, sys
from labcal.cli import doctor, main
def run(arguments, session):
    os.write(1, b"from C ")
    print("from Python")
    subprocess.run([sys.executable, "-c", "print('from a child')"], check=True)
    session.emit(doctor.Diagnosis(True, "x", []), "text")
    return 0
doctor.run = run
sys.exit(main(["doctor", "--json"]))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == {"ok": True, "labcal": "x", "checks": []}
    for said in ("from C", "from Python", "from a child"):
        assert said in done.stderr


def test_a_result_is_given_once_and_an_error_after_it_leaves_one_document(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def run(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - the form of a verb
        session.emit(Answer(float("nan")), "text")
        session.emit(Answer(1.0), "text")
        return ExitStatus.DONE

    monkeypatch.setattr(doctor, "run", run)
    assert main(["doctor", "--json"]) == ExitStatus.FAILED
    assert json.loads(capsys.readouterr().out) == {"value": None}


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no device that is always full")  # noqa: PTH110 - a device
@pytest.mark.parametrize("option", [[], ["--json"]])
def test_a_full_disk_behind_stdout(option: list[str]) -> None:
    command = [sys.executable, "-m", "labcal", "target", "list", *option]
    with open("/dev/full", "w") as full:  # noqa: PTH123 - a device
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == ExitStatus.FAILED
    assert "disk is full" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="pipes end otherwise there")
def test_a_reader_that_goes_away_ends_it_quietly() -> None:
    read_end, write_end = os.pipe()
    os.close(read_end)
    command = [sys.executable, "-m", "labcal", "target", "list"]
    done = subprocess.run(command, stdout=write_end, stderr=subprocess.PIPE, text=True, check=False)
    os.close(write_end)
    assert done.returncode == ExitStatus.NOBODY_READS
    assert done.stderr == ""
