"""Result of ``labcal detect``: the JSON document, and the same for people."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from rich.table import Table

from labcal.correspond.measure import Measurement
from labcal.correspond.printed_target import ShownTarget
from labcal.report.picture_table import PictureLine, picture_table, unused_flags


@dataclass(frozen=True)
class PictureResult:
    """One picture in the JSON document of ``labcal detect``."""

    image: str
    status: Literal["ok", "refused"]
    reason: str | None
    dots: int
    expected: int
    numberings: int | None
    """Number of numberings that fit equally well, this one included: 1 if the dots are certain."""
    flags: dict[str, int]
    """Number of dots by flag, ``ok`` left out."""


@dataclass(frozen=True)
class DetectResult:
    """The JSON document of ``labcal detect``."""

    images: list[PictureResult]
    indexed: int
    refused: int
    target: str
    """Name of the target, with that of the print where its code has a number."""
    target_read_from: str | None
    """The picture from whose code the target is read; null where it was named, or a shoot states it."""


def detect_result(measurements: Sequence[Measurement], shown: ShownTarget) -> DetectResult:
    """Return the JSON document."""
    target = shown.target
    images = [
        PictureResult(
            image=found.source.image,
            status="ok" if found.indexed else "refused",
            reason=found.reason,
            dots=0 if found.dots is None else int(found.dots.ok.sum()),
            expected=target.count,
            numberings=None if found.dots is None or not found.indexed else 1 + len(found.dots.others),
            flags={} if found.dots is None else unused_flags(found.dots.flag),
        )
        for found in measurements
    ]
    indexed = sum(image.status == "ok" for image in images)
    return DetectResult(images, indexed, len(images) - indexed, shown.printed.name, shown.picture)


def detect_table(result: DetectResult) -> Table:
    """Return the document for people."""
    lines = [
        PictureLine(one.image, f"{one.dots} of {one.expected}", one.reason, one.flags)
        for one in result.images
    ]
    return picture_table(lines, "dots", [f"{result.indexed} indexed, {result.refused} refused"])
