import json
import re
import tomllib
from pathlib import Path

import pytest

from labcal.cli import health, main
from labcal.cli.health import Check
from labcal.errors import DeviceError


def choose_checks(monkeypatch: pytest.MonkeyPatch, *checks: Check) -> None:
    monkeypatch.setattr(health, "all_checks", lambda: [lambda check=check: check for check in checks])


def test_all_well_is_status_0(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    choose_checks(monkeypatch, Check("a", True, "1.0", None))
    assert main(["doctor", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["ok"] is True
    assert told["checks"] == [{"name": "a", "ok": True, "found": "1.0", "advice": None}]


def test_something_missing_is_status_1_with_advice(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    choose_checks(monkeypatch, Check("a", True, "1.0", None), Check("b", False, None, "pip install b"))
    assert main(["doctor"]) == 1
    table = capsys.readouterr().out
    assert "pip install b" in table
    assert main(["doctor", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["ok"] is False


def test_a_missing_package_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(health, "_PACKAGES", {"no-such-distribution": "nothing"})
    found = {check.name: check for check in (make() for make in health.all_checks()[:6])}
    assert not found["no-such-distribution"].ok
    assert "pip install no-such-distribution" in str(found["no-such-distribution"].advice)
    assert found["python"].ok


@pytest.mark.parametrize(
    ("code", "said"),
    [("import no_such_module", "no_such_module"), ("import os; os.abort()", "exit status -6")],
)
def test_a_library_that_fails_when_used_is_told(code: str, said: str) -> None:
    check = health._check_trial("Thing works", code)
    assert not check.ok
    assert "Reinstall Thing" in str(check.advice)
    assert said in str(check.advice)


def test_rendering_that_fails_is_a_line_and_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> str:
        raise DeviceError("Install LLVM.")

    monkeypatch.setattr("labcal.render.trial.try_render", fail)
    assert health._check_rendering() == Check("rendering works", False, None, "Install LLVM.")


def test_every_library_that_labcal_needs_is_looked_for() -> None:
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text("utf-8"))["project"]
    needed = {re.split(r"[<>=; ]", one)[0].lower() for one in project["dependencies"]}
    # The check of rendering loads this library.
    assert needed - {name.lower() for name in health._PACKAGES} == {"karellen-llvm-core"}


def test_this_machine_runs_what_the_other_tests_need() -> None:
    # The test environment has all packages; a check that says otherwise is wrong.
    assert [check for check in (make() for make in health.all_checks()) if not check.ok] == []
