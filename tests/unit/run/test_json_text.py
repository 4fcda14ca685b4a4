import json
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
import pytest
from pydantic import BaseModel

from labcal.errors import InputError, InputTypeError
from labcal.run.json_text import to_json


class Kind(StrEnum):
    ROUND = "round"


@dataclass(frozen=True)
class Inner:
    values: np.ndarray
    kind: Kind


class Outer(BaseModel, arbitrary_types_allowed=True):
    inner: Inner
    file: Path
    missing: float | None


def test_a_document_of_models_dataclasses_and_arrays() -> None:
    inner = Inner(np.array([[1.5, np.nan], [2.0, 3.0]]), Kind.ROUND)
    document = Outer(inner=inner, file=Path("a") / "b", missing=None)
    assert json.loads(to_json(document)) == {
        "inner": {"values": [[1.5, None], [2.0, 3.0]], "kind": "round"},
        "file": "a/b",
        "missing": None,
    }


def test_numpy_scalars_keep_their_kind() -> None:
    text = to_json([np.int64(3), np.float64(0.1), np.bool_(True), np.float64(np.nan)])
    assert json.loads(text) == [3, 0.1, True, None]
    assert "true" in text


def test_numbers_are_written_so_that_they_read_back_exactly() -> None:
    value = 0.1 + 0.2
    assert json.loads(to_json({"x": value}))["x"] == value


def test_keys_keep_their_order() -> None:
    assert list(json.loads(to_json({"z": 1, "a": 2}))) == ["z", "a"]


@pytest.mark.parametrize("value", [np.inf, -np.inf])
def test_infinity_is_refused_with_its_place(value: float) -> None:
    with pytest.raises(InputError, match=r"\$\.rows\[1\]"):
        to_json({"rows": [0.0, value]})


@pytest.mark.parametrize("value", [{1, 2}, b"bytes", 1j, object(), Inner, np.array([1j])])
def test_other_types_are_refused(value: object) -> None:
    with pytest.raises(InputTypeError, match=r"\$\.x"):
        to_json({"x": value})


def test_keys_that_are_no_text_are_refused() -> None:
    with pytest.raises(InputTypeError, match="key"):
        to_json({1: "one"})
