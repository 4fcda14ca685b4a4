"""Pictures that show another target than the one that is named."""

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress

from labcal.correspond.measure import Measurement, measure_picture
from labcal.detect.flags import Refusal
from labcal.errors import InputError
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding, NotJudged
from labcal.targets.catalogue import load_target, target_names
from labcal.wording import counted

_OF_ANOTHER = {
    Refusal.NO_GRID,
    Refusal.NO_RINGS,
    Refusal.AMBIGUOUS_RINGS,
    Refusal.AMBIGUOUS,
    Refusal.NO_MARKERS,
    Refusal.OTHER_BOARD,
    Refusal.OTHER_IDS,
}
"""Refusals that another target explains."""
_MOST = 0.5
"""Share of the pictures with dots from which on that many refusals speak of another target."""
_TRIED = 2
"""Pictures in which other targets are looked for."""


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    if not evidence.has_pictures:
        return NotJudged(
            CheckName.WRONG_TARGET,
            "A table of dots does not tell what else is in the pictures. Give the pictures.",
        )
    seen = [one for one in evidence.measurements if one.dots is not None]
    refused = [one for one in seen if one.dots is not None and one.dots.refusal in _OF_ANOTHER]
    if not refused or len(refused) < _MOST * len(seen):
        return ()
    reasons = Counter(one.dots.refusal.value for one in refused if one.dots and one.dots.refusal)
    (reason, _), *_ = reasons.most_common(1)
    fits = _fitting(refused, evidence.target.name)
    words = (
        f"{counted(len(refused), 'picture')} of {len(seen)} do not show the target "
        f"'{evidence.target.name}': {reason}."
    )
    if fits is None:
        mend = (
            "Name the target that the pictures show with `target`, or write a description of it; look "
            "whether rings or markers are hidden, cut off or glaring."
        )
    else:
        words += f" They show '{fits}'."
        mend = f"Name it: `target='{fits}'`."
    return (
        Finding(
            CheckName.WRONG_TARGET,
            tuple(dict.fromkeys(one.source.camera for one in refused)),
            tuple(dict.fromkeys(one.source.view for one in refused)),
            words,
            mend,
            harm_mm=float("inf"),
            harm_percent=float("inf"),
            pictures=tuple(one.source.image for one in refused[:4]),
        ),
    )


def _fitting(refused: Sequence[Measurement], named: str) -> str | None:
    """Return the shipped target that all of some refused pictures show; None where there is none."""
    for name in target_names():
        if name == named:
            continue
        with suppress(InputError):
            target = load_target(name)
            if all(measure_picture(one.source, target).indexed for one in refused[:_TRIED]):
                return name
    return None
