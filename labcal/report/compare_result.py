"""Result of ``labcal compare``: the JSON document, and the same for people."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from rich.console import Group
from rich.table import Table

from labcal.evaluate.comparison.compare_settings import Pictures
from labcal.evaluate.comparison.lens_difference import CalibratedLens, LensDifference
from labcal.evaluate.comparison.rig_comparison import SMALLEST, RigComparison, distance_text
from labcal.evaluate.comparison.volume_difference import VolumeDifference
from labcal.evaluate.comparison.without_motion import RemainingDifference
from labcal.report.values import Measured


@dataclass(frozen=True)
class PictureDifference:
    """The difference of a camera's two lenses over the supported part of the picture, px."""

    distance_mm: float | None
    """From the camera; null at infinity."""
    rms_px: float
    max_px: float
    expected_a_px: Measured
    """RMS difference that the errors of the first calibration cause; null if it states no covariance."""
    expected_b_px: Measured
    p_value: Measured
    """Of such differences between independent calibrations; null where no test is possible."""


@dataclass(frozen=True)
class ComparedCamera:
    """A camera in the JSON document."""

    camera_b: str
    """Its name in the second rig."""
    lens_a: str
    lens_b: str
    supported_a: float | None
    """Share of the picture within the hull of the dots of the first calibration; null if not known."""
    supported_b: float | None
    differences: list[PictureDifference]


@dataclass(frozen=True)
class ComparedVolume:
    """The difference over the volume, mm."""

    points: int
    rms_mm: float
    max_mm: float
    expected_a_mm: Measured
    expected_b_mm: Measured
    p_value: Measured
    T_a_b: list[list[float]]
    """The implied motion, 4x4: the world of the second rig to that of the first, mm."""
    rotation_sigma_deg: list[Measured]
    """Standard deviations of its rotations about the axes of the first rig's world."""
    place_sigma_mm: list[Measured]
    """Standard deviations of the place of the volume's centre."""


@dataclass(frozen=True)
class CompareResult:
    """The JSON document of ``labcal compare``."""

    cameras: dict[str, ComparedCamera]
    volume: ComparedVolume | None
    """Null of single cameras, and if no rig states where its target was and no distances are given."""
    pictures: str | None
    """``different`` or ``same``; null if not known."""
    consistent: bool | None
    """True if both budgets explain the differences (chance of 1% or more); null where no test is possible."""
    warnings: list[str]


def compare_result(found: RigComparison) -> CompareResult:
    """Return the JSON document."""
    tested = found.pictures is not Pictures.SAME
    return CompareResult(
        cameras={
            camera.name: ComparedCamera(
                camera.other_name,
                camera.one.camera.lens,
                camera.other.camera.lens,
                supported_share(camera.one),
                supported_share(camera.other),
                [_picture(part, tested) for part in camera.differences],
            )
            for camera in found.cameras
        },
        volume=None if found.volume is None else _volume(found.volume, tested),
        pictures=None if found.pictures is None else found.pictures.value,
        consistent=found.is_consistent,
        warnings=list(found.warnings),
    )


def supported_share(lens: CalibratedLens) -> float | None:
    """Return the share of a picture within the hull of a calibration's dots; None if not known."""
    if len(lens.outline) < 3:  # noqa: PLR2004 -- a triangle
        return None
    x, y = lens.outline.T
    area = 0.5 * abs(float(x @ np.roll(y, 1) - y @ np.roll(x, 1)))
    width, height = lens.camera.size
    return min(1.0, area / (width * height))


def _picture(part: LensDifference, tested: bool) -> PictureDifference:  # noqa: FBT001 -- of one result
    r, distance = part.remaining, float(part.distance_mm[0])
    return PictureDifference(
        distance if np.isfinite(distance) else None,
        r.rms,
        r.largest,
        r.expected_rms(r.one),
        r.expected_rms(r.other),
        r.p_value() if tested else float("nan"),
    )


def _volume(found: VolumeDifference, tested: bool) -> ComparedVolume:  # noqa: FBT001 -- as above
    r = found.remaining
    return ComparedVolume(
        len(found.point),
        r.rms,
        r.largest,
        r.expected_rms(r.one),
        r.expected_rms(r.other),
        r.p_value() if tested else float("nan"),
        found.T_one_other.tolist(),
        np.degrees(found.motion_sigma[:3]).tolist(),
        found.motion_sigma[3:].tolist(),
    )


def comparison_words(found: RigComparison) -> str:
    """Return the outcome in one sentence."""
    main, unit = found.main, "px" if found.volume is None else "mm"
    over = "over the picture of the first camera" if found.volume is None else "over the volume"
    if main.largest < SMALLEST:
        return f"The calibrations are the same {over}."
    words = f"The calibrations differ by {main.rms:.3g} {unit} RMS {over}, {main.largest:.3g} at most"
    both = main.expected_of_both
    if np.isnan(both):
        return f"{words}; how much is to be expected is not known."
    words += f"; {both:.3g} RMS is to be expected of independent ones"
    if found.is_consistent is None:
        return f"{words}. They come from the same pictures, so that this is no test."
    verdict = "they are consistent" if found.is_consistent else "they are NOT consistent"
    return f"{words}: {verdict} ({chance_words(found.p_value)})."


def chance_words(p_value: float) -> str:
    """Return a p-value in words."""
    return "p < 0.0001" if p_value < 1e-4 else f"p = {p_value:.2g}"  # noqa: PLR2004 -- as it says


def comparison_table(found: RigComparison) -> Group:
    """Return the document for people, within 80 columns."""
    table = Table("", "at (mm)", "RMS", "largest", "expected a", "expected b", "unit")
    for column in table.columns[1:6]:
        column.justify = "right"
    for camera in found.cameras:
        for part in camera.differences:
            r = part.remaining
            table.add_row(camera.name, distance_text(part), *_figures(r, "{:.4f}".format), "px")
    if found.volume is not None:
        table.add_row("volume", "", *_figures(found.volume.remaining, "{:.5f}".format), "mm")
    return Group(table, comparison_words(found))


def _figures(r: RemainingDifference, text: Callable[[float], str]) -> list[str]:
    """Return the figures of a difference as cells."""
    values = (r.rms, r.largest, r.expected_rms(r.one), r.expected_rms(r.other))
    return ["-" if np.isnan(value) else text(value) for value in values]
