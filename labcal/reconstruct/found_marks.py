"""Marks of many pictures as named pixels that are ready to become points."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import Mask
from labcal.calibrate.eccentricity import CorrectedEccentricity
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.correspond.mark_measurement import MarkMeasurement, MarkPixels
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import PointFlag
from labcal.detect.marks.picture_marks import MarkFlag
from labcal.errors import InputError
from labcal.estimators.model import Model
from labcal.public_object import HtmlTable, PublicObject
from labcal.reconstruct.mark_eccentricity import centred_marks
from labcal.reconstruct.plain_dots import MatchedDots, matched_dots
from labcal.wording import counted, listed

_OTHER_SIZE = 0.1
"""Share by which dots may depart from their stated diameter before it is said."""


@dataclass(frozen=True, eq=False, repr=False)
class FoundMarks(PublicObject):
    """Marks of pictures, and their named pixels.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot")
    >>> found = pipeline.find_marks(examples.rig(), shoot, "dots")
    >>> found
    FoundMarks(pictures=4, refused=0, points=..., pixels=...)
    >>> found.pixels.save("pixels.csv")
    """

    measurements: tuple[MarkMeasurement, ...]
    """Of all pictures, in their order; plain dots have the names that cameras agree on."""
    pixels: NamedPixels
    """Of marks that are measured: centres of dots, without their eccentricity where that is known, and
    corners of tags."""
    ambiguous: Bool[np.ndarray, " n"]
    """Mask of the pixels of plain dots that could be several dots of another camera."""
    corrected: Bool[np.ndarray, " n"]
    """Mask of the pixels of dots that the eccentricity is taken from."""
    uncorrected: Bool[np.ndarray, " n"]
    """Mask of the pixels of dots that it is not taken from."""
    eccentricity: CorrectedEccentricity
    """Size of the correction, px."""
    diameter_mm: Float64[np.ndarray, " n"]
    """Of dots, as outlines and place have it; NaN where it is not known."""
    warnings: tuple[str, ...] = ()
    """Warnings in words."""

    @property
    def refused(self) -> list[tuple[str, str]]:
        """Pictures that give no named pixel, with reasons."""
        return [(one.source.image, one.reason) for one in self.measurements if one.reason is not None]

    def flagged(self, points: NamedPoints) -> NamedPoints:
        """Return points without a place whose dots are ambiguous with that flag."""
        unclear = set(self.unclear_dots)
        pairs = zip(points.view.tolist(), points.name.tolist(), strict=True)
        mine = np.array([pair in unclear for pair in pairs], dtype=bool)
        mine &= points.flag == PointFlag.TOO_FEW_CAMERAS.value
        flag = np.where(mine, PointFlag.AMBIGUOUS.value, points.flag)
        return NamedPoints(points.view, points.name, points.point, points.covariance, flag)

    @property
    def unclear_dots(self) -> list[tuple[str, str]]:
        """View and name of every ambiguous dot."""
        view, point = self.pixels.view[self.ambiguous], self.pixels.point[self.ambiguous]
        return list(dict.fromkeys(zip(view.tolist(), point.tolist(), strict=True)))

    def _summary(self) -> Mapping[str, object]:
        return {
            "pictures": len(self.measurements),
            "refused": len(self.refused),
            "points": len(dict.fromkeys(self.pixels.point.tolist())),
            "pixels": len(self.pixels),
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [
            [one.source.image, "0" if one.marks is None else str(int(one.marks.ok.sum())), one.reason or "ok"]
            for one in self.measurements
        ]
        return [HtmlTable(("picture", "measured", "result"), rows)]


def found_marks(model: Model | Rig, measurements: Sequence[MarkMeasurement], marks: MarkPixels) -> FoundMarks:
    """Match plain dots, and correct the eccentricity of all dots.

    Parameters
    ----------
    model : Model or Rig
        Cameras match dots and determine eccentricities.
    measurements : sequence of MarkMeasurement
    marks : MarkPixels
        Of these, line by line in their order.

    Raises
    ------
    InputError
        There are plain dots, and the model is a fitted method, which has no epipolar geometry.
    """
    ambiguous = np.zeros(len(marks.pixels), dtype=bool)
    if marks.is_plain.any():
        if not isinstance(model, Rig):
            raise InputError(
                "Plain dots are matched between cameras by epipolar geometry, which a fitted method does not "
                "have. Give a rig from 'labcal calibrate', or marks with a code."
            )
        matched = matched_dots(model, marks)
        marks, ambiguous = matched.marks, matched.ambiguous
        _refuse_other_size(matched)
    cameras = _cameras(model)
    is_dot = np.isfinite(marks.outline).all(axis=(1, 2))
    none = np.zeros(len(is_dot), dtype=bool)
    corrected, uncorrected, pixels = none, is_dot, marks.pixels
    size, diameter = CorrectedEccentricity(0.0, 0.0), np.full(len(is_dot), np.nan)
    if cameras:
        centred = centred_marks(cameras, marks)
        pixels, corrected, uncorrected = centred.pixels, centred.corrected, centred.uncorrected
        size, diameter = centred.size, centred.diameter_mm
    found = FoundMarks(
        measurements=_renamed(measurements, pixels, ambiguous),
        pixels=pixels,
        ambiguous=ambiguous,
        corrected=corrected,
        uncorrected=uncorrected,
        eccentricity=size,
        diameter_mm=diameter,
    )
    return replace(found, warnings=_warnings(found, marks, has_cameras=bool(cameras)))


def _refuse_other_size(matched: MatchedDots) -> None:
    """Raise where no dot is matched since none has the stated diameter."""
    own = matched.marks.is_plain
    alone = [name.count("-") > 1 for name in matched.marks.pixels.point[own].tolist()]
    if matched.other_mm is not None and all(alone) and not matched.ambiguous.any():
        stated = float(np.nanmedian(matched.marks.diameter_mm[own]))
        raise InputError(
            f"No plain dot has the stated diameter of {stated:.4g} mm (`mark_diameter`): dots whose rays "
            f"meet have some {matched.other_mm:.3g} mm. State theirs, or leave it out; or is the scale of "
            "the calibration wrong?"
        )


def _cameras(model: Model | Rig) -> dict[str, Camera]:
    """Return the cameras of a model by name; none of a method that has none."""
    if isinstance(model, Rig):
        return {name: model.camera(name) for name in model.cameras}
    return {} if model.resected is None else dict(zip(model.cameras, model.resected, strict=True))


def _renamed(
    measurements: Sequence[MarkMeasurement], pixels: NamedPixels, ambiguous: Mask
) -> tuple[MarkMeasurement, ...]:
    """Return pictures whose measured marks have the names of the pixels."""
    renamed, line = [], 0
    for one in measurements:
        if one.marks is None:
            renamed.append(one)
            continue
        names, flags = list(one.marks.point), list(one.marks.flag)
        for at in np.flatnonzero(one.marks.ok).tolist():
            names[at] = str(pixels.point[line])
            if ambiguous[line]:
                flags[at] = MarkFlag.AMBIGUOUS
            line += 1
        renamed.append(replace(one, marks=replace(one.marks, point=tuple(names), flag=tuple(flags))))
    return tuple(renamed)


def _warnings(found: FoundMarks, marks: MarkPixels, *, has_cameras: bool) -> tuple[str, ...]:
    """Return what a person should know of the marks."""
    warnings = []
    if not has_cameras and found.uncorrected.any():
        warnings.append(
            "the eccentricity of dots is in their points, since this method has no cameras, by which it "
            "could be computed. Measure with a rig, or with 'hybrid'."
        )
    if found.ambiguous.any():
        unclear = [f"{view} {name}" for view, name in found.unclear_dots]
        warnings.append(
            f"{counted(len(unclear), 'plain dot')} could be several dots of another camera, flagged "
            f"'ambiguous': {listed(unclear)}. A better calibration, `mark_diameter`, a third camera or coded "
            "dots tell them apart."
        )
    with np.errstate(invalid="ignore"):
        over = found.diameter_mm / marks.diameter_mm
    over = over[np.isfinite(over) & found.corrected]
    if len(over) and abs(float(np.median(over)) - 1.0) > _OTHER_SIZE:
        warnings.append(
            f"the dots are {float(np.median(over)):.3g} times as large as stated. Are these the marks that "
            "are named, and is the scale of the calibration right (`mark_diameter`, the target's pitch)?"
        )
    return tuple(warnings)
