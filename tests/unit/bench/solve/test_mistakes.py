"""What the benchmark of mistakes measures with."""

from pathlib import Path

import pytest

from labcal.bench.solve.mistaken_set import SIZES, SetOfPictures, evaluated_set


@pytest.mark.slow
def test_a_rendered_set_tells_each_mistake_and_accuses_nobody(tmp_path: Path) -> None:
    found = evaluated_set(SetOfPictures(7, str(tmp_path)))
    assert not found.accused
    assert {name for name, one in found.mistakes.items() if one.told} == set(SIZES)
    assert list(tmp_path.iterdir()) == []
