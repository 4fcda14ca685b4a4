"""Cameras that are calibrated alone, each from all its views: the first part of a calibration of a rig."""

from dataclasses import dataclass, replace

from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.lens_start import require_adjustable
from labcal.calibrate.single_calibration import HandheldSettings, SingleCalibration, calibrate_single
from labcal.calibrate.usable_dots import in_full_pictures, unmeasured_pictures, usable_dots
from labcal.cameras.lens import lens_by_name
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget
from labcal.wording import counted


@dataclass(frozen=True)
class PreparedDots:
    """The dots that enter a calibration."""

    cameras: tuple[str, ...]
    entering: Detections
    left_out: tuple[str, ...]
    """Pictures that do not enter, and why, for people."""


@dataclass(frozen=True)
class PreparedCameras:
    """The cameras of a rig, each calibrated alone with the dots as declared."""

    alone: list[SingleCalibration]
    dots: PreparedDots
    lens: str


def prepared_dots(detections: Detections, target: AnyTarget, settings: HandheldSettings) -> PreparedDots:
    """Return the dots that enter a calibration.

    Raises
    ------
    InputError
        A dot is not on the target, has no position or is listed twice, or a camera has none that is measured.
    """
    usable = settings.measured(usable_dots(detections, target), target)
    cameras = _require_all(usable, detections)
    entering, skipped = in_full_pictures(usable)
    return PreparedDots(cameras, entering, (*unmeasured_pictures(detections), *skipped))


def prepared_cameras(
    dots: PreparedDots, target: AnyTarget, lens: str, settings: HandheldSettings
) -> PreparedCameras:
    """Calibrate each camera alone with the dots as declared.

    Raises
    ------
    UnknownNameError
        There is no such lens model here.
    InputError
        A camera has too few views, or its dots determine no camera.
    """
    require_adjustable(lens)
    if settings.dot_places is DotTreatment.FREED and lens_by_name(lens).parallel:
        raise InputError(
            f"Dots cannot be freed behind the lens '{lens}', whose rays are parallel: an uneven print and a "
            "tilt are not distinguishable there. Keep them as declared: `dot_places='declared'`."
        )
    as_declared = replace(settings, dot_places=DotTreatment.DECLARED)
    alone = [calibrate_single(name, dots.entering, target, lens, as_declared) for name in dots.cameras]
    return PreparedCameras(alone, dots, lens)


def _require_all(usable: Detections, detections: Detections) -> tuple[str, ...]:
    """Return the cameras; raise where one has pictures, but no dot that is a measurement.

    Their order is that of all lines: what the first picture shows does not change the world.
    """
    for name in detections.cameras:
        if name not in usable.cameras:
            views = len(set(detections.view[detections.camera == name].tolist()))
            raise InputError(
                f"Camera '{name}' has {counted(views, 'view')}, but not one dot with an id that is measured. "
                "See the flags in the detections; take its pictures anew, or leave them out."
            )
    return detections.cameras
