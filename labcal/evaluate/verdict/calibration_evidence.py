"""Evidence for the rules, from a calibration."""

from itertools import combinations

import numpy as np

from labcal.calibrate.calibration import Calibration
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.correspond.coverage import coverage_of
from labcal.evaluate.verdict.of_calibration import CalibrationEvidence
from labcal.evaluate.working_distance import working_distance
from labcal.optim.stopping import StopReason

_PAIR = 2
_MOST_PLACES = 1500
"""For the error by the cameras' uncertainty: more add nothing."""
_UNFINISHED = (StopReason.EPOCHS, StopReason.NOT_FINITE)


def calibration_evidence(made: Calibration) -> CalibrationEvidence:
    """Return the evidence of a calibration."""
    found = made.found
    cameras = [found.rig.camera(name) for name in found.rig.cameras]
    fits = found.fits
    names, places, views = list(found.rig.cameras), found.places, found.sources.views
    return CalibrationEvidence(
        at=working_distance(cameras, places, found.pixel_sigma_px),
        calibration_mm=_calibration_mm(found, places),
        noise_px=float(np.median([fit.noise_px for fit in fits.values()])),
        scatter_px=max(found.scatter_px(name) for name in names),
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
        freed=found.freed is not None or found.measured_print,
        parallel=any(camera.model.parallel for camera in cameras),
        baseline_mm=max((found.rig.baseline_mm(*pair) for pair in combinations(names, 2)), default=0.0),
        in_frame_mm=_in_frame_mm(found),
        view_ratio=views.ratio if views.is_beyond_chance else 1.0,
    )


def _calibration_mm(found: HandheldCalibration, places: np.ndarray) -> float:
    """Return the RMS error of points by the uncertainty of the cameras; NaN of one camera."""
    cameras = [found.rig.camera(name) for name in found.rig.cameras]
    if len(cameras) < _PAIR:
        return float("nan")
    seen = np.all([camera.in_picture(camera.project(places).q) for camera in cameras], axis=0)
    places = places[seen]
    return found.covariance.rms_mm(cameras, places[:: -(-len(places) // _MOST_PLACES) or 1])


def _in_frame_mm(found: HandheldCalibration) -> float:
    """Return the RMS 3-D error where the target was, in the frame of the rig; NaN where it is not known."""
    expected = found.expected_errors()
    if not np.isfinite(expected.depth.calibration_mm):
        return float("nan")
    return float(np.hypot(expected.depth.total_mm, np.sqrt(2.0) * expected.sideways.total_mm))


def _coverage(found: HandheldCalibration, number: int) -> float:
    """Return the share of a camera's picture with dots."""
    residuals = found.residuals
    mine = (residuals.camera == number) & ~residuals.outlier
    size = list(found.rig.cameras.values())[number].size
    return float((coverage_of(residuals.q[mine], size) > 0).mean())
