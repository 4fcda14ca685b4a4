"""Calibration from corrupted data: wrong dots and pictures must be found, and not change the result."""

from dataclasses import replace

import numpy as np

from labcal.bench.solve.held_rig import CAMERAS, TARGET, HeldRig
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.correspond.detections import Detections
from labcal.report.bench import Check, at_most
from labcal.rng import generator

VIEWS = 20
SHARE = 0.02
"""Of the dots."""
OFF_PX = (5.0, 50.0)
SIGMA_LIMIT = 3.0
_CENTRES = HandheldSettings(eccentricity_rounds=0)
_VIEW = "pose-7"
_LAST = np.array([TARGET.cols - 1, TARGET.rows - 1])


def corruption_checks(seed: int) -> list[Check]:
    """Return errors of intrinsics with gross outliers, and numbers of wrong dots and pictures not found."""
    held = HeldRig.drawn(VIEWS, seed)
    dots = held.detections()
    corrupted, wrong = _with_outliers(dots, seed)
    found = _calibrated(corrupted)
    named = ~np.isin(_keys(dots), _keys(found.entering(dots)))
    off = [
        np.subtract(found.rig.camera(name).intrinsics, true.intrinsics) / found.fits[name].sigma.intrinsics
        for name, true in zip(CAMERAS, held.truth.cameras, strict=True)
    ]
    what = f"adjustment, {SHARE:.0%} of the dots off by {OFF_PX[0]:g} to {OFF_PX[1]:g} px"
    return [
        at_most(f"{what}: largest error of the intrinsics, in sigma", float(np.abs(off).max()), SIGMA_LIMIT),
        at_most(f"{what}: of {wrong.sum()} not named", float((wrong & ~named).sum()), 0.0),
        at_most(f"{what}: sound ones named", float((named & ~wrong).sum()), 0.0),
        at_most("adjustment: wrong pictures not named, of 3 kinds", float(_pictures_missed(dots)), 0.0),
    ]


def _with_outliers(dots: Detections, seed: int) -> tuple[Detections, np.ndarray]:
    """Return dots with outliers, and a mask of these."""
    random = generator(seed, "bench solve", "outliers")
    wrong = random.random(len(dots)) < SHARE
    angle, length = random.uniform(0.0, 2.0 * np.pi, len(dots)), random.uniform(*OFF_PX, len(dots))
    off = length[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return replace(dots, position=dots.position + np.where(wrong[:, None], off, 0.0)), wrong


def _pictures_missed(dots: Detections) -> int:
    """Return the number of exchanged, mirrored and wrongly numbered pictures that are not found."""
    in_view = dots.view == _VIEW
    of_right = in_view & (dots.camera == CAMERAS[1])
    other = np.where(dots.camera == CAMERAS[0], CAMERAS[1], CAMERAS[0])
    exchanged = replace(dots, camera=np.where(in_view, other, dots.camera))
    mirrored, turned = dots.index.copy(), dots.index.copy()
    mirrored[of_right, 0] = _LAST[0] - mirrored[of_right, 0]
    turned[of_right] = _LAST - turned[of_right]
    tables = (exchanged, replace(dots, index=mirrored), replace(dots, index=turned))
    return sum(not _named(_calibrated(table)) for table in tables)


def _named(found: HandheldCalibration) -> bool:
    """Tell whether the wrong picture, and no other view, was left out."""
    return bool(found.skipped) and all(f"'{_VIEW}'" in reason for reason in found.skipped)


def _calibrated(dots: Detections) -> HandheldCalibration:
    return calibrate_handheld(dots, TARGET, "brown5", _CENTRES)


def _keys(dots: Detections) -> np.ndarray:
    """Return a unique key for every line."""
    lines = zip(dots.view.tolist(), dots.camera.tolist(), dots.index.tolist(), strict=True)
    return np.array([f"{view} {camera} {col} {row}" for view, camera, (col, row) in lines])
