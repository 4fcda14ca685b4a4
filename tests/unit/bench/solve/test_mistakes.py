"""What the benchmark of mistakes measures with."""

import tempfile
from pathlib import Path

import pytest

from labcal.bench.solve.mistaken_set import SIZES, SetOfPictures, evaluated_set


@pytest.mark.slow
def test_a_rendered_set_tells_each_mistake_and_accuses_nobody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    found = evaluated_set(SetOfPictures(7))
    assert not found.accused
    assert {name for name, one in found.mistakes.items() if one.told} == set(SIZES)
    assert list(tmp_path.iterdir()) == []
