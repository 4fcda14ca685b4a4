"""Evidence for the rules, from a calibration."""

from itertools import combinations

import numpy as np

from labcal.calibrate.calibration import Calibration
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.correspond.coverage import coverage_of
from labcal.evaluate.verdict.of_calibration import CalibrationEvidence
from labcal.evaluate.working_distance import working_distance
from labcal.geometry.poses import transform
from labcal.optim.stopping import StopReason
from labcal.targets.catalogue import AnyTarget

_PAIR = 2
_MOST_PLACES = 1500
"""For the error by the cameras' uncertainty: more add nothing."""
_UNFINISHED = (StopReason.EPOCHS, StopReason.NOT_FINITE)


def calibration_evidence(made: Calibration, target: AnyTarget) -> CalibrationEvidence:
    """Return the evidence of a calibration from dots of a target."""
    found = made.found
    cameras = [found.rig.camera(name) for name in found.rig.cameras]
    fits = found.fits
    noise = [float(np.hypot(fit.noise_px, _scatter_px(found, name))) for name, fit in fits.items()]
    names = list(found.rig.cameras)
    places = target_places(found, target)
    return CalibrationEvidence(
        at=working_distance(cameras, places, noise),
        calibration_mm=_calibration_mm(found, places),
        noise_px=float(np.median([fit.noise_px for fit in fits.values()])),
        scatter_px=max(_scatter_px(found, name) for name in names),
        rms_px=found.rms_px,
        views=len(found.views),
        held_out=len(made.held_out),
        outliers=float(found.residuals.outlier.mean()),
        coverage=min(_coverage(found, number) for number in range(len(names))),
        causes=()
        if found.disagreement is None
        else tuple(one.cause.value for one in found.disagreement.causes),
        two_lenses=tuple(name for name, fit in fits.items() if fit.two_lenses is not None),
        open_lens=tuple(name for name, fit in fits.items() if fit.open_lens),
        uneven=() if found.freed is not None else tuple(name for name, fit in fits.items() if fit.uneven),
        undetermined=tuple(name for name, fit in fits.items() if fit.undetermined),
        finished=found.reason not in _UNFINISHED,
        freed=found.freed is not None,
        parallel=any(camera.model.parallel for camera in cameras),
        baseline_mm=max((found.rig.baseline_mm(*pair) for pair in combinations(names, 2)), default=0.0),
    )


def target_places(found: HandheldCalibration, target: AnyTarget) -> np.ndarray:
    """Return where all dots of the target were in all views, in the world, shape (n, 3), mm."""
    places = target.points() if found.freed is None else found.freed.place
    return np.concatenate([transform(T, places) for T in found.T_world_target])


def _calibration_mm(found: HandheldCalibration, places: np.ndarray) -> float:
    """Return the RMS error of points by the uncertainty of the cameras; NaN of one camera."""
    cameras = [found.rig.camera(name) for name in found.rig.cameras]
    if len(cameras) < _PAIR:
        return float("nan")
    seen = np.all([camera.in_picture(camera.project(places).q) for camera in cameras], axis=0)
    places = places[seen]
    return found.covariance.rms_mm(cameras, places[:: -(-len(places) // _MOST_PLACES) or 1])


def _scatter_px(found: HandheldCalibration, name: str) -> float:
    """Return what dots of a camera scatter along each axis beyond their covariances: in the rig, if known."""
    record = found.rig.calibration
    if record is None or record.scatter_px is None:
        return found.fits[name].scatter_px
    return record.scatter_px


def _coverage(found: HandheldCalibration, number: int) -> float:
    """Return the share of a camera's picture with dots."""
    residuals = found.residuals
    mine = (residuals.camera == number) & ~residuals.outlier
    size = list(found.rig.cameras.values())[number].size
    return float((coverage_of(residuals.q[mine], size) > 0).mean())
