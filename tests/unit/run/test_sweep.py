import json
import os
from dataclasses import dataclass
from pathlib import Path

import pytest
from pydantic import BaseModel, ConfigDict

from labcal.errors import DeviceError, InputError, LabcalError, OutputError
from labcal.run.case import CaseOutcome, Fault
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress
from labcal.run.sweep import sweep


@dataclass(frozen=True)
class Root:
    number: float
    name: str

    @property
    def key(self) -> str:
        return self.name


class Result(BaseModel):
    model_config = ConfigDict(frozen=True)
    value: float


CASES = [Root(4.0, "four"), Root(-1.0, "negative"), Root(0.0, "device"), Root(9.0, "nine"), Root(5.0, "bug")]
calls: list[str] = []


@pytest.fixture(autouse=True)
def no_calls() -> None:
    calls.clear()


def root(case: Root) -> Result:
    calls.append(case.name)
    match case.name:
        case "negative":
            raise InputError(f"{case.number:g} has no root.")
        case "device":
            raise DeviceError("The abacus is broken.")
        case "bug":
            return Result(value=1 / int(case.number - 5))
        case "killer":
            os._exit(9)
        case "untyped":
            return Result.model_construct(value="many")
    return Result(value=case.number**0.5)


def swept(cases: list[Root], folder: Path, workers: int = 1) -> list[CaseOutcome[Result]]:
    with open_executor(workers) as executor:
        return sweep(cases, root, Result, folder, executor, NoProgress())


def values(outcomes: list[CaseOutcome[Result]]) -> dict[str, float | Fault | None]:
    return {one.key: one.fault if one.result is None else one.result.value for one in outcomes}


EXPECTED = {"four": 2.0, "negative": Fault.CASE, "device": Fault.MACHINE, "nine": 3.0, "bug": Fault.PROGRAM}


def test_cases_that_fail_have_reasons_and_the_others_results(tmp_path: Path) -> None:
    outcomes = swept(CASES, tmp_path)
    assert list(values(outcomes).items()) == list(EXPECTED.items())  # in the order of the cases
    reasons = [one.reason for one in outcomes]
    assert reasons[:4] == [None, "-1 has no root.", "The abacus is broken.", None]
    assert reasons[4] is not None
    assert "test_sweep.py" in reasons[4]
    assert reasons[4].endswith("ZeroDivisionError: division by zero")
    assert all(0.0 < one.seconds < 1.0 for one in outcomes)


def test_a_second_run_tries_again_only_where_the_machine_was_at_fault(tmp_path: Path) -> None:
    first = swept(CASES, tmp_path)
    calls.clear()
    again = swept(CASES, tmp_path)
    assert calls == ["device"]
    assert [one for one in again if one.key != "device"] == [one for one in first if one.key != "device"]


def test_a_file_says_what_its_result_depends_on(tmp_path: Path) -> None:
    swept(CASES[:2], tmp_path)
    four, negative = (json.loads((tmp_path / f"{name}.json").read_text()) for name in ("four", "negative"))
    assert four["result"] == {"value": 2.0}
    assert four["reason"] is None
    assert negative["result"] is None
    assert negative["reason"] == "-1 has no root."
    assert four["case_sha256"] != negative["case_sha256"]
    assert four["code_sha256"] == negative["code_sha256"]


@pytest.mark.parametrize("key", ["case_sha256", "code_sha256"])
def test_a_file_of_another_case_or_of_other_code_is_made_anew(tmp_path: Path, key: str) -> None:
    swept(CASES[:2], tmp_path)
    content = json.loads((tmp_path / "four.json").read_text())
    (tmp_path / "four.json").write_text(json.dumps({**content, "result": {"value": 7.0}}))
    assert values(swept(CASES[:2], tmp_path))["four"] == 7.0  # it is the hashes that count
    (tmp_path / "four.json").write_text(json.dumps({**content, "result": {"value": 7.0}, key: "0" * 64}))
    calls.clear()
    assert values(swept(CASES[:2], tmp_path))["four"] == 2.0
    assert calls == ["four"]


def test_a_case_that_has_changed_is_done_again_under_its_old_name(tmp_path: Path) -> None:
    swept(CASES[:1], tmp_path)
    assert values(swept([Root(16.0, "four")], tmp_path)) == {"four": 4.0}


def test_a_case_that_ends_its_processes_has_a_reason(tmp_path: Path) -> None:
    outcomes = swept([Root(1.0, "killer"), *CASES], tmp_path, workers=2)
    assert values(outcomes) == {"killer": Fault.MACHINE, **EXPECTED}
    assert outcomes[0].reason is not None
    assert "with exit status 9" in outcomes[0].reason


def test_a_result_that_is_none_of_its_type_is_a_mistake_of_the_program(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="serializ"):
        outcomes = swept([Root(1.0, "untyped"), CASES[0]], tmp_path)
    assert values(outcomes) == {"untyped": Fault.PROGRAM, "four": 2.0}


def test_a_disk_that_refuses_ends_the_sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refusing(path: Path, content: str, *, force: bool) -> None:
        raise OutputError(f"{path} cannot be written: {len(content)} {force}.")

    monkeypatch.setattr("labcal.run.case_files.write_file", refusing)
    with pytest.raises(OutputError, match="cannot be written"):
        swept(CASES, tmp_path)


def test_an_executor_that_fails_ends_the_sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("labcal.run.pool.MOST_FAILED", 1)
    with pytest.raises(LabcalError, match="All worker processes end"), open_executor(2) as executor:
        sweep([Killer(n) for n in range(4)], end, Result, tmp_path, executor, NoProgress())


@dataclass(frozen=True)
class Killer:
    number: int

    @property
    def key(self) -> str:
        return f"killer-{self.number}"


def end(_case: Killer) -> Result:
    os._exit(7)
