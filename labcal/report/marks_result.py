"""Marks in the result of ``labcal measure``: a part of its JSON document, and the same for people."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from rich.table import Table

from labcal.reconstruct.found_marks import FoundMarks
from labcal.report.picture_table import PictureLine, picture_table, unused_flags


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
            flags={} if one.marks is None else unused_flags(one.marks.flag),
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
    captions, eccentricity = list[str](), result.eccentricity
    if eccentricity.corrected:
        captions.append(
            f"eccentricity of dots corrected by {eccentricity.rms_px:.2g} px RMS, at most "
            f"{eccentricity.max_px:.2g} px"
        )
    captions.append(f"{result.measured} with marks, {result.refused} refused")
    lines = [PictureLine(one.image, str(one.marks), one.reason, one.flags) for one in result.images]
    return picture_table(lines, "measured", captions)
