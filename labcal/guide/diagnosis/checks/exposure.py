"""Pictures that are burnt out or too dark."""

from collections.abc import Mapping, Sequence

from labcal.detect.flags import Refusal
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.dim_pictures import dim_pictures
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

_DARK_HARM = 0.2
"""Least increase of noise that is stated where all pictures are dark."""

_UNSEEN = " No dot is seen in them: look whether the target is in sight and the lens uncovered."


def check(evidence: Evidence) -> CheckResult:
    """Return a finding for each camera."""
    if not evidence.has_pictures:
        return NotJudged(CheckName.EXPOSURE, "A table of dots does not tell the exposure. Give the pictures.")
    return tuple(found for camera in picture_cameras(evidence) for found in _of_camera(evidence, camera))


def _of_camera(evidence: Evidence, camera: str) -> tuple[Finding, ...]:
    looked = looks_of(evidence, camera)
    dim = dim_pictures(evidence, camera)
    found = []
    for burnt, mend in (
        (
            True,
            "Shorten the exposure or dim the light until the bare paper is at three quarters of the range.",
        ),
        (
            False,
            "Lengthen the exposure or add light until the bare paper is at three quarters of the range.",
        ),
    ):
        faulty = [one for one in looked if one[2].burnt] if burnt else _dark(looked, dim)
        if not faulty:
            continue
        faulty.sort(key=lambda one: (-one[2].burnt_share, one[2].paper))
        sound = [one[2] for one in looked if one[2].exposure_words is None and one[1] not in dim]
        worst = faulty[0][2].exposure_words or _dim_words(faulty[0][2], dim[faulty[0][1]])
        words = (
            f"{counted(len(faulty), 'picture')} of {len(looked)} of camera '{camera}': the worst is {worst}."
        )
        unseen = all(one[2].refusal is Refusal.NO_DOTS for one in faulty)
        only_dim = all(one[1] in dim for one in faulty)
        harm = (
            dim[faulty[0][1]] if only_dim else noise_increase([one[2] for one in faulty], sound, _DARK_HARM)
        )
        found.append(
            picture_finding(
                evidence, CheckName.EXPOSURE, (camera, faulty), (words, mend + _UNSEEN * unseen), harm
            )
        )
    return tuple(found)


def _dark(looked: Sequence[Looked], dim: Mapping[str, float]) -> list[Looked]:
    """Return the pictures that are dark by themselves, or beside others."""
    return [one for one in looked if (one[2].dark and not one[2].burnt) or one[1] in dim]


def _dim_words(look: PictureLook, more: float) -> str:
    return (
        f"too dark: paper at {look.paper:.0%} of the range, less than in others, and dots are measured with "
        f"{more:.0%} more noise"
    )
