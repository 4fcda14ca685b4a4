"""The resources of this machine: processors, memory, disk and packages."""

import os
import shutil
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


def usable_cores() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def memory_bytes() -> int | None:
    """Return the size of the main memory, or None if the system does not report it."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # Windows has no sysconf
        return None


def free_disk_bytes(folder: Path) -> int:
    """Return the free space of the disk that holds `folder`."""
    return shutil.disk_usage(folder).free


def package_version(package: str) -> str | None:
    """Return the version of a package without importing it, or None where it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None
