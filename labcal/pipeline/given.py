"""Arguments of the functions of the chain: objects, or the files of them."""

import os

from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import read_detections
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.pipeline.detection import detect
from labcal.run.progress import Progress
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.targets.catalogue import AnyTarget, target_of
from labcal.targets.places import DotPlaces, is_places, read_places


def shown_by(source: Shoot | AnyTarget | AnyPath) -> Shoot | AnyTarget:
    """Return what dots are of: a shoot, by its folder, too, or a target, by its name, too."""
    if isinstance(source, Shoot):
        return source
    if isinstance(source, str | os.PathLike) and os.fspath(source) and is_shoot(source):
        return open_shoot(source)
    return target_of(source)


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


def dots_of(
    detections: Detections | AnyPath | None, shown: Shoot | AnyTarget | None, progress: Progress | None = None
) -> Detections:
    """Return dots that are given, by the table's path, too, or those of a shoot."""
    if isinstance(detections, Detections):
        return detections
    if detections is not None:
        return read_detections(as_path(detections))
    if isinstance(shown, Shoot):
        return detect(shown, progress=progress)
    raise InputError("No dots are given. Give `detections`, or a shoot, in whose pictures they are found.")
