"""The places of dots on a print that a calibration measured: given, or found beside the rig's file."""

import os

from labcal.cameras.rig import Rig
from labcal.paths import AnyPath, as_path
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces, is_places, read_places


def dots_beside(rig: Rig | AnyPath, target: AnyTarget) -> AnyTarget | DotPlaces:
    """Return the dots of the print that the rig was calibrated with, where their file is beside the rig's."""
    if isinstance(rig, Rig):
        return target
    path = as_path(rig)
    beside = path.with_name(f"{path.stem}-dots.json")
    if not (beside.is_file() and is_places(beside)):
        return target
    places = read_places(beside)
    return places if places.target == target else target


def given_places(target: AnyTarget | DotPlaces | AnyPath | None) -> AnyTarget | DotPlaces | AnyPath | None:
    """Return the dots of a print where their file is given; else what is given."""
    if isinstance(target, str | os.PathLike) and os.fspath(target) and is_places(target):
        return read_places(target)
    return target
