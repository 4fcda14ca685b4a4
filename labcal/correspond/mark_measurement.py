"""Marks in many pictures, spread over an executor, and the named pixels of all of them."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float64

from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.picture_work import over_pictures, read_and
from labcal.correspond.sources import Source
from labcal.public_object import PublicObject
from labcal.run.progress import Progress
from labcal.shoot.luma import measured_light
from labcal.shoot.tone_curve import AnyToneCurve
from labcal.wording import listed

if TYPE_CHECKING:
    from labcal.detect.marks.mark_kinds import MarkKind
    from labcal.detect.marks.picture_marks import PictureMarks
    from labcal.detect.settings import DetectSettings


@dataclass(frozen=True, eq=False, repr=False)
class MarkMeasurement(PublicObject):
    """The marks of one picture."""

    source: Source
    marks: "PictureMarks | None"
    """None where the file could not be read, or is not used."""
    reason: str | None
    """The reason why the picture gives no named pixel; None if it does."""

    def _summary(self) -> Mapping[str, object]:
        found = {"measured": 0 if self.marks is None else int(self.marks.ok.sum())}
        why = {} if self.reason is None else {"reason": self.reason}
        return {"view": self.source.view, "camera": self.source.camera, **found, **why}


@dataclass(frozen=True)
class MarkPixels:
    """Named pixels of marks, with the outlines of dots.

    Attributes
    ----------
    pixels : NamedPixels
        A line for each mark that is measured.
    outline : ndarray, shape (n, 2, 2)
        Matrices of the dots' outlines, px squared; NaN for corners of tags.
    diameter_mm : ndarray, shape (n,)
        Diameters of the dots, as stated; NaN where they are not known, and for corners.
    is_plain : ndarray of bool, shape (n,)
        Mask of plain dots, whose names are those of their pictures.
    """

    pixels: NamedPixels
    outline: Float64[np.ndarray, "n 2 2"]
    diameter_mm: Float64[np.ndarray, " n"]
    is_plain: Bool[np.ndarray, " n"]


def picture_marks(
    source: Source,
    kinds: "tuple[MarkKind, ...]",
    size: tuple[int, int] | None,
    tone_curve: AnyToneCurve,
    settings: "DetectSettings | None",
) -> MarkMeasurement:
    """Read a picture and find its marks.

    Parameters
    ----------
    source : Source
    kinds : tuple of MarkKind
    size : tuple of int or None
        Width and height of the pictures that its camera was calibrated for, px.
    tone_curve : AnyToneCurve
        Undone first.
    settings : DetectSettings or None
    """
    from labcal.detect.marks.several_kinds import find_marks  # noqa: PLC0415 -- imports Numba

    def found(picture: np.ndarray) -> MarkMeasurement:
        seen = (picture.shape[1], picture.shape[0])
        if size is not None and seen != size:
            return _lost(
                source,
                f"The picture {source.image} is {seen[0]} x {seen[1]} px, but camera '{source.camera}' was "
                f"calibrated with pictures of {size[0]} x {size[1]} px. Give pictures as that camera takes "
                "them.",
            )
        marks = find_marks(measured_light(source.image, picture, tone_curve), kinds, settings)
        return MarkMeasurement(source, marks, None if marks.ok.any() else _nothing(marks, kinds))

    return read_and(source, found, _lost)


def measure_marks(
    sources: Sequence[Source],
    kinds: "tuple[MarkKind, ...]",
    sizes: Mapping[str, tuple[int, int]],
    how: "tuple[AnyToneCurve, DetectSettings | None]",
    executor: Executor,
    progress: Progress,
) -> list[MarkMeasurement]:
    """Find marks in pictures, in the order of `sources` whatever the order of work.

    Parameters
    ----------
    sources : sequence of Source
    kinds : tuple of MarkKind
    sizes : mapping of str to tuple of int
        Width and height of the pictures that each camera was calibrated for, px.
    how : tuple
        Tone curve, and settings of the detector.
    executor : Executor
    progress : Progress
    """
    progress.start("finding marks", len(sources))
    cases = [(source, kinds, sizes.get(source.camera), *how) for source in sources]
    return over_pictures(executor, picture_marks, cases, _lost, progress)


def mark_pixels(
    measurements: Sequence[MarkMeasurement], kinds: "tuple[MarkKind, ...]", diameter_mm: float | None
) -> MarkPixels:
    """Return the named pixels of pictures, in their order.

    Parameters
    ----------
    measurements : sequence of MarkMeasurement
    kinds : tuple of MarkKind
        Those that were looked for.
    diameter_mm : float or None
        Of dots whose kind does not state it, mm.
    """
    from labcal.detect.marks.mark_kinds import PlainDots  # noqa: PLC0415 -- imports Numba

    used = [(one.source, one.marks.where(one.marks.ok)) for one in measurements if one.marks is not None]
    counts = [len(marks.point) for _, marks in used]
    names = [name for _, marks in used for name in marks.point]
    pixels = NamedPixels(
        view=np.repeat(np.array([source.view for source, _ in used], dtype=np.str_), counts),
        camera=np.repeat(np.array([source.camera for source, _ in used], dtype=np.str_), counts),
        point=np.array(names, dtype=np.str_),
        position=np.concatenate([np.empty((0, 2)), *[marks.position for _, marks in used]]),
        covariance=np.concatenate([np.empty((0, 2, 2)), *[marks.covariance for _, marks in used]]),
    )
    outline = np.concatenate([np.empty((0, 2, 2)), *[marks.outline for _, marks in used]])
    stated = np.full(len(names), np.nan if diameter_mm is None else diameter_mm)
    is_plain = np.zeros(len(names), dtype=bool)
    for kind in kinds:
        own = np.array([name.startswith(f"{kind.family}-") for name in names], dtype=bool)
        is_plain |= own & isinstance(kind, PlainDots)
        if kind.diameter_mm is not None:
            stated[own] = kind.diameter_mm
    stated[~np.isfinite(outline).all(axis=(1, 2))] = np.nan
    return MarkPixels(pixels, outline, stated, is_plain)


def _lost(source: Source, reason: str) -> MarkMeasurement:
    """Return the result of a picture that cannot be used."""
    return MarkMeasurement(source, None, reason)


def _nothing(marks: "PictureMarks", kinds: "tuple[MarkKind, ...]") -> str:
    """Return why a picture gives no named pixel."""
    looked_for = listed([f"'{kind.family}'" for kind in kinds])
    if not marks.point:
        return (
            f"no-marks: no mark of {looked_for} was found. Is this their kind? They need to be dark on "
            "light, in focus, and whole in the picture."
        )
    flags = listed(list(dict.fromkeys(flag.value for flag in marks.flag)))
    return f"no-marks: no mark of {looked_for} could be measured; those that were seen are flagged {flags}."
