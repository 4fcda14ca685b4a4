"""The LLVM library of Dr.Jit on processors, located before Dr.Jit searches for one itself.

Left alone, Dr.Jit takes whatever LLVM the system has, and some versions end the process without an error
that Python could catch (version 15 of Debian 12 does).
"""

import os
import platform
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

from labcal.errors import DeviceError

PACKAGE = "karellen-llvm-core"
VARIABLE = "DRJIT_LIBLLVM_PATH"

_INSTALL = {
    "Linux": "Install LLVM 17 or later from your distribution",
    "Darwin": "Install LLVM with Homebrew ('brew install llvm')",
    "Windows": "Install LLVM 17 or later from the LLVM project's releases (LLVM-<version>-win64.exe)",
}
_USUAL_PLACES = {
    "Darwin": ("/opt/homebrew/opt/llvm/lib/libLLVM.dylib", "/usr/local/opt/llvm/lib/libLLVM.dylib"),
    "Windows": (r"C:\Program Files\LLVM\bin\LLVM-C.dll",),
}
"""Paths of the library in the recommended installations; on Linux every distribution has its own."""


def ensure_llvm() -> Path:
    """Set an LLVM library that works for Dr.Jit; call it before Dr.Jit is first used.

    Sets ``DRJIT_LIBLLVM_PATH`` for this process, unless the user has set it. Calling it again does nothing
    more.

    Returns
    -------
    Path
        The library that Dr.Jit will load.

    Raises
    ------
    DeviceError
        No library was found, or the one that the user names does not exist; the message says what to
        install on this system.
    """
    chosen = os.environ.get(VARIABLE)
    if chosen:
        if not Path(chosen).is_file():
            raise DeviceError(f"{VARIABLE} names {chosen}, which is not a file. {install_advice()}")
        return Path(chosen)
    library = _packaged_library() or _installed_library()
    if library is None:
        raise DeviceError(f"Rendering needs an LLVM library, and none is installed. {install_advice()}")
    os.environ[VARIABLE] = str(library)
    return library


def install_advice() -> str:
    """Return advice on packages to install and variables to set on this system."""
    system = platform.system()
    if system == "Linux" and platform.machine() == "x86_64":
        return f"Install the Python package {PACKAGE}, and leave {VARIABLE} unset."
    install = _INSTALL.get(system, "Install LLVM 17 or later")
    return f"{install}; where it is not found then, set {VARIABLE} to the path of its library."


def _packaged_library() -> Path | None:
    """Return the library inside the Python package, if that is installed."""
    try:
        listed = files(PACKAGE) or []
    except PackageNotFoundError:
        return None
    # The package makes its links (libLLVM.so) at the first start of Python only; the file is there at once.
    found = [Path(str(entry.locate())) for entry in listed if entry.name.startswith("libLLVM.so.")]
    present = sorted(path.resolve() for path in found if path.is_file())
    return present[-1] if present else None


def _installed_library() -> Path | None:
    """Return the library of an installation of the operating system, if there is one."""
    for place in _USUAL_PLACES.get(platform.system(), ()):
        if Path(place).is_file():
            return Path(place)
    return None
