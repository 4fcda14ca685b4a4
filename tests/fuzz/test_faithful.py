"""Mutated files are refused by labcal's own errors, or read to what they state: numbers, and poses."""

from pathlib import Path

import pytest

from fuzz.faithful import readings
from fuzz.faithful_documents import DOCUMENTS
from fuzz.faithful_tables import TABLES, table_readings
from fuzz.stated_cameras import READERS
from fuzz.stated_forms import FORMS
from fuzz.stated_robots import ROBOTS
from labcal.cameras.interop.registry import READ

CAMERAS = [*READERS, *ROBOTS, *FORMS]
EVERY = {**TABLES, **DOCUMENTS}
QUICK, MANY = 40, 400
"""Mutants of a kind; ``python -m fuzz.files --count 3000`` tries more, by the seed of the day."""


@pytest.mark.parametrize("name", CAMERAS)
def test_mutated_files_of_cameras(name: str, tmp_path: Path) -> None:
    found = list(readings(name, tmp_path, 19, QUICK))
    assert not [one for one in found if one.faults]
    assert sum(one.refused for one in found) > QUICK / 8


@pytest.mark.parametrize("name", list(EVERY))
def test_mutated_tables(name: str, tmp_path: Path) -> None:
    found = list(table_readings(EVERY[name], tmp_path, 19, QUICK))
    assert not [one for one in found if one.faults]
    assert sum(one.refused for one in found) > QUICK / 8


@pytest.mark.slow
@pytest.mark.parametrize("name", [*CAMERAS, *EVERY])
def test_many_mutated_files(name: str, tmp_path: Path) -> None:
    how = tmp_path, 20, MANY
    found = list(readings(name, *how) if name in CAMERAS else table_readings(EVERY[name], *how))
    assert not [one for one in found if one.faults]
    assert not all(one.refused for one in found)


def test_every_format_has_a_judge() -> None:
    assert set(READ) <= set(CAMERAS)
