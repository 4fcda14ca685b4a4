"""Result of ``labcal diagnose``: the JSON document, and the same for people."""

from dataclasses import dataclass
from math import isfinite

from labcal.guide.diagnosis.diagnosis import Diagnosis
from labcal.guide.diagnosis.finding import Finding
from labcal.wording import counted

_SHOWN = 3
"""Pictures that are named for each reason."""


@dataclass(frozen=True)
class FindingResult:
    """One mistake that was found."""

    check: str
    cameras: list[str]
    views: list[str]
    harm_mm: float | None
    """About the RMS 3-D error that the mistake adds where the target was; null if it is not known, or without
    bounds. An order of size: of large mistakes wrong by up to several times."""
    harm_percent: float | None
    """Relative increase of the expected 3-D error, %; null as for `harm_mm`."""
    p: float | None
    """Probability that a good shoot shows as much; null where the mistake is seen and no test is made."""
    words: str
    mend: str
    pictures: list[str]
    """Paths of pictures that show it."""
    explained_by: str | None
    """Another finding that explains this one."""


@dataclass(frozen=True)
class NotJudgedResult:
    """A check that could not be made."""

    check: str
    why: str


@dataclass(frozen=True)
class RefusedResult:
    """A picture in which no dot has an id."""

    image: str
    reason: str


@dataclass(frozen=True)
class DiagnoseResult:
    """The JSON document of ``labcal diagnose``."""

    findings: list[FindingResult]
    """The most harmful first."""
    explained: list[FindingResult]
    """Signs of mistakes that a finding explains."""
    not_judged: list[NotJudgedResult]
    refused: list[RefusedResult]
    """Pictures that are left out, with reasons."""
    warnings: list[str]
    """Warnings of `calibrate` from these pictures that name no mistake of a shoot, of lenses above all."""
    expected_mm: float | None
    """Expected RMS 3-D error over the volume of the target's dots, were there no mistake."""


def diagnose_result(found: Diagnosis) -> DiagnoseResult:
    """Return the JSON document."""
    return DiagnoseResult(
        findings=[_finding(one) for one in found.findings],
        explained=[_finding(one) for one in found.explained],
        not_judged=[NotJudgedResult(one.check.value, one.why) for one in found.not_judged],
        refused=[RefusedResult(one.source.image, one.reason or "") for one in found.refused],
        warnings=list(found.warnings),
        expected_mm=_finite(found.evidence.expected_mm),
    )


def diagnose_words(found: Diagnosis) -> str:
    """Return the result for people."""
    lines = []
    if not found.findings:
        lines.append("Nothing wrong is found." if found.is_usable else "No picture can be used.")
    for number, one in enumerate(found.findings, start=1):
        lines.append(f"{number}. {one.check.value}: {one.words} {harm_words(one)}".rstrip())
        lines.append(f"   {one.mend}")
        if one.pictures:
            lines.append(f"   See: {', '.join(one.pictures)}")
    if found.refused:
        lines.append(refused_words(found))
    lines += [f"Calibration warns: {words}" for words in found.warnings]
    unjudged: dict[str, list[str]] = {}
    for left in found.not_judged:
        unjudged.setdefault(left.why, []).append(left.check.value)
    lines += [f"Not judged, {', '.join(checks)}: {why}" for why, checks in unjudged.items()]
    return "\n".join(lines)


def refused_words(found: Diagnosis) -> str:
    """Return the pictures that are left out, for people, those of one reason together."""
    reasons: dict[str, list[str]] = {}
    for one in found.refused:
        reasons.setdefault(one.reason or "", []).append(one.source.image)
    parts = [
        f"{', '.join(images[:_SHOWN])}{' ...' if len(images) > _SHOWN else ''}: {reason}"
        for reason, images in reasons.items()
    ]
    count = f"{len(found.refused)} of {counted(len(found.evidence.measurements), 'picture')}"
    return f"Left out, {count}: " + "\n  ".join(["", *parts]).lstrip("\n ")


def harm_words(one: Finding) -> str:
    """Return what a mistake costs, for people; nothing where that is not known."""
    if one.harm_mm is None or one.harm_percent is None:
        return ""
    if not isfinite(one.harm_mm):
        return "No rig can be relied on until it is mended."
    times = 1.0 + one.harm_percent / 100.0
    return f"It adds about {one.harm_mm:.2g} mm (RMS, in 3-D): errors about {times:.2g} times as large."


def _finding(one: Finding) -> FindingResult:
    return FindingResult(
        check=one.check.value,
        cameras=list(one.cameras),
        views=list(one.views),
        harm_mm=_finite(one.harm_mm),
        harm_percent=_finite(one.harm_percent),
        p=one.p_value,
        words=one.words,
        mend=one.mend,
        pictures=list(one.pictures),
        explained_by=None if one.explained_by is None else one.explained_by.value,
    )


def _finite(value: float | None) -> float | None:
    return value if value is not None and isfinite(value) else None
