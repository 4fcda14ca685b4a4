"""Keys of OpenCV's files that a user names, and the other one of the two files of OpenCV's stereo sample."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from labcal.cameras.interop.exchange import SourceText
from labcal.cameras.interop.opencv_camera import holds_camera, sides_of
from labcal.cameras.interop.opencv_names import DIST, MATRIX, SIDES, named_so, side_keys
from labcal.cameras.interop.opencv_pose import OF_A_PAIR, ROTATION, is_posed
from labcal.cameras.interop.opencv_storage import Storage, read_storage
from labcal.errors import InputError
from labcal.run.file_reading import read_bytes

ALONE = "camera_matrix"
"""A user who names it means one camera, also in a file of two."""
USUAL = (
    ALONE, "distortion_coefficients", "M1", "D1", "M2", "D2", "R", "T", "image_width", "image_height",
    "image_size",
)  # fmt: skip
"""Keys that can be given another name."""
_TOGETHER = ((ALONE, "distortion_coefficients"), ("M1", "D1"), ("M2", "D2"))
_OF_ONE, _OF_TWO = (ALONE, "distortion_coefficients"), ("M1", "D1", "M2", "D2")
_OF_A_PAIR = {"R", "R1", "R2", "E", "F", "H", "essential_matrix", "fundamental_matrix"}
"""The 3x3 matrices of OpenCV's stereo sample, and of others, that are none of a camera."""
_ENDINGS = {".yml", ".yaml", ".xml"}
_MOST_BYTES, _MOST_FILES = 2**18, 100


def with_given_keys(stores: Sequence[Storage], key: Mapping[str, str] | None) -> list[Storage]:
    """Return files with the keys that a user names under their usual names, too.

    Raises
    ------
    InputError
        A usual name is none, or no file has such a key; those that there are are listed.
    """
    if not key:
        return list(stores)
    there = list(dict.fromkeys(str(one) for storage in stores for one in storage.content))
    for usual, theirs in key.items():
        if usual not in USUAL:
            raise InputError(f"`key` names {', '.join(USUAL)}, but '{usual:.40}' was given.")
        if theirs not in there:
            raise InputError(
                f"`key='{usual}={theirs:.40}'`: there is no such key. {stores[0].path} has "
                f"{', '.join(there)[:300] or 'none'}."
            )
    alone = [usual for usual in key if usual in _OF_ONE]
    paired = [usual for usual in key if usual in _OF_TWO]
    if alone and paired:
        raise InputError(
            f"`key` names {alone[0]}, of one camera, and {paired[0]}, of a pair. Name the keys of one "
            "camera, or those of a pair."
        )
    return [_renamed(storage, key) for storage in stores]


def _renamed(storage: Storage, key: Mapping[str, str]) -> Storage:
    """Return a file with further names for its keys."""
    more = {usual: storage.content[theirs] for usual, theirs in key.items() if theirs in storage.content}
    for matrix, coefficients in _TOGETHER:
        beside = _coefficients_beside(storage, key[matrix]) if matrix in more else None
        if beside is not None and coefficients not in key:
            more[coefficients] = storage.content[beside]
    return replace(storage, content={**storage.content, **more}, mapped=frozenset(more))


def _coefficients_beside(storage: Storage, matrix: str) -> str | None:
    """Return the key of the coefficients that end, or begin, as that of a camera matrix does: distCoeffsL."""
    for sides in SIDES:
        for side in sides:
            found = (
                storage.there(side_keys(DIST, side)) if named_so(side_keys(MATRIX, side), [matrix]) else []
            )
            if found:
                return found[0]
    return None


def with_other_half(stores: Sequence[Storage]) -> tuple[list[Storage], tuple[str, ...]]:
    """Return one file of a pair's intrinsics, or of its extrinsics, together with the other one.

    OpenCV's stereo sample writes ``intrinsics.yml`` and ``extrinsics.yml``; the other one is looked for
    beside the one that is given, by its content. A note says that it was found.

    Raises
    ------
    InputError
        Several files beside it could be the other half.
    """
    if len(stores) != 1:
        return list(stores), ()
    (given,) = stores
    has_cameras, has_pose = sides_of(given) is not None, is_posed(given, OF_A_PAIR)
    if has_cameras == has_pose or (has_pose and holds_camera(given)) or _has_strange_matrix(given):
        return list(stores), ()
    found = [other for other in _beside(given.path) if _is_half(other, of_cameras=has_pose)]
    if not found:
        return list(stores), ()
    if len(found) > 1:
        raise InputError(
            f"{given.path} is one of two files, and the other one could be "
            f"{' or '.join(other.path.name for other in found)[:200]}. Give both files that belong together."
        )
    what = "R and T" if has_cameras else "the cameras"
    return [given, found[0]], (f"{what} are read from {found[0].path}, which lies beside {given.path.name}.",)


def _is_half(storage: Storage, *, of_cameras: bool) -> bool:
    """Tell whether a file that nobody named holds the cameras of a pair and no pose, or only the pose."""
    try:
        has_cameras = sides_of(storage) is not None
    except InputError:  # of more than two cameras
        return False
    if has_cameras != of_cameras or is_posed(storage, OF_A_PAIR) == of_cameras:
        return False
    return not holds_camera(storage) and not _has_strange_matrix(storage)


def _has_strange_matrix(storage: Storage) -> bool:
    """Tell whether a file holds 3x3 matrices that are none of OpenCV's samples, so maybe those of cameras."""
    cameras = tuple(key for sides in SIDES for side in sides for key in side_keys(MATRIX, side))
    known = {*_OF_A_PAIR, *named_so((*ROTATION, *cameras), storage.content)}
    strange = [storage.numbers(key) for key in storage.content if key not in known]
    return any(len(one) == 9 for one in strange)  # noqa: PLR2004 -- 3x3


def _beside(path: Path) -> list[Storage]:
    """Return the other files of OpenCV in the folder of one."""
    found: list[Storage] = []
    if not path.parent.is_dir():
        return found
    entries = sorted(one for one in path.parent.iterdir() if one.suffix.lower() in _ENDINGS)
    for entry in entries[:_MOST_FILES]:
        if entry == path or not entry.is_file() or entry.stat().st_size > _MOST_BYTES:
            continue
        try:
            data = read_bytes(entry, "file", _MOST_BYTES)
            found.append(read_storage(SourceText(entry, data.decode("utf-8", "replace"), data)))
        except InputError:
            continue
    return found
