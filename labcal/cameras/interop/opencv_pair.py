"""Pairs of cameras in files of OpenCV: in one, in two (intrinsics, extrinsics), or in three."""

from collections.abc import Sequence

import numpy as np

from labcal.cameras.interop.exchange import ReadOptions, ReadRig
from labcal.cameras.interop.opencv_camera import read_camera, sides_of
from labcal.cameras.interop.opencv_names import MATRIX, SIDES
from labcal.cameras.interop.opencv_pose import OF_A_PAIR, is_posed, read_pose
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.interop.placement import rig_of
from labcal.errors import InputError

_PAIR = 2


def name_of(storage: Storage) -> str:
    """Return what a file calls its only camera, or the name of the file."""
    return storage.text("camera_name") or storage.path.stem


def read_placed(stores: Sequence[Storage], given: ReadOptions) -> ReadRig | None:
    """Return the pair of two files of one camera each and a third one with R and T; None of other files."""
    cameras = [
        storage
        for storage in stores
        if storage.first(MATRIX) is not None and not is_posed(storage, OF_A_PAIR)
    ]
    placing = [
        storage for storage in stores if storage.first(MATRIX) is None and is_posed(storage, OF_A_PAIR)
    ]
    if len(stores) != _PAIR + 1 or (len(cameras), len(placing)) != (_PAIR, 1):
        return None
    T_second_first, notes = read_pose(placing[0], OF_A_PAIR)
    records = [
        read_camera(storage, "", 0, T, given)
        for storage, T in zip(cameras, (np.eye(4), T_second_first), strict=True)
    ]
    first, second = (storage.path.name for storage in cameras)
    note = f"R and T of {placing[0].path.name} are taken to map coordinates of {first} to those of {second}."
    return ReadRig(rig_of([name_of(storage) for storage in cameras], records), (note, *notes))


def read_pair(storage: Storage, others: Sequence[Storage], given: ReadOptions) -> ReadRig:
    """Return the rig of a stereo file; R and T may be in another one, as OpenCV's stereo sample has it."""
    placing = [one for one in (storage, *others) if is_posed(one, OF_A_PAIR)]
    if len(placing) != 1 or len(others) > 1 or (others and placing != list(others)):
        raise InputError(
            f"{storage.path} holds two cameras, but {'several poses' if placing else 'no pose'} R, T of the "
            "second one. Give it together with the one file that has it: labcal convert "
            "intrinsics.yml extrinsics.yml rig.json. Or name its keys, `key='R=KEY,T=KEY'`: there are "
            f"{storage.listed}."
        )
    T_right_left, notes = read_pose(placing[0], OF_A_PAIR)
    sides = sides_of(storage) or SIDES[0]
    records = [
        read_camera(storage, side, number, T, given)
        for number, (side, T) in enumerate(zip(sides, (np.eye(4), T_right_left), strict=True), start=1)
    ]
    names = [storage.text("camera_name1") or "left", storage.text("camera_name2") or "right"]
    return ReadRig(rig_of(names, records), notes)
