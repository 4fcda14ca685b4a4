"""Pairs of cameras in files of OpenCV: in one, in two (intrinsics, extrinsics), or in three."""

from collections.abc import Sequence

import numpy as np

from labcal.cameras.interop.exchange import ReadOptions, ReadRig
from labcal.cameras.interop.opencv_camera import half_key, half_sides, holds_camera, read_camera, sides_of
from labcal.cameras.interop.opencv_keys import ALONE
from labcal.cameras.interop.opencv_names import SIDES
from labcal.cameras.interop.opencv_pose import OF_A_PAIR, is_posed, read_pose
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.interop.placement import rig_of
from labcal.errors import InputError

_PAIR = 2


def name_of(storage: Storage) -> str:
    """Return what a file calls its only camera, or the name of the file."""
    return storage.text("camera_name") or storage.path.stem


def read_placed(stores: Sequence[Storage], given: ReadOptions) -> ReadRig | None:
    """Return the pair of two files of one camera each and a third one with R and T; None of other files.

    The keys of a pair (M1 in one file, M2 in the other one) tell which camera is the first one; where the
    keys are those of cameras alone, the order of the files does.
    """
    cameras = [storage for storage in stores if holds_camera(storage) and not is_posed(storage, OF_A_PAIR)]
    placing = [storage for storage in stores if not holds_camera(storage) and is_posed(storage, OF_A_PAIR)]
    if len(stores) != _PAIR + 1 or (len(cameras), len(placing)) != (_PAIR, 1):
        return None
    T_second_first, notes = read_pose(placing[0], OF_A_PAIR)
    cameras, sides = _in_order(*cameras)
    records = [
        read_camera(storage, side, 0, T, given)
        for storage, side, T in zip(cameras, sides, (np.eye(4), T_second_first), strict=True)
    ]
    first, second = (storage.path.name for storage in cameras)
    note = f"R and T of {placing[0].path.name} are taken to map coordinates of {first} to those of {second}."
    return ReadRig(rig_of([name_of(storage) for storage in cameras], records), (note, *notes))


def _in_order(one: Storage, other: Storage) -> tuple[list[Storage], list[str]]:
    """Return files of one camera each, that of the first camera first, and the sides of their keys."""
    found, others = half_sides(one), half_sides(other)
    for sides, number in found:
        if (sides, 1 - number) in others:
            return [one, other] if number == 0 else [other, one], list(sides)
    return [one, other], [half[0][0][half[0][1]] if half else "" for half in (found, others)]


def require_whole(storage: Storage) -> None:
    """Raise where a file holds one of the two cameras of a pair, or only R and T.

    Raises
    ------
    InputError
        It does.
    """
    together = "labcal convert left.yml right.yml stereo.yml rig.json"
    if half_sides(storage):
        key = half_key(storage)
        raise InputError(
            f"{storage.path} holds one camera of a pair, {key}, and not the other one. Give the files of "
            f"both cameras and that of R and T: {together}. Or read it alone, `key='{ALONE}={key}'`, or name "
            f"the keys of both, `key='M1=KEY,D1=KEY,M2=KEY,D2=KEY'`: there are {storage.listed}."
        )
    if not holds_camera(storage) and is_posed(storage, OF_A_PAIR) and not storage.mapped:
        raise InputError(
            f"{storage.path} holds R and T, but no camera. Give it together with the files of both cameras: "
            f"{together}. Or name the keys of its cameras, `key='M1=KEY,D1=KEY,M2=KEY,D2=KEY'`: there are "
            f"{storage.listed}."
        )


def read_pair(storage: Storage, others: Sequence[Storage], given: ReadOptions) -> ReadRig:
    """Return the rig of a stereo file; R and T may be in another one, as OpenCV's stereo sample has it."""
    placing = [one for one in (storage, *others) if is_posed(one, OF_A_PAIR)]
    further = [one.path.name for one in others if one not in placing]
    if len(placing) != 1 or further:
        what = (
            "several poses R, T of the second one are given" if placing else "no pose R, T of the second one"
        )
        if placing and further:
            what = (
                f"is given with {', '.join(further)[:200]}, which hold{'s' * (len(further) == 1)} no R and T"
            )
        raise InputError(
            f"{storage.path} holds two cameras, but {what}. Give it together with the one file that has it: "
            "labcal convert intrinsics.yml extrinsics.yml rig.json. Or name its keys, `key='R=KEY,T=KEY'`, "
            f"or `key='R=KEY'` of a matrix [R T]: there are {storage.listed}."
        )
    T_right_left, notes = read_pose(placing[0], OF_A_PAIR)
    sides = sides_of(storage) or SIDES[0]
    records = [
        read_camera(storage, side, number, T, given)
        for number, (side, T) in enumerate(zip(sides, (np.eye(4), T_right_left), strict=True), start=1)
    ]
    names = [storage.text("camera_name1") or "left", storage.text("camera_name2") or "right"]
    return ReadRig(rig_of(names, records), notes)
