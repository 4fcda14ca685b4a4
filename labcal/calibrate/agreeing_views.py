"""Calibration from consistent pictures: a few inconsistent ones are left out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from labcal.calibrate.agreement.hypotheses import MOST_INCONSISTENT
from labcal.calibrate.agreement.slight import slight_contradictions
from labcal.calibrate.single_calibration import SingleCalibration
from labcal.calibrate.view_agreement import InconsistentPicture, contradictions, seen_from_behind
from labcal.correspond.detections import Detections
from labcal.targets.catalogue import AnyTarget

CalibrateSingle = Callable[[str, Detections], SingleCalibration]
"""Calibrates one camera, by its name, from all its pictures."""


@dataclass(frozen=True)
class SingleCameras:
    """Single-camera calibrations, and their pictures."""

    cameras: list[SingleCalibration]
    entering: Detections
    left_out: tuple[str, ...]
    """Pictures that are not among it, and why, for people."""

    def without(self, inconsistent: Sequence[InconsistentPicture], again: CalibrateSingle) -> "SingleCameras":
        """Leave out pictures, and repeat the calibrations of their cameras."""
        enters, reasons = np.full(len(self.entering), fill_value=True), []
        for picture in inconsistent:
            view = self.entering.views[picture.view]
            enters &= ~((self.entering.view == view) & (self.entering.camera == picture.camera))
            reasons.append(f"view '{view}' of camera '{picture.camera}': {picture.reason}")
        entering, touched = self.entering.where(enters), {picture.camera for picture in inconsistent}
        cameras = [
            again(camera.name, entering) if camera.name in touched else camera.among(entering.views)
            for camera in self.cameras
        ]
        return SingleCameras(cameras, entering, (*self.left_out, *reasons))

    def too_many(self, inconsistent: Sequence[InconsistentPicture], before: "SingleCameras") -> bool:
        """Tell whether so many pictures of a camera are inconsistent that none is an exception."""
        for camera in self.cameras:
            all_ = next(len(one.dots.views) for one in before.cameras if one.name == camera.name)
            out = all_ - len(camera.dots.views) + sum(one.camera == camera.name for one in inconsistent)
            if out > max(1, int(MOST_INCONSISTENT * all_)):
                return True
        return False


def of_agreeing_views(
    found: SingleCameras, target: AnyTarget, again: CalibrateSingle, *, free_dots: bool
) -> SingleCameras:
    """Leave out inconsistent pictures.

    Those that show the target's back; and those of a few views in which cameras contradict each other. Where
    these are more than one, and more than a fifth of a camera's pictures, all of them stay: nothing says
    which are right, and :func:`~labcal.calibrate.agreement.causes.disagreement` says what may have happened.

    Parameters
    ----------
    found : SingleCameras
    target : AnyTarget
    again : callable
        Calibrates a camera from the pictures that are left.
    free_dots : bool
        Whether each camera found a print of its own: such cameras agree too little for slight contradictions.

    Raises
    ------
    InputError
        A camera sees the target's back in all its pictures, has too few others, or shares none with the rest.
    """
    while mirrored := list(chain.from_iterable(seen_from_behind(one.single) for one in found.cameras)):
        found = found.without(mirrored, again)
    rest = found
    while inconsistent := _contradictions(rest.cameras, target, free_dots=free_dots):
        if rest.too_many(inconsistent, found):
            return found
        rest = rest.without(inconsistent, again)
    return rest


def _contradictions(
    cameras: list[SingleCalibration], target: AnyTarget, *, free_dots: bool
) -> list[InconsistentPicture]:
    """Return the pictures of views in which cameras contradict each other."""
    if len(cameras) == 1 or any(one.single.camera.model.parallel for one in cameras):
        return []  # parallel rays alone tell neither depth nor the sign of a tilt
    gross = contradictions([one.single for one in cameras], target.points())
    return gross if gross or free_dots else slight_contradictions(cameras)
