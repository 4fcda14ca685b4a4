"""``transforms.json`` of Nerfstudio and Instant NGP: the lens of one camera that took all pictures.

``OPENCV`` is OpenCV's k1 k2 p1 p2 k3, ``OPENCV_FISHEYE`` its fisheye. Pixels count from the corner of the
first one, as in COLMAP, so that the principal point is 0.5 px larger: it is shifted here and nowhere else.
Instant NGP says ``is_fisheye``. The places of the frames are those of one moving camera, and are not read.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from labcal.cameras.interop.exchange import NOTHING_GIVEN, ReadOptions, ReadRig, SourceText, Unit
from labcal.cameras.interop.lens_parameters import camera_record
from labcal.cameras.interop.numbers_text import known_size
from labcal.cameras.interop.placement import rig_of
from labcal.cameras.interop.read_only import read_only_format
from labcal.cameras.interop.slam_lenses import Lens, brown, fisheye, numbers_by_name
from labcal.errors import InputError
from labcal.run.json_reading import json_content

_CORNER = 0.5
_LENSES: dict[object, Callable[[Mapping[str, object], Path], Lens]] = {
    None: brown,
    "PINHOLE": brown,
    "SIMPLE_PINHOLE": brown,
    "OPENCV": brown,
    "OPENCV_FISHEYE": fisheye,
}
"""By ``camera_model``; without one it is perspective."""


def recognises(text: str) -> bool:
    """Tell whether a text is such a file."""
    return '"transform_matrix"' in text and '"frames"' in text and '"fl_x"' in text


def read_nerfstudio(sources: Sequence[SourceText], given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one camera.

    Raises
    ------
    InputError
        The file is damaged, of another lens, or each frame has a camera of its own.
    """
    if len(sources) != 1:
        raise InputError("A transforms.json holds one camera. Convert each file alone.")
    path = sources[0].path
    content = json_content(sources[0].text, str(path))
    if not isinstance(content, dict) or "fl_x" not in content:
        raise InputError(
            f"{path} has no fl_x for all of its frames: each has a camera of its own, or none. Calibrate "
            "with one camera for all pictures."
        )
    is_ngps_fisheye = "camera_model" not in content and content.get("is_fisheye") is True
    model = "OPENCV_FISHEYE" if is_ngps_fisheye else content.get("camera_model")
    if model not in _LENSES:
        known = ", ".join(str(name) for name in _LENSES if name)
        raise InputError(f"{path}: the camera model {model!r:.40} has no counterpart here; {known} have.")
    sides = [content.get("w"), content.get("h")]
    size = known_size(None if sides == [None, None] else sides, given.size, path)
    with_fy = {"fl_y": content["fl_x"], **content}
    fx, fy, cx, cy = numbers_by_name(("fl_x", "fl_y", "cx", "cy"), with_fy, path)
    numbers = (fx, fy, cx - _CORNER, cy - _CORNER)
    record = camera_record(numbers, _LENSES[model](content, path), np.eye(4), size, path)
    frames = content.get("frames")
    count = len(frames) if isinstance(frames, list) else 0
    note = f"One camera took all {count} pictures: its lens is read, no place of it."
    return ReadRig(rig_of([path.stem], [record]), (note,))


NERFSTUDIO = read_only_format(
    "nerfstudio", (".json",), recognises, read_nerfstudio, Unit.MILLIMETRES, ("size",)
)
