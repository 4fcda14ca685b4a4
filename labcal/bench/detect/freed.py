"""Residuals of real and rendered pictures, with the print as declared and with free dots.

That two cameras find the same displacements, each alone, is the check that needs no truth.
"""

from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.lens_candidates import DEFAULT_LENS
from labcal.correspond.detections import Detections
from labcal.evaluate.print_shape import agreement
from labcal.report.bench import Check, at_most
from labcal.targets.catalogue import AnyTarget

LENS = "brown-k1k2"
RENDERED_LIMIT_PX = 0.009
FLAT_LIMIT_PX = 0.54
FREED_LIMIT_PX = 0.09
APART_LIMIT = 0.2
"""One minus the correlation."""


def rendered_checks(name: str, detections: Detections, target: AnyTarget) -> list[Check]:
    """Return the reprojection RMS of each camera, calibrated alone with the print as declared.

    Parameters
    ----------
    name : str
        Of the set of pictures.
    detections : Detections
        Of a shoot whose print is perfect.
    target : AnyTarget
    """
    found = calibrate_handheld(detections, target, LENS)
    return [
        at_most(f"{name}: RMS of camera {camera} alone, px", fit.rms_px, RENDERED_LIMIT_PX)
        for camera, fit in found.fits.items()
    ]


def photo_checks(name: str, detections: Detections, target: AnyTarget) -> list[Check]:
    """Return the RMS with declared and with free dots, and the agreement of two cameras on the print.

    Parameters
    ----------
    name : str
        Of the set of pictures.
    detections : Detections
        Of two cameras.
    target : AnyTarget
    """
    flat = calibrate_handheld(detections, target, LENS, HandheldSettings(dot_places="declared"))
    freed = calibrate_handheld(detections, target, LENS, HandheldSettings(dot_places="freed"))
    by_default = calibrate_handheld(detections, target, DEFAULT_LENS)
    checks = []
    for camera, fit in flat.fits.items():
        what = f"{name}: RMS of camera {camera} alone"
        checks += [
            at_most(f"{what}, perfect print, px", fit.rms_px, FLAT_LIMIT_PX),
            at_most(f"{what}, freed dots, px", freed.fits[camera].rms_px, FREED_LIMIT_PX),
            at_most(f"{what}, by default, px", by_default.fits[camera].rms_px, FREED_LIMIT_PX),
        ]
    alone = [fit.freed for fit in freed.fits.values() if fit.freed is not None]
    for axis, correlation in zip("xy", agreement(alone), strict=True):
        what = f"{name}: 1 - correlation of what the cameras find alone, along {axis}"
        checks.append(at_most(what, 1.0 - correlation, APART_LIMIT))
    return checks
