"""Harm of a mistake: errors of points measured with a rig that is calibrated from the mistaken shoot."""

import numpy as np

from labcal.bench.diagnose.held_shoot import HeldShoot, measured_points
from labcal.calibrate.handheld import calibrate_handheld
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.poses import rigid_alignment, transform

_POINTS = 200
LENS = "brown5"


def measured_error(shoot: HeldShoot, dots: Detections, random: np.random.Generator) -> float:
    """Return the RMS 3-D error of points over the pair's volume, mm; NaN where no calibration is made.

    Points are seen by the cameras as they were first, with the noise of the shoot, and are brought onto the
    truth by a rigid motion: the world of a target in the hand is nobody's.

    Parameters
    ----------
    shoot : HeldShoot
        Of the true cameras.
    dots : Detections
        That the calibration is made of, with the mistake.
    random : numpy.random.Generator
    """
    try:
        rig = calibrate_handheld(dots, shoot.described, LENS).rig
    except InputError:
        return float("nan")
    return error_of(rig, shoot, random)


def error_of(rig: Rig, shoot: HeldShoot, random: np.random.Generator) -> float:
    """Return the RMS 3-D error of points that are measured with a rig, mm."""
    true = shoot.pair.cameras()
    p = measured_points(shoot.pair, _POINTS, random)
    q = np.stack([camera.project(p).q for camera in true], axis=1)
    q += shoot.noise_px * random.standard_normal(q.shape)
    covariance = np.tile(shoot.noise_px**2 * np.eye(2), (len(p), len(true), 1, 1))
    found = triangulate([rig.camera(name) for name in rig.cameras], q, covariance).point
    good = np.isfinite(found).all(axis=1)
    if good.sum() < 0.5 * len(p):
        return float("inf")
    onto_truth = rigid_alignment(p[good], found[good])
    return float(np.sqrt(((transform(onto_truth, found[good]) - p[good]) ** 2).sum(axis=1).mean()))
