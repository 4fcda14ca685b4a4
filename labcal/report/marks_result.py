"""Marks in the result of ``labcal measure``: a part of its JSON document, and the same for people."""

from collections import Counter
from dataclasses import dataclass
from typing import Literal

import numpy as np
from rich.table import Table

from labcal.correspond.refused_pictures import shared_reasons
from labcal.reconstruct.found_marks import FoundMarks
from labcal.report.columns import name_column


@dataclass(frozen=True)
class MarkPictureResult:
    """One picture."""

    image: str
    status: Literal["ok", "refused"]
    reason: str | None
    marks: int
    """Pixels that are measured: one of a dot, four of a tag."""
    flags: dict[str, int]
    """Number of marks by flag, ``ok`` left out."""


@dataclass(frozen=True)
class EccentricityResult:
    """Eccentricity of dots: centroid minus image of the centre."""

    corrected: int
    """Pixels that it was taken from; the covariances hold the uncertainty of that."""
    uncorrected: int
    """Pixels of dots that it is not known of; the covariances hold its size where that is known."""
    rms_px: float
    max_px: float


@dataclass(frozen=True)
class MarksResult:
    """The key ``marks`` in the JSON document."""

    images: list[MarkPictureResult]
    measured: int
    """Pictures that give named pixels."""
    refused: int
    ambiguous: int
    """Pixels of plain dots that could be several of another camera."""
    eccentricity: EccentricityResult
    diameter_mm: float | None
    """Median diameter of dots, as outlines and places have it; null without dots."""


def marks_result(found: FoundMarks) -> MarksResult:
    """Return the part of the document.

    Parameters
    ----------
    found : FoundMarks
    """
    images = [
        MarkPictureResult(
            image=one.source.image,
            status="ok" if one.reason is None else "refused",
            reason=one.reason,
            marks=0 if one.marks is None else int(one.marks.ok.sum()),
            flags={}
            if one.marks is None
            else dict(sorted(Counter(flag.value for flag in one.marks.flag if flag.value != "ok").items())),
        )
        for one in found.measurements
    ]
    known = found.diameter_mm[np.isfinite(found.diameter_mm)]
    return MarksResult(
        images=images,
        measured=sum(one.status == "ok" for one in images),
        refused=sum(one.status == "refused" for one in images),
        ambiguous=int(found.ambiguous.sum()),
        eccentricity=EccentricityResult(
            corrected=int(found.corrected.sum()),
            uncorrected=int(found.uncorrected.sum()),
            rms_px=found.eccentricity.rms,
            max_px=found.eccentricity.max,
        ),
        diameter_mm=float(np.median(known)) if len(known) else None,
    )


def marks_table(result: MarksResult) -> Table:
    """Return the part for people."""
    shared = shared_reasons([(one.image, one.reason) for one in result.images if one.reason is not None])
    several = {image for reason in shared if len(reason.images) > 1 for image in reason.images}
    captions = [reason.words for reason in shared if len(reason.images) > 1]
    eccentricity = result.eccentricity
    if eccentricity.corrected:
        captions.append(
            f"eccentricity of dots corrected by {eccentricity.rms_px:.2g} px RMS, at most "
            f"{eccentricity.max_px:.2g} px"
        )
    table = Table(
        name_column("picture"),
        "measured",
        "result",
        caption="\n".join([*captions, f"{result.measured} with marks, {result.refused} refused"]),
        caption_justify="left",
    )
    for image in result.images:
        others = ", ".join(f"{count} {flag}" for flag, count in image.flags.items())
        came = image.reason or ("ok" if not others else f"ok; not used: {others}")
        table.add_row(image.image, str(image.marks), "refused, see below" if image.image in several else came)
    return table
