"""Cameras of camodocal, as VINS-Mono and VINS-Fusion use them: one camera a file, without its place.

``PINHOLE`` is OpenCV's k1 k2 p1 p2 and ``PINHOLE_FULL`` its k1 to k6; ``MEI`` the unified lens of Mei and
Rives (xi, focal lengths gamma1 and gamma2); ``KANNALA_BRANDT`` OpenCV's fisheye, whose k1 to k4 are called k2
to k5.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labcal.cameras.interop.exchange import NOTHING_GIVEN, ReadOptions, ReadRig, SourceText, Unit
from labcal.cameras.interop.lens_parameters import camera_record
from labcal.cameras.interop.numbers_text import picture_size
from labcal.cameras.interop.placement import rig_of
from labcal.cameras.interop.read_only import read_only_format
from labcal.cameras.interop.slam_lenses import (
    Lens,
    brown,
    fisheye,
    numbers_by_name,
    omnidirectional,
    rational,
)
from labcal.cameras.interop.yaml_tree import read_yaml_tree
from labcal.errors import InputError

_MODELS = ("PINHOLE", "PINHOLE_FULL", "MEI", "KANNALA_BRANDT")
_MODEL = re.compile(r"^model_type:", re.MULTILINE)


def recognises(text: str) -> bool:
    """Tell whether a text is a file of a camera."""
    return _MODEL.search(text) is not None and "projection_parameters:" in text


def read_camodocal(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one camera.

    Raises
    ------
    InputError
        The file is damaged or of a lens that labcal does not have, or there are several.
    """
    if len(sources) != 1:
        raise InputError(
            "Files of camodocal (VINS) hold cameras without their places, so several cannot be placed in one "
            "world. Convert each file alone."
        )
    path = sources[0].path
    content = read_yaml_tree(sources[0].text, path)
    numbers, lens = _lens(content, path)
    size = picture_size([content.get("image_width"), content.get("image_height")], path)
    name = content.get("camera_name")
    stated = name if isinstance(name, str) and name not in {"", "camera"} else path.stem
    return ReadRig(rig_of([stated], [camera_record(numbers, lens, np.eye(4), size, path)]))


def _lens(content: Mapping[str, Any], path: Path) -> tuple[list[float], Lens]:
    """Return fx, fy, cx, cy and the lens."""
    model = str(content.get("model_type"))
    projection = _part(content, "projection_parameters", path)
    if model == "KANNALA_BRANDT":
        lens = fisheye(projection, path, ("k2", "k3", "k4", "k5"))
        return numbers_by_name(("mu", "mv", "u0", "v0"), projection, path), lens
    if model not in _MODELS:
        raise InputError(
            f"{path}: the camera model {model!r:.40} has no counterpart here; {', '.join(_MODELS)} have."
        )
    distortion = _part(content, "distortion_parameters", path)
    if model == "MEI":
        (xi,) = numbers_by_name(("xi",), _part(content, "mirror_parameters", path), path)
        numbers = numbers_by_name(("gamma1", "gamma2", "u0", "v0"), projection, path)
        return numbers, omnidirectional(xi, distortion, path)
    lens = (rational if model == "PINHOLE_FULL" else brown)(distortion, path)
    return numbers_by_name(("fx", "fy", "cx", "cy"), projection, path), lens


def _part(content: Mapping[str, Any], key: str, path: Path) -> Mapping[str, Any]:
    part = content.get(key)
    if not isinstance(part, dict):
        raise InputError(f"{path} has no {key} with names and numbers.")
    return part


CAMODOCAL = read_only_format("camodocal", (".yaml", ".yml"), recognises, read_camodocal, Unit.METRES, ())
