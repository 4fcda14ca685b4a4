"""Pictures that are out of focus, or in which the target moved."""

import numpy as np

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding, NotJudged
from labcal.guide.diagnosis.picture_findings import (
    looks_of,
    noise_increase,
    picture_cameras,
    picture_finding,
)
from labcal.guide.picture_blur import UsualEdges, usual_edges
from labcal.wording import counted


def check(evidence: Evidence) -> CheckResult:
    """Return a finding for each camera."""
    if not evidence.has_pictures:
        return NotJudged(CheckName.BLURRED, "A table of dots does not tell sharpness. Give the pictures.")
    looks = {name: [look for _, _, look in looks_of(evidence, name)] for name in picture_cameras(evidence)}
    usual = usual_edges(looks)
    return tuple(found for name in looks for found in _of_camera(evidence, name, usual[name]))


def _of_camera(evidence: Evidence, camera: str, usual: UsualEdges) -> tuple[Finding, ...]:
    looked = looks_of(evidence, camera)
    faulty = [one for one in looked if usual.is_blurred(one[2])]
    if not faulty:
        return ()
    faulty.sort(key=lambda one: -np.nan_to_num(one[2].widest_px, nan=np.inf))
    moved = [one for one in faulty if one[2].motion_deg is not None]
    widths = [one[2].widest_px for one in faulty if np.isfinite(one[2].widest_px)]
    width = float(np.median(widths)) if widths else usual.limit_px
    words = (
        f"{counted(len(faulty), 'picture')} of {len(looked)} of camera '{camera}' are blurred: edges are "
        f"{width:.1f} px wide, where {usual.width_px:.1f} px is usual."
    )
    usual_px = usual.width_px
    if 2 * len(moved) > len(faulty):
        usual_px = float(np.median([np.nanmin(one[2].directions_px) for one in moved]))
        words = (
            f"{counted(len(faulty), 'picture')} of {len(looked)} of camera '{camera}' are blurred by motion: "
            f"edges are {width:.1f} px wide in one direction, {usual_px:.1f} px in others."
        )
        mend = "Hold the target still, or shorten the exposure and add light; take these views again."
    elif len(faulty) == len(looked):
        mend = "Focus the camera on the target and fix the focus, then take all views again."
    else:
        mend = (
            "Keep the target within the depth of field (or close the aperture), and take these views again."
        )
    sound = [one[2] for one in looked if not usual.is_blurred(one[2])]
    least = float(np.sqrt(max(1.0, width / usual_px)) - 1.0)
    harm = noise_increase([one[2] for one in faulty], sound, least)
    return (picture_finding(evidence, CheckName.BLURRED, (camera, faulty), (words, mend), harm),)
