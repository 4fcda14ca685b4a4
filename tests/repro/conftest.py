"""Clusters of two workers, each a process of its own."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from repro.processes import DaskProcesses


@pytest.fixture
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaskProcesses]:
    """A cluster that a test may do harm to."""
    made = DaskProcesses(tmp_path_factory.mktemp("cluster"))
    try:
        for _ in range(2):
            made.start_worker()
        yield made
    finally:
        made.close()


@pytest.fixture
def notes(tmp_path: Path) -> Path:
    """A folder for notes of cases."""
    folder = tmp_path / "notes"
    folder.mkdir()
    return folder
