"""Text files that list pictures."""

from pathlib import Path

from labcal.errors import InputError
from labcal.run.file_reading import read_text
from labcal.wording import clipped, printable

LIST = ".txt"
"""Ending of a text file that lists pictures."""
_MOST_BYTES = 16 * 2**20


def listed_pictures(path: Path) -> list[str]:
    """Return the pictures that a text file lists, a path a line, without empty lines and those of ``#``.

    A path that is not absolute begins where labcal is run or, where nothing is there, at the list's folder.

    Raises
    ------
    InputError
        The file cannot be read, lists nothing, or a picture is not there, or at both places.
    """
    text = read_text(path, "list of pictures", _MOST_BYTES)
    lines = {number: line.strip() for number, line in enumerate(text.splitlines(), 1)}
    found = []
    for number, line in lines.items():
        if not line or line.startswith("#"):
            continue
        here = [place for place in (Path(line), path.parent / line) if place.is_file()]
        if not here:
            raise InputError(
                f"Line {number} of {path} names {clipped(printable(line))}, but no such file is there. "
                "Correct the path: it begins where labcal is run, or at the list's folder."
            )
        if not here[0].samefile(here[-1]):
            raise InputError(
                f"Line {number} of {path} may be {here[0]} or {here[1]}: there are both. Write whole paths."
            )
        found.append(str(here[0]))
    if not found:
        raise InputError(f"{path} lists no pictures. Write the path of one in each line.")
    return found
