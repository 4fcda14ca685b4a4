import json
import os
from dataclasses import dataclass
from pathlib import Path

import pytest
from pydantic import BaseModel

from labcal.errors import DeviceError, InputError
from labcal.run.cases import run_cases
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress


@dataclass(frozen=True)
class Square:
    number: int

    @property
    def key(self) -> str:
        return f"square-{self.number}"


class Result(BaseModel):
    value: int


def square(case: Square) -> Result:
    return Result(value=case.number**2)


def square_below_three(case: Square) -> Result:
    if case.number >= 3:
        raise ValueError(f"{case} is too large")
    return square(case)


def square_or_crash(case: Square) -> Result:
    if case.number == 1:
        os._exit(9)
    return square(case)


def square_and_note(case: Square) -> Result:
    calls.append(case.number)
    return square(case)


calls: list[int] = []


@pytest.fixture(autouse=True)
def no_calls() -> None:
    calls.clear()


def test_results_keep_the_order_and_a_second_run_computes_nothing(tmp_path: Path) -> None:
    cases = [Square(n) for n in (3, 1, 2)]
    with open_executor(1) as executor:
        first = run_cases(cases, square_and_note, Result, tmp_path / "cases", executor, NoProgress())
        assert calls == [3, 1, 2]
        again = run_cases(cases, square_and_note, Result, tmp_path / "cases", executor, NoProgress())
    assert calls == [3, 1, 2]
    assert [result.value for result in first] == [9, 1, 4]
    assert again == first
    assert sorted(path.name for path in (tmp_path / "cases").iterdir()) == [
        f"square-{n}.json" for n in (1, 2, 3)
    ]


def test_what_is_done_is_kept_when_a_later_case_fails(tmp_path: Path) -> None:
    cases = [Square(n) for n in (1, 2, 3)]
    with pytest.raises(ValueError, match="too large"), open_executor(1) as executor:
        run_cases(cases, square_below_three, Result, tmp_path, executor, NoProgress())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["square-1.json", "square-2.json"]


def test_only_what_is_missing_is_computed(tmp_path: Path) -> None:
    with open_executor(1) as executor:
        run_cases([Square(1)], square_and_note, Result, tmp_path, executor, NoProgress())
        before = (tmp_path / "square-1.json").read_bytes()
        cases = [Square(1), Square(2)]
        results = run_cases(cases, square_and_note, Result, tmp_path, executor, NoProgress())
    assert [result.value for result in results] == [1, 4]
    assert calls == [1, 2]
    assert (tmp_path / "square-1.json").read_bytes() == before


def test_a_case_that_ends_its_processes_is_named_and_the_others_are_kept(tmp_path: Path) -> None:
    cases = [Square(n) for n in (1, 2, 3)]
    with pytest.raises(DeviceError, match=r"1 of 3 cases .*square-1 \(with exit status 9\)"):  # noqa: SIM117
        with open_executor(2) as executor:
            run_cases(cases, square_or_crash, Result, tmp_path, executor, NoProgress())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["square-2.json", "square-3.json"]
    with open_executor(1) as executor:
        results = run_cases(cases, square, Result, tmp_path, executor, NoProgress())
    assert [result.value for result in results] == [1, 4, 9]


@pytest.mark.parametrize("left", [b"", b'{"value": 1', b'{"value": "many"}', b"{}", b"\xff\xfe"])
def test_a_result_that_is_not_whole_is_made_anew(tmp_path: Path, left: bytes) -> None:
    (tmp_path / "square-2.json").write_bytes(left)
    with open_executor(1) as executor:
        for _ in range(2):
            results = run_cases([Square(2)], square_and_note, Result, tmp_path, executor, NoProgress())
            assert [result.value for result in results] == [4]
    assert calls == [2]
    assert json.loads((tmp_path / "square-2.json").read_bytes())["result"] == {"value": 4}


def test_two_cases_of_one_name_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="Two cases are named 'square-2'"), open_executor(1) as executor:
        run_cases([Square(1), Square(2), Square(2)], square, Result, tmp_path, executor, NoProgress())
