"""``sensor.yaml`` of the EuRoC data sets (ASL format), one camera a file, in metres.

``T_BS`` maps coordinates of the sensor to those of the body, on which all cameras are placed. The distortion
is ``radial-tangential`` (OpenCV's k1 k2 p1 p2) or ``equidistant`` (its fisheye). A camera is called as the
folder that holds its file.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.exchange import NOTHING_GIVEN, ReadOptions, ReadRig, SourceText, Unit
from labcal.cameras.interop.lens_parameters import (
    camera_record,
    coefficients_of,
    fisheye_lens,
    perspective_lens,
)
from labcal.cameras.interop.numbers_text import finite_numbers, picture_size
from labcal.cameras.interop.placement import MM_IN_M, rig_of, rounded_pose
from labcal.cameras.interop.read_only import read_only_format
from labcal.cameras.interop.yaml_tree import read_yaml_tree
from labcal.errors import InputError
from labcal.geometry.poses import inverse

_LENSES = {
    "radial-tangential": (perspective_lens, 4),
    "radtan": (perspective_lens, 4),
    "equidistant": (fisheye_lens, 4),
    "none": (perspective_lens, 0),
}
_FILE = "sensor"
"""Name of all such files, which are distinguished by their folders."""


def recognises(text: str) -> bool:
    """Tell whether a text is a file of a sensor."""
    return re.search(r"^T_BS:", text, re.MULTILINE) is not None and "sensor_type:" in text


def read_euroc(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one camera from each file; the first one is the world.

    Raises
    ------
    InputError
        A file is damaged, is of another sensor, or of a lens that labcal does not have.
    """
    contents = [read_yaml_tree(source.text, source.path) for source in sources]
    paths = [source.path for source in sources]
    placed = [_on_body(content, path) for content, path in zip(contents, paths, strict=True)]
    to_first = inverse(placed[0][0])
    poses = [np.eye(4), *(T_cam_body @ to_first for T_cam_body, _ in placed[1:])]
    records = []
    for content, T, path in zip(contents, poses, paths, strict=True):
        if content.get("sensor_type") != "camera" or content.get("camera_model") != "pinhole":
            raise InputError(
                f"{path}: the sensor is {content.get('sensor_type')!r:.40} with the camera model "
                f"{content.get('camera_model')!r:.40}; a camera with pinhole is read."
            )
        model = str(content.get("distortion_model"))
        if model not in _LENSES:
            raise InputError(
                f"{path}: the distortion model {model!r:.40} has no counterpart here; {', '.join(_LENSES)} "
                "have."
            )
        lens, count = _LENSES[model]
        what = "distortion_coefficients"
        coefficients = coefficients_of(model, content.get(what), count, what, path)
        numbers = finite_numbers(content.get("intrinsics"), (4,), "intrinsics", path)
        size = picture_size(content.get("resolution"), path)
        records.append(camera_record(numbers, lens(coefficients), T, size, path))
    names = [path.resolve().parent.name if path.stem == _FILE else path.stem for path in paths]
    notes = tuple(note for _, mended in placed for note in mended)
    return ReadRig(rig_of(names, records), notes if len(placed) > 1 else ())


def _on_body(content: dict[str, Any], path: Path) -> tuple[Pose, tuple[str, ...]]:
    """Return ``T_cam_body``, mm, and a note where its rotation was rounded."""
    matrix = content.get("T_BS")
    data = matrix.get("data") if isinstance(matrix, dict) else matrix
    numbers = np.array(finite_numbers(data, (16,), "T_BS", path)).reshape(4, 4)
    if not np.array_equal(numbers[3], [0.0, 0.0, 0.0, 1.0]):
        raise InputError(f"{path}: the last row of T_BS should be 0 0 0 1.")
    T_body_cam, notes = rounded_pose(numbers[:3, :3], MM_IN_M * numbers[:3, 3], path)
    return inverse(T_body_cam), notes


EUROC = read_only_format("euroc", (".yaml", ".yml"), recognises, read_euroc, Unit.METRES)
