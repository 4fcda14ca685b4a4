"""One camera of OpenCV's FileStorage: which matrices are its, and which lens its coefficients are."""

import re

from labcal.arrays import Pose
from labcal.cameras.interop.exchange import ReadOptions
from labcal.cameras.interop.lens_parameters import camera_record, intrinsics_of
from labcal.cameras.interop.numbers_text import picture_size, same_sides
from labcal.cameras.interop.opencv_lens import lens_of
from labcal.cameras.interop.opencv_names import (
    DIST,
    HEIGHT,
    MATRIX,
    SIDES,
    SIZE,
    WIDTH,
    side_keys,
)
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError

COUNTS = (0, 4, 5, 8, 12, 14)
"""Of coefficients that OpenCV takes."""
_NUMBER = re.compile(r"\d+")
_OF_A_MATRIX = 9
"""Numbers of a camera matrix."""
_USUAL = ((MATRIX[0], DIST[0]), ("M1", "D1"), ("M2", "D2"))
"""Names by which a user maps the keys of a camera alone, and of a pair."""


def sides_of(storage: Storage) -> tuple[str, str] | None:
    """Return how a file names the two cameras of a pair; None where it does not hold both.

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
    return next(iter(whole.values()), None)


def half_sides(storage: Storage) -> list[tuple[tuple[str, str], int]]:
    """Return how a file may name the only camera in it, which is one of a pair, and whether first or second.

    Returns
    -------
    list of ((str, str), int)
        Sides, and 0 or 1 of them: ``M1`` may be the first one of 1 and 2, or the second one of 0 and 1. Empty
        where there is a camera that is none of a pair, or both, or none.
    """
    if storage.first(MATRIX) is not None or storage.mapped & {*_USUAL[0], *_USUAL[1], *_USUAL[2]}:
        return []
    there = {sides: _keys_of(storage, sides) for sides in SIDES}
    if len({key for keys in there.values() for key in keys if key}) != 1:
        return []
    return [(sides, number) for sides, keys in there.items() for number in (0, 1) if keys[number]]


def holds_camera(storage: Storage) -> bool:
    """Tell whether a file holds one camera, under keys of a camera alone or of one of a pair."""
    return storage.first(MATRIX) is not None or bool(half_sides(storage))


def half_key(storage: Storage) -> str:
    """Return the key of the camera matrix of the only camera in a file, which is one of a pair."""
    sides, number = half_sides(storage)[0]
    return _keys_of(storage, sides)[number]


def _further(storage: Storage, pair: tuple[str, str]) -> bool:
    """Tell whether there is a matrix under one more key, which differs from those of a pair in a number."""
    form = re.compile(_NUMBER.sub(r"\\d+", re.escape(pair[0])))
    others = [key for key in storage.content if key not in pair and form.fullmatch(str(key))]
    return _NUMBER.search(pair[0]) is not None and any(
        len(storage.numbers(key)) == _OF_A_MATRIX for key in others
    )


def _keys_of(storage: Storage, sides: tuple[str, str]) -> tuple[str, str]:
    """Return the keys of two camera matrices; empty where there is none."""
    first, second = (next(iter(storage.there(side_keys(MATRIX, side))), "") for side in sides)
    return first, second


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
    if given.size is not None and not same_sides(given.size, size):
        raise InputError(
            f"{storage.path} states a picture size of {size[0]}x{size[1]}, which `size` contradicts. Leave "
            "that out."
        )
    return given.size or size


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
