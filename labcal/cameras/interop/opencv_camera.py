"""One camera of OpenCV's FileStorage: which matrices are its, and which lens its coefficients are."""

import re

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.exchange import ReadOptions
from labcal.cameras.interop.lens_parameters import camera_record, intrinsics_of
from labcal.cameras.interop.numbers_text import picture_size
from labcal.cameras.interop.opencv_lens import lens_of
from labcal.cameras.interop.opencv_names import (
    DIST,
    HEIGHT,
    MATRIX,
    ROTATION,
    SIDES,
    SIZE,
    TRANSLATION,
    TURN,
    WIDTH,
    side_keys,
)
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.interop.placement import rounded_pose
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector

COUNTS = (0, 4, 5, 8, 12, 14)
"""Of coefficients that OpenCV takes."""
_RECTIFIED, _OF_R, _OF_T = ("P", "projection_matrix"), 9, 3
"""Keys beside which R is that of a rectified picture."""
_NUMBER = re.compile(r"\d+")
_OPENPOSE, _AFFINE = ("CameraMatrix",), 12
"""OpenPose calls the pose of a camera so, [R t] in three rows, and its matrix Intrinsics."""
_USUAL = ((MATRIX[0], DIST[0]), ("M1", "D1"), ("M2", "D2"))
"""Names by which a user maps the keys of a camera alone, and of a pair."""


def sides_of(storage: Storage) -> tuple[str, str] | None:
    """Return how a file names the two cameras of a pair; None where it holds none.

    Raises
    ------
    InputError
        There are three, as M1, M2 and M3, or M0, M1 and M2.
    """
    if storage.mapped & {*_USUAL[1], *_USUAL[2]}:
        mapped = next((sides for sides in SIDES if _keys_of(storage, sides)[0]), None)
        return mapped or SIDES[0]
    there = {sides: _keys_of(storage, sides) for sides in SIDES}
    whole = {keys: sides for sides, keys in reversed(there.items()) if all(keys)}
    if len(whole) > 1 or any(_further(storage, keys) for keys in whole):
        raise InputError(
            f"{storage.path} holds more than two cameras. Name those of a pair: `key='M1=KEY,D1=KEY,M2=KEY,"
            f"D2=KEY,R=KEY,T=KEY'`. Its keys are {storage.listed}."
        )
    return next(iter(whole.values()), next((sides for sides in SIDES if there[sides][0]), None))


def _further(storage: Storage, pair: tuple[str, str]) -> bool:
    """Tell whether there is a matrix under one more key, which differs from those of a pair in a number."""
    form = re.compile(_NUMBER.sub(r"\\d+", re.escape(pair[0])))
    others = [key for key in storage.content if key not in pair and form.fullmatch(str(key))]
    return _NUMBER.search(pair[0]) is not None and any(len(storage.numbers(key)) == 9 for key in others)  # noqa: PLR2004 -- 3x3


def _keys_of(storage: Storage, sides: tuple[str, str]) -> tuple[str, str]:
    """Return the keys of two camera matrices; empty where there is none."""
    first, second = (next(iter(storage.there(side_keys(MATRIX, side))), "") for side in sides)
    return first, second


def is_posed(storage: Storage) -> bool:
    """Tell whether a file has R and T."""
    if len(storage.numbers(_OPENPOSE[0])) == _AFFINE:
        return True
    return storage.first((*ROTATION, *TURN)) is not None and storage.first(TRANSLATION) is not None


def require_no_half(storage: Storage) -> None:
    """Raise where one of R and T is lost, by damage or under another name, so that a pose would be left out.

    Raises
    ------
    InputError
        There is a translation without a rotation, or a rotation of no rectified camera without a translation.
    """
    turns, shifts = storage.there((*ROTATION, *TURN)), storage.there(TRANSLATION)
    rectified = storage.first(_RECTIFIED) is not None
    halves = [
        key
        for key in (*turns, *shifts)
        if isinstance(storage.content[key], (dict, type(None))) or len(storage.numbers(key)) in (_OF_R, _OF_T)
    ]
    if halves and not is_posed(storage) and not (turns and rectified):
        raise InputError(
            f"{storage.path} has {halves[0]}, but {'no T' if turns else 'no R'}, and a pose has both. There "
            f"are {storage.listed}. Name them, `key='R=KEY,T=KEY'`, or take {halves[0]} out."
        )


def read_pose(storage: Storage) -> tuple[Pose, tuple[str, ...]]:
    """Return the pose of R, a matrix or a rotation vector, and T; with a note if R was rounded."""
    if len(storage.numbers(_OPENPOSE[0])) == _AFFINE:
        affine = np.array(storage.matrix(_OPENPOSE, (_AFFINE,))).reshape(3, 4)
        return rounded_pose(affine[:, :3], affine[:, 3], storage.path)
    keys = ROTATION if storage.first(ROTATION) is not None else TURN
    turn, t = np.array(storage.matrix(keys, (9, 3))), np.array(storage.matrix(TRANSLATION, (3,)))
    if turn.shape == t.shape:
        return from_rotation_vector(turn, t), ()
    return rounded_pose(turn.reshape(3, 3), t, storage.path)


def read_camera(
    storage: Storage, side: str, number: int, T_cam_world: Pose, given: ReadOptions
) -> CameraRecord:
    """Return a camera.

    Parameters
    ----------
    storage : Storage
    side : str
        What its keys end in, or begin with; empty for the only camera of a file.
    number : int
        1 or 2 of a pair, 0 of the only one.
    T_cam_world : ndarray, shape (4, 4)
        Mm.
    given : ReadOptions

    Raises
    ------
    InputError
        The file has no such camera, it is damaged, or nothing determines its picture size or its lens.
    """
    usual = _USUAL[number]
    matrix, dist = (
        ((name, *keys) if name in storage.mapped else keys)
        for name, keys in zip(usual, (side_keys(MATRIX, side), side_keys(DIST, side)), strict=True)
    )
    for name, keys in zip(usual, (matrix, dist), strict=True):
        if storage.first(keys) is None:
            raise InputError(
                f"{storage.path} has no {name} (a matrix of OpenCV). Its keys are {storage.listed}; name "
                "those of a pair as M1 D1 M2 D2 R T, those of one camera as camera_matrix and "
                f"distortion_coefficients: `key='{name}=KEY'`."
            )
    numbers = intrinsics_of(storage.matrix(matrix, (9,)), storage.path)
    lens = lens_of(storage, side, storage.matrix(dist, COUNTS), given)
    return camera_record(numbers, lens, T_cam_world, _size(storage, side, given), storage.path)


def _size(storage: Storage, side: str, given: ReadOptions) -> tuple[int, int]:
    """Return the size of the pictures, which the file states, of this camera or of all, or a person does."""
    stated = _stated_sizes(storage, side) or _stated_sizes(storage, "")
    if not stated:
        if given.size is not None:
            return picture_size(given.size, storage.path)
        raise InputError(
            f"{storage.path} does not state how large the pictures are. Give it: `size='1280x960'`. Or add "
            "the keys image_width and image_height."
        )
    sizes = {picture_size(one, storage.path) for one in stated}
    if len(sizes) > 1:
        raise InputError(
            f"{storage.path} states several sizes of the pictures, "
            f"{' and '.join(f'{width}x{height}' for width, height in sorted(sizes))}. Leave one in it."
        )
    (size,) = sizes
    if given.size not in (None, size):
        raise InputError(
            f"{storage.path} states a picture size of {size[0]}x{size[1]}, which `size` contradicts. Leave "
            "that out."
        )
    return size


def _stated_sizes(storage: Storage, side: str) -> list[object]:
    """Return the sizes that keys of one camera state, unchecked."""
    width, height = (storage.first(side_keys(keys, side)) for keys in (WIDTH, HEIGHT))
    found: list[object] = [] if width is None and height is None else [[width, height]]
    for key in storage.there(side_keys(SIZE, side)):
        listed = storage.content[key]
        if isinstance(listed, dict):  # a matrix, as of a cv::Size or an array, or width and height
            listed = listed.get("data", [listed.get("width"), listed.get("height")])
        found.append(listed)
    return found
