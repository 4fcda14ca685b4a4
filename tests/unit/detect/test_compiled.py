"""Machine code that is kept must not outlive the sources that it was made from."""

from pathlib import Path

import numpy as np
import pytest

from labcal.detect import compiled
from labcal.detect.compiled import _SOURCES, _digest_of, is_kept
from labcal.detect.edges.gauss_newton import fit_all
from labcal.detect.lattice.neighbourhood import residual_in_steps


def test_the_digest_sees_every_source(tmp_path: Path) -> None:
    (tmp_path / "caller.py").write_text("1")
    (tmp_path / "callee.py").write_text("2")
    before = _digest_of(tmp_path)
    assert _digest_of(tmp_path) == before
    (tmp_path / "callee.py").write_text("3")
    assert (after := _digest_of(tmp_path)) != before
    (tmp_path / "stage").mkdir()
    (tmp_path / "stage" / "part.py").write_text("4")
    assert _digest_of(tmp_path) != after


def test_machine_code_is_kept_under_the_digest() -> None:
    assert fit_all.__qualname__ == f"fit_all-{_SOURCES}"  # Numba makes the files' names from it


def test_code_is_kept_once_it_was_used_and_not_that_of_other_sources(monkeypatch: pytest.MonkeyPatch) -> None:
    residual_in_steps(np.array([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]), 0.5, 0.5)
    assert is_kept(residual_in_steps)
    monkeypatch.setattr(compiled, "_SOURCES", "0123456789ab")
    assert not is_kept(residual_in_steps)
