"""Mount points of other disks, or of other folders of the same disk."""

import os
from contextlib import suppress
from pathlib import Path


def is_mount(path: Path) -> bool:
    """Return whether a path is a mount point, also of another folder or file of the same disk (Linux)."""
    if os.path.ismount(path):
        return True
    with suppress(OSError):
        real = os.path.realpath(path)
        lines = Path("/proc/self/mountinfo").read_text(encoding="utf-8", errors="surrogateescape")
        return any(mounted_at(line) == real for line in lines.splitlines())
    return False


def mounted_at(line: str) -> str:
    """Return the path in a line of ``mountinfo``, with blanks decoded from octal numbers."""
    place = line.split(" ")[4]
    for character in (" ", "\t", "\n", "\\"):
        place = place.replace(f"\\{ord(character):03o}", character)
    return place
