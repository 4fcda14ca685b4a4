"""Pictures that are out of focus, or in which the target moved."""

import numpy as np

from labcal.detect.flags import Refusal
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding, NotJudged
from labcal.guide.diagnosis.picture_findings import (
    Looked,
    looks_of,
    noise_increase,
    picture_cameras,
    picture_finding,
)
from labcal.guide.picture_look import PictureLook
from labcal.wording import counted

_WIDER = 1.5
"""Times the usual width of edges from which on a picture counts as blurred."""
_LEAST_PX = 3.0
"""Width that every sharp lens and sensor may show."""
_ALWAYS_PX = 7.0
"""Width from which on a picture is blurred whatever the others are."""
_SHARP = 25.0
"""Percentile of the widths of a camera that its optics can do."""


def check(evidence: Evidence) -> CheckResult:
    """Return a finding for each camera."""
    if not evidence.has_pictures:
        return NotJudged(CheckName.BLURRED, "A table of dots does not tell sharpness. Give the pictures.")
    cameras = picture_cameras(evidence)
    usual = {camera: _usual(looks_of(evidence, camera)) for camera in cameras}
    return tuple(found for camera in cameras for found in _of_camera(evidence, camera, usual))


def _usual(looked: list[Looked]) -> float:
    """Return the width of edges that a camera's sharper pictures have, px."""
    widths = [
        look.edge_width_px for _, _, look in looked if np.isfinite(look.edge_width_px) and not look.burnt
    ]
    return float(np.percentile(widths, _SHARP)) if widths else float("nan")


def _of_camera(evidence: Evidence, camera: str, usual: dict[str, float]) -> tuple[Finding, ...]:
    looked = looks_of(evidence, camera)
    best = float(np.nanmin([*usual.values(), np.inf]))
    own = min(usual[camera], 2.0 * best) if np.isfinite(usual[camera]) else 2.0 * best
    limit = min(max(_LEAST_PX, _WIDER * own), _ALWAYS_PX)
    faulty = [one for one in looked if _is_blurred(one[2], limit)]
    if not faulty:
        return ()
    faulty.sort(key=lambda one: -np.nan_to_num(one[2].edge_width_px, nan=np.inf))
    directions = [one[2].motion_deg for one in faulty]
    moved = [angle for angle in directions if angle is not None]
    width = float(np.nanmedian([one[2].edge_width_px for one in faulty]))
    words = (
        f"{counted(len(faulty), 'picture')} of {len(looked)} of camera '{camera}' are blurred: edges are "
        f"{width:.1f} px wide, where {own:.1f} px is usual."
    )
    if len(moved) > 0.5 * len(faulty):
        words += " The edges are wide in one direction: the target or the camera moved."
        mend = "Hold the target still, or shorten the exposure and add light; take these views again."
    elif len(faulty) == len(looked):
        mend = "Focus the camera on the target and fix the focus, then take all views again."
    else:
        mend = (
            "Keep the target within the depth of field (or close the aperture), and take these views again."
        )
    sound = [one[2] for one in looked if one not in faulty]
    harm = noise_increase([one[2] for one in faulty], sound, float(np.sqrt(max(1.0, width / own)) - 1.0))
    return (picture_finding(evidence, CheckName.BLURRED, (camera, faulty), (words, mend), harm),)


def _is_blurred(look: PictureLook, limit: float) -> bool:
    if look.refusal is Refusal.BLURRED:
        return True
    if look.burnt or look.dark:
        return False  # its edges are cut off, or drown in noise
    return bool(look.edge_width_px > limit)
