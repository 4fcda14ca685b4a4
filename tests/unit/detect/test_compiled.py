"""Machine code that is kept must not outlive the sources that it was made from."""

from pathlib import Path

import numpy as np
import pytest

from labcal.detect import compiled
from labcal.detect.compiled import _digest_of, is_kept
from labcal.detect.edges import gauss_newton
from labcal.detect.edges.gauss_newton import fit_all
from labcal.detect.lattice.neighbourhood import residual_in_steps


def _write(folder: Path, sources: dict[str, str]) -> None:
    """Write sources of a package `labcal`, where each name is that of a module in it."""
    for name, text in sources.items():
        path = folder.joinpath("labcal", *name.split(".")).with_suffix(".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    compiled._imported_by.cache_clear()


def test_the_digest_sees_all_that_a_source_imports(tmp_path: Path) -> None:
    _write(
        tmp_path,
        {
            "caller": '"""Text."""\n\nimport math\nfrom labcal.stage.callee import (\n    A,\n)\n',
            "stage.callee": "import labcal.limits\n",
            "limits": "A = 1\n",
            "other": "B = 1\n",
        },
    )
    caller = tmp_path / "labcal" / "caller.py"
    before = _digest_of(caller, tmp_path)
    assert _digest_of(caller, tmp_path) == before
    _write(tmp_path, {"other": "B = 2\n"})
    assert _digest_of(caller, tmp_path) == before
    _write(tmp_path, {"limits": "A = 2\n"})
    assert (after := _digest_of(caller, tmp_path)) != before
    _write(tmp_path, {"stage.callee": "import labcal.limits  # changed\n"})
    assert (third := _digest_of(caller, tmp_path)) not in (before, after)
    _write(tmp_path, {"caller": "from labcal import stage\n"})  # of a folder all counts
    assert _digest_of(caller, tmp_path) not in (before, after, third)


def test_sources_that_import_each_other_have_a_digest(tmp_path: Path) -> None:
    _write(tmp_path, {"one": "from labcal.two import B\n", "two": "from labcal.one import A\n"})
    one, two = (_digest_of(tmp_path / "labcal" / name, tmp_path) for name in ("one.py", "two.py"))
    assert one == two


def test_machine_code_is_kept_under_the_digest() -> None:
    digest = _digest_of(Path(gauss_newton.__file__))
    assert fit_all.__qualname__ == f"fit_all-{digest}"  # Numba makes the files' names from it


def test_code_is_kept_once_it_was_used_and_not_that_of_other_sources(monkeypatch: pytest.MonkeyPatch) -> None:
    residual_in_steps(np.array([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]), 0.5, 0.5)
    assert is_kept(residual_in_steps)
    monkeypatch.setattr(residual_in_steps, "__qualname__", "residual_in_steps-0123456789ab")
    assert not is_kept(residual_in_steps)
