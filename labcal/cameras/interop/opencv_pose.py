"""The pose in a file of OpenCV: R, a matrix or a rotation vector, and T, under whichever names."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.interop.placement import rounded_pose
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector

ROTATION = ("R", "rotation_matrix", "rotation", "Rot", "rotmat", "stereo_R")
_OPENPOSE = "CameraMatrix"
"""OpenPose calls the pose of a camera so, [R t] in three rows, and its matrix Intrinsics."""
_WHOLE = ("RT", "Rt", "rt", "R_T", "stereo_RT")
"""Of [R t], 3x4, or 4x4 with a last row of 0 0 0 1."""
_THREE_ROWS, _FOUR_ROWS = 12, 16
_OMNIDIR = {"xi_1", "xi_2", "rvec", "tvec"}
"""Keys of a pair of cv2.omnidir's sample, whose rvec and tvec are those of the second camera."""
_RECTIFIED, _OF_R, _OF_T = ("P", "projection_matrix"), 9, 3
"""Keys beside which R is that of a rectified picture."""


@dataclass(frozen=True)
class PoseNames:
    """Names of the parts of a pose."""

    rotation: tuple[str, ...]
    turn: tuple[str, ...]
    """Of rotation vectors, where there is no matrix."""
    translation: tuple[str, ...]


TRANSLATION = ("T", "translation_vector", "translation_matrix", "translation", "Trans", "stereo_T")
OF_A_PAIR = PoseNames(ROTATION, ("rotation_vector", "om"), TRANSLATION)
"""The pose of the second camera; ``rvec`` and ``tvec`` beside a pair are those of a board."""
OF_A_CAMERA = PoseNames(ROTATION, ("rvec", "rotation_vector", "om"), (*TRANSLATION, "tvec"))


def is_posed(storage: Storage, names: PoseNames) -> bool:
    """Tell whether a file has R and T, or both in one matrix."""
    if _whole_key(storage, names) is not None:
        return True
    names = _names_in(storage, names)
    turned = storage.first((*names.rotation, *names.turn)) is not None
    return turned and storage.first(names.translation) is not None


def is_pose_named(storage: Storage) -> bool:
    """Tell whether a user names the keys of a pose: those of R and T, or that of a matrix of both."""
    return {"R", "T"} <= storage.mapped or ("R" in storage.mapped and _is_whole(storage, "R"))


def _whole_key(storage: Storage, names: PoseNames) -> str | None:
    """Return the key of R and T in one matrix; None where they are apart, or a user names them so."""
    if storage.mapped & {"R", "T"}:
        return "R" if "R" in storage.mapped and _is_whole(storage, "R") else None
    if len(storage.numbers(_OPENPOSE)) == _THREE_ROWS:
        return _OPENPOSE
    names = _names_in(storage, names)
    parted = storage.there((*names.rotation, *names.turn, *names.translation))
    return None if parted else next((key for key in _WHOLE if _is_whole(storage, key)), None)


def _is_whole(storage: Storage, key: str) -> bool:
    return len(storage.numbers(key)) in {_THREE_ROWS, _FOUR_ROWS}


def _names_in(storage: Storage, names: PoseNames) -> PoseNames:
    """Return the names of a pose in a file: those of a camera also for a pair of cv2.omnidir."""
    return OF_A_CAMERA if set(storage.content) >= _OMNIDIR else names


def whole_pose(storage: Storage, key: str) -> tuple[Pose, tuple[str, ...]]:
    """Return the pose of [R t], 3x4 or 4x4, and a note if R was rounded.

    Raises
    ------
    InputError
        It is no such matrix.
    """
    numbers = storage.matrix((key,), (_THREE_ROWS, _FOUR_ROWS))
    rows = np.array(numbers).reshape(-1, 4)
    if storage.row_count(key) not in {None, len(rows)}:
        raise InputError(f"{storage.path}: {key} should have rows of 4 numbers, [R t].")
    if len(rows) > 3 and not np.array_equal(rows[3], [0.0, 0.0, 0.0, 1.0]):  # noqa: PLR2004 -- of R and t
        raise InputError(f"{storage.path}: the last row of {key} should be 0 0 0 1.")
    return rounded_pose(rows[:3, :3], rows[:3, 3], storage.path)


def read_pose(storage: Storage, names: PoseNames) -> tuple[Pose, tuple[str, ...]]:
    """Return the pose of R, a matrix or a rotation vector, and T, or of both in one matrix.

    Returns
    -------
    ndarray, shape (4, 4)
        In the unit of the file.
    tuple of str
        A note if R was rounded.

    Raises
    ------
    InputError
        They are damaged, or two keys of one of them differ.
    """
    whole = _whole_key(storage, names)
    if whole is not None:
        if "T" in storage.mapped and storage.content["T"] != storage.content[whole]:
            raise InputError(f"{storage.path}: the key of R holds T, too, so that `key` should not name T.")
        return whole_pose(storage, whole)
    names = _names_in(storage, names)
    keys = names.rotation if storage.first(names.rotation) is not None else names.turn
    turn = np.array(storage.matrix(keys, (_OF_R, _OF_T)))
    t = np.array(storage.matrix(names.translation, (_OF_T,)))
    if turn.shape == t.shape:
        return from_rotation_vector(turn, t), ()
    return rounded_pose(turn.reshape(3, 3), t, storage.path)


def require_no_half(storage: Storage) -> None:
    """Raise where one of R and T is lost, by damage or under another name, so that a pose would be left out.

    Raises
    ------
    InputError
        There is a translation without a rotation, or a rotation of no rectified camera without a translation.
    """
    names = OF_A_CAMERA
    turns, shifts = storage.there((*names.rotation, *names.turn)), storage.there(names.translation)
    rectified = storage.first(_RECTIFIED) is not None
    halves = [
        key
        for key in (*turns, *shifts)
        if isinstance(storage.content[key], (dict, type(None))) or len(storage.numbers(key)) in (_OF_R, _OF_T)
    ]
    if halves and not is_posed(storage, names) and not (turns and rectified):
        raise InputError(
            f"{storage.path} has {halves[0]}, but {'no T' if turns else 'no R'}, and a pose has both. There "
            f"are {storage.listed}. Name them, `key='R=KEY,T=KEY'`, or take {halves[0]} out."
        )
