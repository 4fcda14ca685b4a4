"""Checks of ``labcal doctor``: the machine, the packages, and whether they really work."""

import os
import platform
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from labcal.errors import DeviceError
from labcal.run.machine import free_disk_bytes, memory_bytes, package_version, usable_cores

OLDEST_PYTHON = (3, 11)

_GIB = 2**30
_LEAST_MEMORY = 2 * _GIB
_LEAST_DISK = 1 * _GIB
_SECONDS = 120.0

# Name of the distribution, and what labcal does with it.
_PACKAGES = {
    "numpy": "arrays",
    "scipy": "numerics",
    "scikit-learn": "solvers",
    "pydantic": "descriptions",
    "PyYAML": "descriptions",
    "jaxtyping": "shapes of arrays",
    "safetensors": "saved models",
    "matplotlib": "figures and targets",
    "Jinja2": "reports",
    "plotly": "the 3-D view of pages",
    "rich": "the terminal",
    "lazy-loader": "imports",
    "numba": "detection",
    "llvmlite": "detection",
    "pillow": "pictures",
    "threadpoolctl": "one thread for each case",
    "mitsuba": "rendering",
    "drjit": "rendering",
    "opencv-contrib-python-headless": "pictures and calibration",
    "OpenEXR": "linear pictures",
    "torch": "networks",
}

# What only running shows; each line fails with a message where the library does not work.
_TRIALS = {
    "OpenCV works": "import cv2, numpy as np; cv2.GaussianBlur(np.zeros((9, 9), np.uint8), (3, 3), 0)",
    "torch works": "import torch; torch.linalg.cholesky(torch.eye(3, dtype=torch.float64))",
    "OpenEXR works": "import OpenEXR; OpenEXR.File",
}


@dataclass(frozen=True)
class Check:
    """One line of the table: what was found, and where it is not enough, how to mend it."""

    name: str
    ok: bool
    found: str | None
    advice: str | None


def all_checks() -> list[Callable[[], Check]]:
    """Return the checks, quick ones first; each is made when called."""
    return [
        _check_python,
        _check_system,
        _check_processors,
        _check_memory,
        _check_disk,
        *(partial(_check_package, name, purpose) for name, purpose in _PACKAGES.items()),
        *(partial(_check_trial, name, code) for name, code in _TRIALS.items()),
        _check_rendering,
    ]


def _check_python() -> Check:
    ok = sys.version_info[:2] >= OLDEST_PYTHON
    oldest = ".".join(str(part) for part in OLDEST_PYTHON)
    return Check(
        "python", ok, platform.python_version(), None if ok else f"Install Python {oldest} or later."
    )


def _check_system() -> Check:
    return Check("system", True, f"{platform.system()} {platform.release()} on {platform.machine()}", None)


def _check_processors() -> Check:
    return Check("processors", True, f"{usable_cores()} of {os.cpu_count()} usable", None)


def _check_memory() -> Check:
    size = memory_bytes()
    if size is None:
        return Check("memory", True, "not known on this system", None)
    ok = size >= _LEAST_MEMORY
    advice = None if ok else f"Rendering needs some {_LEAST_MEMORY // _GIB} GiB; expect it to fail with less."
    return Check("memory", ok, f"{size / _GIB:.1f} GiB", advice)


def _check_disk() -> Check:
    free = free_disk_bytes(Path.cwd())
    ok = free >= _LEAST_DISK
    advice = None if ok else "Free some space; a shoot takes up to a few hundred MB."
    return Check("disk", ok, f"{free / _GIB:.1f} GiB free here", advice)


def _check_package(name: str, purpose: str) -> Check:
    """Check that a package is installed, without importing it."""
    version = package_version(name)
    return Check(
        name, version is not None, version, None if version else f"pip install {name} (for {purpose})"
    )


def _check_trial(name: str, code: str) -> Check:
    """Run a line of Python in a process of its own, which a broken library may end."""
    try:
        # This interpreter and a line from the table above; nothing of it comes from outside.
        done = subprocess.run(  # noqa: S603
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            timeout=_SECONDS,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    except subprocess.TimeoutExpired:
        return Check(name, False, None, f"It took more than {_SECONDS:g} s.")
    if done.returncode == 0:
        return Check(name, True, "yes", None)
    output = done.stderr.strip().splitlines() or ["no message"]
    package = name.removesuffix(" works")
    advice = f"Reinstall {package}; its message: {output[-1][:200]} (exit status {done.returncode})"
    return Check(name, False, None, advice)


def _check_rendering() -> Check:
    from labcal.render.trial import try_render

    try:
        return Check("rendering works", True, try_render(), None)
    except DeviceError as error:
        return Check("rendering works", False, None, str(error))
