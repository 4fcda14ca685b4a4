"""MATLAB's ``stereoParameters`` and ``cameraParameters``, saved as plain structs.

In MATLAB: ``stereoParams = toStruct(stereoParams); save('rig.mat', 'stereoParams', '-v7')``. MATLAB counts
pixels from 1: the centre of the top-left one is (1, 1), so that the principal point is 1 px larger, as
MathWorks' page of ``stereoParametersToOpenCV`` states it; it is shifted here and nowhere else.
``IntrinsicMatrix`` and ``RotationOfCamera2`` are of row vectors (``[x y z] * R + t``), so transposed; ``K``
and ``PoseCamera2``, of MATLAB since R2022b, are not. ``RadialDistortion`` is k1 k2 (k3),
``TangentialDistortion`` p1 p2, with the formulas of OpenCV. ``ImageSize`` is rows and columns. Lengths are in
the unit that the board's squares were given in: mostly millimetres.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.bouguet import is_of_bouguet, read_bouguet
from labcal.cameras.interop.exchange import (
    NOTHING_GIVEN,
    Home,
    OutputText,
    ReadOptions,
    ReadRig,
    RigFormat,
    RigTexts,
    SourceText,
)
from labcal.cameras.interop.lens_parameters import (
    camera_record,
    held_coefficients,
    intrinsics_of,
    perspective_lens,
)
from labcal.cameras.interop.mat_file import HEADER, Unread, Value, mat_bytes, read_mat
from labcal.cameras.interop.matlab_others import require_held
from labcal.cameras.interop.matlab_units import stated_unit
from labcal.cameras.interop.numbers_text import finite_numbers, known_size
from labcal.cameras.interop.placement import poses_from_first, rig_of, rounded_pose
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.run.file_marks import FormatMark

_HOLDER = "MATLAB"
_FIRST_PIXEL = 1.0
_PAIR, _HELD = 2, 5
_DESCRIPTION = "written by labcal: a struct of stereoParameters or cameraParameters"
_WRITTEN = HEADER + b", written by labcal"
_CAMERAS = ("CameraParameters1", "CameraParameters2")
_RECIPE = (
    "In MATLAB: stereoParams = toStruct(stereoParams); save('rig.mat', 'stereoParams', '-v7'), or the same "
    "with cameraParams"
)
Fields = Mapping[str, Value]


def recognises(text: str) -> bool:
    """Tell whether bytes (a character each) are a MAT-file."""
    return text.startswith("MATLAB ") and "MAT-file" in text[:128]


def read_matlab(sources: Sequence[SourceText], given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one pair, or one camera; the first camera is the world.

    Raises
    ------
    InputError
        The file is damaged or holds objects in place of structs, or several of them, or no picture size.
    """
    if len(sources) != 1:
        raise InputError("A .mat file holds a pair, or one camera. Give one of them.")
    path = sources[0].path
    variables = read_mat(sources[0].data, path)
    if is_of_bouguet(variables):
        return read_bouguet(variables, given, path)
    structs = [one for one in [variables, *variables.values()] if isinstance(one, Mapping)]
    pairs = [one for one in structs if _CAMERAS[0] in one]
    alone = [one for one in structs if "RadialDistortion" in one]
    if len(pairs or alone) != 1:
        require_held(variables, path)
        kinds = [f"'{name:.40}'" + (f", {one.kind}" if isinstance(one, Unread) else "")
                 for name, one in variables.items()]  # fmt: skip
        raise InputError(
            f"{path} holds no struct of stereoParameters or cameraParameters, or several, but "
            f"{'; '.join(kinds)[:200] or 'nothing'}. {_RECIPE}."
        )
    if not pairs:
        record = _camera(alone[0], np.eye(4), given, path)
        return ReadRig(rig_of([path.stem], [record]))
    T_second_first, notes = _pose(pairs[0], path)
    unit, scale, scaled = stated_unit(pairs[0], given.unit, path)
    T_second_first[:3, 3] *= scale
    notes += scaled
    records = []
    for name, T in zip(_CAMERAS, (np.eye(4), T_second_first), strict=True):
        camera = pairs[0].get(name)
        if not isinstance(camera, Mapping):
            raise InputError(f"{path}: {name} is no struct. {_RECIPE}.")
        records.append(_camera(camera, T, given, path))
    return ReadRig(rig_of(["camera-1", "camera-2"], records), notes, unit)


def write_matlab(rig: Rig, _suffix: str) -> RigTexts:
    """Return one file of a pair or a camera, with the arguments that MATLAB makes the objects of.

    Raises
    ------
    InputError
        MATLAB has no such lens, or there are more than two cameras.
    """
    names = list(rig.cameras)
    if len(names) > _PAIR:
        raise InputError(
            f"MATLAB's stereoParameters are of two cameras, and this rig has {len(names)}. Choose two: "
            f"`only='{','.join(names[:2])}'`."
        )
    structs = [_struct(name, record) for name, record in rig.cameras.items()]
    lost = f"A .mat file does not state the names of the cameras ({', '.join(names)})."
    poses, notes = poses_from_first(rig)
    content: dict[str, Value] = {"cameraParams": structs[0]}
    if len(poses) == _PAIR:
        pair: dict[str, Value] = dict(zip(_CAMERAS, structs, strict=True))
        pair |= {"RotationOfCamera2": poses[1][:3, :3].T, "TranslationOfCamera2": poses[1][:3, 3]}
        content = {"stereoParams": pair}
    return RigTexts((OutputText("", mat_bytes(content, _DESCRIPTION)),), (*notes, lost))


def _struct(name: str, record: CameraRecord) -> dict[str, Value]:
    """Return the struct of one camera."""
    k1, k2, p1, p2, k3 = held_coefficients(name, record, _HELD, _HOLDER)
    K = np.array(record.K)
    K[:2, 2] += _FIRST_PIXEL
    return {
        "IntrinsicMatrix": K.T,
        "RadialDistortion": np.array([k1, k2, k3]),
        "TangentialDistortion": np.array([p1, p2]),
        "ImageSize": np.array([record.size[1], record.size[0]], dtype=np.float64),
    }


def _numbers(fields: Fields, name: str, counts: Sequence[int], path: Path) -> tuple[float, ...]:
    """Return the numbers of a field, row by row."""
    value = fields.get(name)
    if not isinstance(value, np.ndarray):
        raise InputError(f"{path}: {name} should be an array of numbers. {_RECIPE}.")
    return finite_numbers(value.ravel().tolist(), counts, name, path)


def _pose(pair: Fields, path: Path) -> tuple[Pose, tuple[str, ...]]:
    """Return ``T_second_first``, and a note if a rounded rotation was corrected."""
    found = list(_poses(pair, path))
    if not found:
        raise InputError(f"{path} has no RotationOfCamera2 and TranslationOfCamera2. {_RECIPE}.")
    (R, t), *others = found
    if any(not np.allclose(R, R2, atol=1e-9) or not np.allclose(t, t2) for R2, t2 in others):
        raise InputError(f"{path}: RotationOfCamera2 and PoseCamera2 contradict each other.")
    return rounded_pose(R, t, path)


def _poses(pair: Fields, path: Path) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Return rotation and translation as often as a struct states them."""
    if "RotationOfCamera2" in pair:
        R = np.array(_numbers(pair, "RotationOfCamera2", (9,), path)).reshape(3, 3).T
        yield R, np.array(_numbers(pair, "TranslationOfCamera2", (3,), path))
    given = pair.get("PoseCamera2")
    if isinstance(given, Mapping) and "A" in given and "R" not in given:
        affine = np.array(_numbers(given, "A", (16,), path)).reshape(4, 4)
        if not np.array_equal(affine[3], [0.0, 0.0, 0.0, 1.0]):
            raise InputError(f"{path}: the last row of A in PoseCamera2 should be 0 0 0 1.")
        yield affine[:3, :3], affine[:3, 3]
    elif isinstance(given, Mapping):
        R = np.array(_numbers(given, "R", (9,), path)).reshape(3, 3)
        yield R, np.array(_numbers(given, "Translation", (3,), path))


def _camera(fields: Fields, T_cam_world: Pose, given: ReadOptions, path: Path) -> CameraRecord:
    """Return the camera of one struct."""
    matrices: list[tuple[float, ...]] = []
    if {"FocalLength", "PrincipalPoint"} <= set(fields):
        f, c = (_numbers(fields, name, (2,), path) for name in ("FocalLength", "PrincipalPoint"))
        skew = _numbers(fields, "Skew", (1,), path)[0] if "Skew" in fields else 0.0
        matrices.append((f[0], skew, c[0], 0.0, f[1], c[1], 0.0, 0.0, 1.0))
    if "K" in fields:
        matrices.append(_numbers(fields, "K", (9,), path))
    if "IntrinsicMatrix" in fields or not matrices:
        rows = np.array(_numbers(fields, "IntrinsicMatrix", (9,), path)).reshape(3, 3)
        matrices.append(tuple(rows.T.ravel().tolist()))
    if len(set(matrices)) != 1:
        raise InputError(
            f"{path}: K, IntrinsicMatrix and FocalLength with PrincipalPoint contradict each other."
        )
    fx, fy, cx, cy = intrinsics_of(matrices[0], path)
    radial = _numbers(fields, "RadialDistortion", (2, 3), path)
    k1, k2, k3 = (*radial, 0.0)[:3]
    p1, p2 = _numbers(fields, "TangentialDistortion", (2,), path)
    size = known_size(_stated_size(fields, path), given.size, path)
    numbers = (fx, fy, cx - _FIRST_PIXEL, cy - _FIRST_PIXEL)
    return camera_record(numbers, perspective_lens((k1, k2, p1, p2, k3)), T_cam_world, size, path)


def _stated_size(fields: Fields, path: Path) -> list[float] | None:
    """Return width and height of the pictures; None of a struct without them."""
    value = fields.get("ImageSize")
    if value is None or (isinstance(value, np.ndarray) and value.size == 0):
        return None
    height, width = _numbers(fields, "ImageSize", (2,), path)
    return [width, height]


MATLAB = RigFormat(
    "matlab",
    (".mat",),
    Home.FILE,
    2**24,
    recognises,
    read_matlab,
    write_matlab,
    FormatMark(lambda content: content.startswith(_WRITTEN)),
    options=("unit", "size"),
    binary=True,
)
