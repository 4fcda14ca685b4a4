"""Pictures that show another target than the one that is named, or none."""

from collections import Counter
from collections.abc import Sequence

from labcal.correspond.measure import Measurement
from labcal.detect.flags import Refusal, advice
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding, NotJudged
from labcal.guide.diagnosis.shown_target import NOTHING_SEEN, OF_ANOTHER, refused_for
from labcal.guide.picture_blur import ALWAYS_PX
from labcal.wording import counted

_MOST = 0.5
"""Share of the pictures with dots from which on that many refusals speak of another target."""
_SHOWN = 4


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    if not evidence.has_pictures:
        return NotJudged(
            CheckName.WRONG_TARGET,
            "A table of dots does not tell what else is in the pictures. Give the pictures.",
        )
    read = [one for one in evidence.measurements if one.dots is not None]
    refused = refused_for(read, OF_ANOTHER)
    if not refused and not evidence.is_usable:
        refused = _without_reason(evidence)
        mend = advice(_usual(refused)) if refused else ""
    elif len(refused) < _MOST * len(read):
        return ()
    else:
        mend = (
            "Name the target that the pictures show with `target`, or write a description of it; look "
            "whether rings or markers are hidden, cut off or glaring."
        )
    if not refused:
        return ()
    words = (
        f"{counted(len(refused), 'picture')} of {len(read)} do not show the target "
        f"'{evidence.target.name}': {_usual(refused).value}."
    )
    shown = evidence.shown_instead
    if shown is None:
        return (_finding(refused, words, mend),)
    return (_finding(refused, f"{words} They show '{shown}'.", f"Name it: `target='{shown}'`."),)


def _without_reason(evidence: Evidence) -> tuple[Measurement, ...]:
    """Return the pictures with nothing like the target in sight, for which light and blur are no reason."""
    looked = [
        one
        for one, look in zip(evidence.measurements, evidence.looks, strict=True)
        if look is not None and look.exposure_words is None and not look.widest_px > ALWAYS_PX
    ]
    return refused_for(looked, NOTHING_SEEN)


def _usual(refused: Sequence[Measurement]) -> Refusal:
    """Return the most frequent reason of refused pictures."""
    reasons = Counter(one.dots.refusal for one in refused if one.dots and one.dots.refusal)
    return reasons.most_common(1)[0][0]


def _finding(refused: Sequence[Measurement], words: str, mend: str) -> Finding:
    return Finding(
        CheckName.WRONG_TARGET,
        tuple(dict.fromkeys(one.source.camera for one in refused)),
        tuple(dict.fromkeys(one.source.view for one in refused)),
        words,
        mend,
        harm_mm=float("inf"),
        harm_percent=float("inf"),
        pictures=tuple(one.source.image for one in refused[:_SHOWN]),
    )
