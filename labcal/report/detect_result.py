"""Result of ``labcal detect``: the JSON document, and the same for people."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from rich.table import Table

from labcal.correspond.measure import Measurement
from labcal.correspond.refused_pictures import shared_reasons
from labcal.detect.dots import PictureDots
from labcal.report.columns import name_column
from labcal.targets.catalogue import AnyTarget


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


def detect_result(measurements: Sequence[Measurement], target: AnyTarget) -> DetectResult:
    """Return the JSON document."""
    images = [
        PictureResult(
            image=found.source.image,
            status="ok" if found.indexed else "refused",
            reason=found.reason,
            dots=0 if found.dots is None else int(found.dots.ok.sum()),
            expected=target.count,
            numberings=None if found.dots is None or not found.indexed else 1 + len(found.dots.others),
            flags={} if found.dots is None else _flags(found.dots),
        )
        for found in measurements
    ]
    indexed = sum(image.status == "ok" for image in images)
    return DetectResult(images, indexed, len(images) - indexed)


def _flags(dots: PictureDots) -> dict[str, int]:
    """Return how many dots have each flag but ``ok``."""
    return dict(sorted(Counter(flag.value for flag in dots.flag if flag.value != "ok").items()))


def detect_table(result: DetectResult) -> Table:
    """Return the document for people."""
    shared = shared_reasons([(one.image, one.reason) for one in result.images if one.reason is not None])
    several = {image for reason in shared if len(reason.images) > 1 for image in reason.images}
    captions = [reason.words for reason in shared if len(reason.images) > 1]
    table = Table(
        name_column("picture"),
        "dots",
        "result",
        caption="\n".join([*captions, f"{result.indexed} indexed, {result.refused} refused"]),
        caption_justify="left",
    )
    for image in result.images:
        others = ", ".join(f"{count} {flag}" for flag, count in image.flags.items())
        came = image.reason or ("ok" if not others else f"ok; not used: {others}")
        if image.image in several:
            came = "refused, see below"
        table.add_row(image.image, f"{image.dots} of {image.expected}", came)
    return table
