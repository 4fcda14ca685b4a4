"""Results of Bouguet's Camera Calibration Toolbox for MATLAB: variables in a MAT-file.

``Calib_Results.mat`` has ``fc cc kc alpha_c nx ny``, and ``Calib_Results_stereo.mat`` the same with
``_left`` and ``_right``, and ``om`` or ``R``, and ``T``, which map coordinates of the left camera to those of
the right one. Pixels count from 0 at the centre of the top-left one, and kc is OpenCV's k1 k2 p1 p2 k3.
Lengths are mostly in millimetres.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.exchange import ReadOptions, ReadRig
from labcal.cameras.interop.lens_parameters import camera_record, perspective_lens
from labcal.cameras.interop.mat_file import Value
from labcal.cameras.interop.numbers_text import finite_numbers, known_size
from labcal.cameras.interop.placement import rig_of, rounded_pose
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector

_SIDES = ("_left", "_right")
_COEFFICIENTS = (4, 5)


def is_of_bouguet(variables: Mapping[str, Value]) -> bool:
    """Tell whether the variables of a MAT-file are results of the toolbox."""
    return any({f"fc{side}", f"cc{side}", f"kc{side}"} <= set(variables) for side in ("", _SIDES[0]))


def read_bouguet(variables: Mapping[str, Value], given: ReadOptions, path: Path) -> ReadRig:
    """Return a pair, or one camera.

    Raises
    ------
    InputError
        Variables are missing or damaged, or there is skew, or nobody states the size of the pictures.
    """
    if f"fc{_SIDES[0]}" not in variables:
        return ReadRig(rig_of([path.stem], [_camera(variables, "", np.eye(4), given, path)]))
    t = np.array(_numbers(variables, "T", (3,), path))
    notes: tuple[str, ...] = ()
    if "om" in variables:
        T_right_left = from_rotation_vector(np.array(_numbers(variables, "om", (3,), path)), t)
    else:
        R = np.array(_numbers(variables, "R", (9,), path)).reshape(3, 3)
        T_right_left, notes = rounded_pose(R, t, path)
    poses = (np.eye(4), T_right_left)
    records = [_camera(variables, side, T, given, path) for side, T in zip(_SIDES, poses, strict=True)]
    return ReadRig(rig_of(["left", "right"], records), notes)


def _numbers(
    variables: Mapping[str, Value], name: str, counts: tuple[int, ...], path: Path
) -> tuple[float, ...]:
    """Return the numbers of a variable, row by row."""
    value = variables.get(name)
    if not isinstance(value, np.ndarray):
        raise InputError(f"{path} has no numbers '{name}', as results of the calibration toolbox have.")
    return finite_numbers(value.ravel().tolist(), counts, name, path)


def _camera(
    variables: Mapping[str, Value], side: str, T_cam_world: Pose, given: ReadOptions, path: Path
) -> CameraRecord:
    """Return one camera."""
    fx, fy = _numbers(variables, f"fc{side}", (2,), path)
    cx, cy = _numbers(variables, f"cc{side}", (2,), path)
    skew = _numbers(variables, f"alpha_c{side}", (1,), path)[0] if f"alpha_c{side}" in variables else 0.0
    if skew != 0.0:
        raise InputError(
            f"{path}: alpha_c{side} states a skew of {skew:g}, which labcal's cameras do not have. Calibrate "
            "with est_alpha = 0."
        )
    coefficients = _numbers(variables, f"kc{side}", _COEFFICIENTS, path)
    stated = None
    if "nx" in variables or "ny" in variables:
        stated = [_numbers(variables, name, (1,), path)[0] for name in ("nx", "ny")]
    size = known_size(stated, given.size, path)
    return camera_record((fx, fy, cx, cy), perspective_lens(coefficients), T_cam_world, size, path)
