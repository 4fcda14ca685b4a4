"""Arguments of the functions of the chain: objects, or the files of them."""

import os

from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import read_detections
from labcal.correspond.picture_set import open_pictures
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.pipeline.detection import detect
from labcal.run.progress import Progress
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.targets.catalogue import AnyTarget, AnyTargets, target_of


def shown_by(source: Shoot | AnyTargets) -> Shoot | AnyTarget:
    """Return what dots are of: a shoot, by its folder, too, or a target, by its name, too."""
    if isinstance(source, Shoot):
        return _with_target(source)
    if isinstance(source, str | os.PathLike) and os.fspath(source) and is_shoot(source):
        return _with_target(open_shoot(source))
    return target_of(source)


def _with_target(shoot: Shoot) -> Shoot:
    """Return a shoot with the target that the code of a print tells, where it states none."""
    return shoot if shoot.manifest.target is not None else shoot.showing(open_pictures(shoot).target())


def dots_of(
    detections: Detections | AnyPath | None, shown: Shoot | AnyTarget | None, progress: Progress | None = None
) -> Detections:
    """Return dots that are given, by the table's path, too, or those of a shoot.

    Of a shoot, cameras come in the order of its manifest, also where the first picture of one is refused.
    """
    if isinstance(detections, Detections):
        dots = detections
    elif detections is not None:
        dots = read_detections(as_path(detections))
    elif isinstance(shown, Shoot):
        dots = detect(shown, progress=progress)
    else:
        raise InputError(
            "No dots are given. Give `detections`, or a shoot, in whose pictures they are found."
        )
    return dots.with_cameras_in_order(list(shown.manifest.cameras)) if isinstance(shown, Shoot) else dots
