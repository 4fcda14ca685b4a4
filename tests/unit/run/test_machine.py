import os
import shutil
from pathlib import Path

import pytest

from labcal.run.machine import free_disk_bytes, memory_bytes, usable_cores


def test_cores_are_those_this_process_may_use() -> None:
    assert 1 <= usable_cores() <= (os.cpu_count() or 1)


@pytest.mark.skipif(
    not hasattr(os, "sched_setaffinity"), reason="this system does not bind processes to cores"
)
def test_a_process_bound_to_one_core_sees_one() -> None:
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)})
    try:
        assert usable_cores() == 1
    finally:
        os.sched_setaffinity(0, allowed)


def test_memory_agrees_with_the_kernel() -> None:
    table = Path("/proc/meminfo")
    if not table.exists():
        pytest.skip("this system has no /proc/meminfo")
    kibibytes = int(table.read_text().split("MemTotal:")[1].split()[0])
    assert memory_bytes() == pytest.approx(kibibytes * 1024, rel=1e-3)


def test_free_disk_is_that_of_the_folder(tmp_path: Path) -> None:
    # Others write meanwhile; the order of magnitude is what is asked for.
    assert free_disk_bytes(tmp_path) == pytest.approx(shutil.disk_usage(tmp_path).free, rel=0.05)
