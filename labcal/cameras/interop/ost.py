"""ROS's ``ost.txt`` (also ``ost.ini``), which camera_calibration prints: one camera, or a rectified pair.

Headings in brackets, then names with their numbers in the lines below. A pair is two such texts one after the
other. The contents are those of a camera_info: ``distortion`` is OpenCV's k1 k2 p1 p2 k3.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from labcal.cameras.interop.exchange import NOTHING_GIVEN, ReadOptions, ReadRig, SourceText, Unit
from labcal.cameras.interop.read_only import read_only_format
from labcal.cameras.interop.ros import rig_of_infos
from labcal.errors import InputError

_BEGIN = re.compile(r"^# oST version", re.MULTILINE)
_HEADING = re.compile(r"\[([^\]]+)\]")
_NAMES = {
    "width": "image_width",
    "height": "image_height",
    "camera matrix": "camera_matrix",
    "distortion": "distortion_coefficients",
    "rectification": "rectification_matrix",
    "projection": "projection_matrix",
}
_ROWS = {"camera_matrix": 3, "rectification_matrix": 3, "projection_matrix": 3}
"""Lines of numbers; one of the rest."""
_FISHEYE_COUNT = 4
"""As many coefficients are those of either lens."""


def recognises(text: str) -> bool:
    """Tell whether a text is such a file."""
    return _BEGIN.search(text) is not None


def read_ost(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one camera, or a rectified pair from one file or two; the first camera is the world.

    Raises
    ------
    InputError
        A file is damaged, there are more than two cameras, or nothing determines where the second one is.
    """
    contents, names, paths = [], [], []
    for source in sources:
        before, *texts = _BEGIN.split(source.text)
        if not texts or re.search(r"^[^#\s]", before, re.MULTILINE):
            raise InputError(f"{source.path} is no ost.txt: it should begin with '# oST version'.")
        for text in texts:
            name, content = _content(text, source.path)
            contents.append(content)
            names.append(name)
            paths.append(source.path)
    return rig_of_infos(contents, names, paths)


def _content(text: str, path: Path) -> tuple[str, Mapping[str, Any]]:
    """Return the name and the camera_info of one camera."""
    name, key = "", ""
    words: dict[str, list[str]] = {}
    rows: Counter[str] = Counter()
    for line in text.splitlines()[1:]:
        stripped = line.strip()
        heading = _HEADING.fullmatch(stripped)
        if heading is not None:
            name = name if heading[1] == "image" else heading[1]
        elif stripped in _NAMES:
            key = _NAMES[stripped]
            if key in words:
                raise InputError(f"{path}: '{stripped}' occurs twice in one camera.")
            words[key] = []
        elif stripped and not stripped.startswith("#"):
            if not key:
                raise InputError(f"{path}: the line '{stripped:.40}' belongs to nothing.")
            words[key] += stripped.split()
            rows[key] += 1
    lost = [stated for stated, key in _NAMES.items() if rows[key] != _ROWS.get(key, 1)]
    if lost:
        raise InputError(
            f"{path}: '{lost[0]}' should have {_ROWS.get(_NAMES[lost[0]], 1)} lines of numbers, but has "
            f"{rows[_NAMES[lost[0]]]}. Copy the text again."
        )
    if len(words.get("distortion_coefficients", [])) == _FISHEYE_COUNT:
        raise InputError(
            f"{path} has four coefficients and does not state the lens that they are of. Convert ost.yaml, "
            "which stands beside it and does."
        )
    sides = {key: words.pop(key, []) for key in ("image_width", "image_height")}
    return name, {
        **{key: {"data": numbers} for key, numbers in words.items()},
        **{key: numbers[0] if len(numbers) == 1 else None for key, numbers in sides.items()},
        "distortion_model": "plumb_bob",
    }


OST = read_only_format("ost", (".txt", ".ini"), recognises, read_ost, Unit.METRES)
