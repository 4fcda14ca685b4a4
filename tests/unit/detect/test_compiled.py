"""Machine code that is kept must not outlive the sources that it was made from."""

from pathlib import Path

from labcal.detect.compiled import _SOURCES, _digest_of
from labcal.detect.edge_kernel import fit_all


def test_the_digest_sees_every_source(tmp_path: Path) -> None:
    (tmp_path / "caller.py").write_text("1")
    (tmp_path / "callee.py").write_text("2")
    before = _digest_of(tmp_path)
    assert _digest_of(tmp_path) == before
    (tmp_path / "callee.py").write_text("3")
    assert _digest_of(tmp_path) != before


def test_machine_code_is_kept_under_the_digest() -> None:
    assert fit_all.__qualname__ == f"fit_all-{_SOURCES}"  # Numba makes the files' names from it
