"""The pose in a file of OpenCV: R, a matrix or a rotation vector, and T, under whichever names."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.interop.placement import rounded_pose
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector

ROTATION = ("R", "rotation_matrix", "rotation", "Rot", "rotmat", "stereo_R")
_OPENPOSE, _AFFINE = ("CameraMatrix",), 12
"""OpenPose calls the pose of a camera so, [R t] in three rows, and its matrix Intrinsics."""
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
    """Tell whether a file has R and T."""
    if len(storage.numbers(_OPENPOSE[0])) == _AFFINE:
        return True
    turned = storage.first((*names.rotation, *names.turn)) is not None
    return turned and storage.first(names.translation) is not None


def read_pose(storage: Storage, names: PoseNames) -> tuple[Pose, tuple[str, ...]]:
    """Return the pose of R, a matrix or a rotation vector, and T; with a note if R was rounded.

    Raises
    ------
    InputError
        They are damaged, or two keys of one of them differ.
    """
    if len(storage.numbers(_OPENPOSE[0])) == _AFFINE:
        affine = np.array(storage.matrix(_OPENPOSE, (_AFFINE,))).reshape(3, 4)
        return rounded_pose(affine[:, :3], affine[:, 3], storage.path)
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
