"""The frame: exit status, JSON, messages, and what is not imported."""

import errno
import json
import os
import subprocess
import sys
from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path

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


def test_check_names_the_tables_that_it_takes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--help"]) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert "RIG SHOOT-or-IMAGES-or-TABLE" in words
    assert "detections.csv of dots" in words


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


NINES = "9" * 5000


@pytest.mark.parametrize(
    "words",
    [
        ["scene", "show", "webcam-plane", "--set", f"cameras.left.focal_px={NINES}"],
        ["scene", "show", "webcam-plane", "--set", "cameras.left.focal_px=2001-99-99"],
        ["scene", "show", "webcam-plane", "--set", "cameras.left.focal_px=2147483648"],
        ["scene", "show", "webcam-plane", "--set", f"cameras.left.dist={'[' * 1000}{']' * 1000}"],
        ["scene", "show", "webcam-plane", "--set", f"placement.views.{NINES}.name=a"],
        ["scene", "show", "webcam-plane", "--set", "cameras.left.dist=[1e30]"],
        ["scene", "show", "webcam-plane", "--set", "cameras.left.size=[2147483648, 480]"],
        ["convert", "corners.vnl", "d.csv", "--target", "rings-10x8", "--size", "99999999999999999999x480"],
        ["target", "show", "deep.yaml"],
        ["target", "show", "laughs.yaml"],
        ["target", "show", "date.yaml"],
        ["convert", "letter.yaml", "rig.json", "--from", "kalibr"],
        ["convert", "bang.yml", "rig.json", "--from", "opencv"],
        ["reconstruct", "pipe", "d.csv", "-o", "p.csv"],
        ["reconstruct", "/dev/zero", "d.csv", "-o", "p.csv"],
        ["evaluate", "pipe", "--target", "rings-10x8"],
        ["evaluate", "/dev/zero", "--target", "rings-10x8"],
        ["report", "loop"],
        ["render", "webcam-plane", "-o", "s", "--workers", NINES],
    ],
)
def test_bad_input_is_no_failure_of_the_program(
    words: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, text in {
        "deep.yaml": "name: " + "[" * 1000 + "]" * 1000,
        "laughs.yaml": "a0: &a0 [x, x]\n"
        + "".join(f"a{i}: &a{i} [*a{i - 1}, *a{i - 1}]\n" for i in range(1, 30)),
        "date.yaml": "name: 2001-99-99",
        "letter.yaml": "%",
        "bang.yml": "!",
        "corners.vnl": "# filename x y weight\na.png - - -\n",
    }.items():
        (tmp_path / name).write_text(text)
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    assert main(words) == ExitStatus.UNUSABLE
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert len(said) < 3000
