"""Where other disks, or other folders of the same disk, are mounted."""

import os
from contextlib import suppress
from pathlib import Path


def is_mount(path: Path) -> bool:
    """Return whether something is mounted there, also another folder or file of the same disk (Linux)."""
    if os.path.ismount(path):
        return True
    with suppress(OSError):
        real = os.path.realpath(path)
        lines = Path("/proc/self/mountinfo").read_text(encoding="utf-8", errors="surrogateescape")
        return any(_unescaped(line.split(" ")[4]) == real for line in lines.splitlines())
    return False


def _unescaped(text: str) -> str:
    """Return a path of ``mountinfo``, where blanks and the like are written as octal numbers."""
    for number in (" ", "\t", "\n", "\\"):
        text = text.replace(f"\\{ord(number):03o}", number)
    return text
