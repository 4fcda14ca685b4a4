"""The result of a comparison of two calibrations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from labcal.evaluate.comparison.compare_settings import Pictures
from labcal.evaluate.comparison.lens_difference import CalibratedLens, LensDifference
from labcal.evaluate.comparison.volume_difference import VolumeDifference
from labcal.evaluate.comparison.without_motion import RemainingDifference
from labcal.extras import optional_module
from labcal.public_object import HtmlTable, PublicObject

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas

LEAST_CHANCE = 0.01
"""Chance of a difference below which calibrations count as inconsistent."""
SMALLEST = 1e-6
"""Mm or px, below which differences are those of arithmetic."""


@dataclass(frozen=True)
class CameraComparison:
    """The difference of two calibrations of one camera.

    Attributes
    ----------
    name, other_name : str
        In the first rig and in the second.
    one, other : CalibratedLens
    differences : tuple of LensDifference
        Over the picture: one a distance, the nearest first, then at infinity. The motion of the camera is
        common to all finite distances; at infinity it is a rotation.
    finite : LensDifference or None
        All finite distances together.
    """

    name: str
    other_name: str
    one: CalibratedLens
    other: CalibratedLens
    differences: tuple[LensDifference, ...]
    finite: LensDifference | None

    @property
    def main(self) -> LensDifference:
        """The difference at the middle one of the finite distances, or at infinity without any."""
        finite = [one for one in self.differences if np.isfinite(one.distance_mm[0])]
        return finite[len(finite) // 2] if finite else self.differences[-1]


@dataclass(frozen=True, eq=False, repr=False)
class RigComparison(PublicObject):
    """The difference of two calibrations, beside what their budgets expect of it.

    Attributes
    ----------
    cameras : tuple of CameraComparison
        Px over the pictures.
    volume : VolumeDifference or None
        Mm over the volume; None of single cameras, and where no volume is known.
    pictures : Pictures or None
        Whether the calibrations come from the same pictures; None if that is not known.
    warnings : tuple of str
        What a reader should not miss.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples
    >>> from labcal.pipeline import CompareSettings
    >>> labcal.compare(examples.rig(), examples.rig(), CompareSettings(distances_mm=600.0))
    RigComparison(cameras=['left', 'right'], rms=0 mm, expected=nan mm, consistent=None)
    """

    cameras: tuple[CameraComparison, ...]
    volume: VolumeDifference | None
    pictures: Pictures | None
    warnings: tuple[str, ...] = ()

    @property
    def main(self) -> RemainingDifference:
        """The difference that the verdict is of: over the volume, or over the first camera's picture."""
        return self.cameras[0].main.remaining if self.volume is None else self.volume.remaining

    @property
    def p_value(self) -> float:
        """Chance of differences as large as these between independent calibrations; NaN if not known."""
        return float("nan") if self.pictures is Pictures.SAME else self.main.p_value()

    @property
    def is_consistent(self) -> bool | None:
        """True if both budgets explain the differences; None where no test is possible."""
        return None if np.isnan(self.p_value) else self.p_value >= LEAST_CHANCE

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the points of the volume with their displacements and what both rigs expect of them, mm.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        columns = volume_columns(self.volume)
        frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(columns)
        return frame

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw the differences over the pictures, px, at the middle distance.

        Examples
        --------
        >>> import labcal
        >>> from labcal import examples
        >>> from labcal.pipeline import CompareSettings
        >>> found = labcal.compare(examples.rig(), examples.rig(), CompareSettings(distances_mm=600.0))
        >>> found.plot().axes[0].get_title()
        'left'
        """
        from labcal.evaluate.comparison.comparison_figure import (  # noqa: PLC0415 -- imports matplotlib
            comparison_figure,
        )

        return comparison_figure(self.cameras)

    def _summary(self) -> Mapping[str, object]:
        unit = "px" if self.volume is None else "mm"
        return {
            "cameras": [camera.name for camera in self.cameras],
            "rms": f"{self.main.rms:.3g} {unit}" if self.main.rms > SMALLEST else f"0 {unit}",
            "expected": f"{self.main.expected_of_both:.3g} {unit}",
            "consistent": self.is_consistent,
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [
            [camera.name, distance_text(part), f"{part.remaining.rms:.4f}", f"{part.remaining.largest:.4f}",
             f"{part.remaining.expected_of_both:.4f}"]
            for camera in self.cameras for part in camera.differences
        ]  # fmt: skip
        return [
            HtmlTable(("camera", "at (mm)", "RMS (px)", "largest (px)", "expected (px)"), rows),
            HtmlTable(("warnings",), [[warning] for warning in self.warnings]),
        ]


def distance_text(part: LensDifference) -> str:
    """Return the distance of a difference for people, mm."""
    distance = float(part.distance_mm[0])
    return f"{distance:.0f}" if np.isfinite(distance) else "infinity"


def volume_columns(volume: VolumeDifference | None) -> dict[str, np.ndarray]:
    """Return points and displacements over a volume as columns of a table; empty ones without a volume."""
    names = ("X_mm", "Y_mm", "Z_mm", "dx_mm", "dy_mm", "dz_mm", "expected_a_mm", "expected_b_mm")
    if volume is None:
        return {name: np.empty(0) for name in names}
    remaining = volume.remaining
    columns = [
        *volume.point.T, *remaining.difference.T,
        remaining.expected(remaining.one), remaining.expected(remaining.other),
    ]  # fmt: skip
    return dict(zip(names, columns, strict=True))
