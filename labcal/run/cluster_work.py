"""The code of a cluster's worker: is its installation the same, and one case."""

import pickle
import sys
from dataclasses import dataclass

from labcal.run.code_version import CodeVersion, code_version
from labcal.run.machine import package_version
from labcal.run.worker_process import called

_PACKAGES = (
    "drjit", "mitsuba", "numba", "numpy", "opencv-contrib-python-headless", "pydantic", "scikit-learn",
    "scipy", "torch",
)  # fmt: skip
"""Packages whose version may decide on the last digits."""


@dataclass(frozen=True)
class Installation:
    """The versions on which results depend."""

    code: CodeVersion
    packages: tuple[tuple[str, str | None], ...]

    @classmethod
    def here(cls) -> "Installation":
        """Return the versions of this process."""
        python = ".".join(map(str, sys.version_info[:2]))
        packages = [(package, package_version(package)) for package in _PACKAGES]
        return cls(code_version(), (("Python", python), *packages))


def mismatch(wanted: Installation) -> str | None:
    """Return how the installation of this process differs from the one wanted; None where it does not.

    A worker on which labcal is missing cannot load this function, and says that.
    """
    here = Installation.here()
    if here.code != wanted.code:
        return f"it has {here.code} and not {wanted.code}"
    differing = [
        f"{package} {found or '(none)'} and not {version or '(none)'}"
        for (package, version), (_, found) in zip(wanted.packages, here.packages, strict=True)
        if found != version
    ]
    return f"it has {', '.join(differing)}" if differing else None


def perform(case: bytes) -> bytes:
    """Perform a pickled case and return its pickled result; raise what the case raises."""
    return called(pickle.loads(case))  # noqa: S301 -- whoever reaches a scheduler's port can run code anyway
