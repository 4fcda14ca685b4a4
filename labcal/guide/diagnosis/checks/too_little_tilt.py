"""Views in which the target always faces the cameras alike, so that focal lengths stay open."""

import numpy as np

from labcal.calibrate.agreement.finding import ContradictionError
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding
from labcal.guide.diagnosis.support.frontal import change_of_scale
from labcal.guide.diagnosis.support.judged_support import lacking, why_not

_MEND = (
    "Take views in which the target is tilted by 20 to 40 degrees: its top, its bottom, its left and its "
    "right side away from the cameras in turn."
)
_FRONTAL = 0.03
"""Change of scale over the target up to which a picture shows no tilt."""


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    open_ = why_not(evidence, CheckName.TOO_LITTLE_TILT)
    if evidence.calibration is None and not evidence.nominal_poses:
        return _without_calibration(evidence) or open_ or ()
    found = evidence.remedies
    if open_ is not None or found is None or evidence.calibration is None:
        return open_ or ()
    normals = np.asarray(evidence.calibration.T_world_target)[:, :3, 2]
    mean = normals.mean(axis=0) / np.linalg.norm(normals.mean(axis=0))
    away = np.degrees(np.arccos(np.clip(normals @ mean, -1.0, 1.0)))
    now, tilted = found.of_tilt
    beside = "" if now == found.now else " in all places"
    words = (
        (
            f"The target is hardly tilted: half of the views are within {np.median(away):.2g} degrees of one "
            f"direction. Of as many views{beside}, tilted ones would bring the 3-D error to expect over "
            f"all that the cameras see from {now:.2g} mm to {tilted:.2g} mm."
        ),
        _MEND,
    )
    return lacking(evidence, CheckName.TOO_LITTLE_TILT, found.of_tilt, words, found)


def _without_calibration(evidence: Evidence) -> tuple[Finding, ...]:
    """Return the finding where no view shows a tilt and no calibration is possible."""
    if isinstance(evidence.failure, ContradictionError):
        return ()
    dots = evidence.detections.where(evidence.detections.ok & evidence.detections.has_id)
    changes = []
    for view in dots.views:
        for camera in dots.cameras[:1]:
            of = dots.where((dots.view == view) & (dots.camera == camera))
            if len(of):
                changes.append(change_of_scale(of.position, evidence.target.points(of.index)))
    if not changes or not np.nanmax(changes) < _FRONTAL:
        return ()
    views = tuple(dots.views)
    return (
        Finding(
            CheckName.TOO_LITTLE_TILT,
            evidence.cameras,
            views,
            "The target faces the cameras in all views: from such views the cameras cannot be calibrated.",
            _MEND,
            harm_mm=float("inf"),
            harm_percent=float("inf"),
            pictures=evidence.images(views[:4], evidence.cameras[:1]),
        ),
    )
