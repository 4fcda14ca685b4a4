"""The check of a calibration: a verdict, what has changed, what it costs, what could have been found."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from labcal.calibrate.validity.tested import Tested
from labcal.cameras.rig import Rig
from labcal.guide.found_change import FoundChange
from labcal.guide.print_difference import PrintDifference
from labcal.guide.smallest_change import SmallestChange
from labcal.public_object import HtmlTable, PublicObject

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas

LIKELY = 0.95
"""Probability from which on a camera or a kind of change is named."""
FEWEST_VIEWS = 3


class CheckVerdict(StrEnum):
    """Verdicts on a calibration."""

    VALID = "valid"
    """No change is found, and one that costs more than three sigmas of the budget would have been."""
    CHANGED = "changed"
    CANNOT_TELL = "cannot-tell"
    """No change is found, but these pictures could have missed one that matters."""


@dataclass(frozen=True)
class ChangeCost:
    """Errors of points over the volume if the old rig is used, in the world of the first camera, mm.

    Attributes
    ----------
    rms_mm, max_mm : float
    low_mm, high_mm : tuple of float
        Corners of the volume: that of the target's dots in these pictures.
    """

    rms_mm: float
    max_mm: float
    low_mm: tuple[float, ...]
    high_mm: tuple[float, ...]


@dataclass(frozen=True, eq=False, repr=False)
class RigCheck(PublicObject):
    """The result of checking a rig by new pictures of a target.

    Attributes
    ----------
    verdict : CheckVerdict
    p_value : float
        Probability that noise and the calibration's errors make a difference so large; a change is reported
        up to 0.01.
    changes : tuple of FoundChange
        Explanations by the most likely change first; of a valid rig, what it would be if there were one.
    by_camera : mapping of str to float
        Probability that each camera is the one, given that there is a change.
    cost : ChangeCost or None
        Of the most likely change; None of a rig that is not changed, or of one camera.
    budget_mm : float or None
        RMS standard deviation of a point over the same volume by noise and calibration.
    undetected_mm : float or None
        RMS error of points by the worst change that would be missed once in ten checks.
    smallest : tuple of SmallestChange
        Smallest changes that would be found nine times in ten.
    sigma0 : float
        Residuals over what calibration and covariances predict, where every camera may have changed.
    views : tuple of str
    dots, outliers : int
        Dots that entered; dots that did not, since they are off by themselves.
    warnings : tuple of str
    rig : Rig
        As it was calibrated.
    tested : Tested
        The explanations that were compared.
    print_difference : PrintDifference or None
        Signs that the new pictures show another print; None where there are none, and of fixed marks.

    Examples
    --------
    >>> from labcal import check, examples, pipeline
    >>> rig = pipeline.calibrate(examples.TARGET, examples.detections()).found.rig
    >>> check(rig, examples.detections(), examples.TARGET).verdict.value
    'valid'
    """

    verdict: CheckVerdict
    p_value: float
    changes: tuple[FoundChange, ...]
    by_camera: Mapping[str, float]
    cost: ChangeCost | None
    budget_mm: float | None
    undetected_mm: float | None
    smallest: tuple[SmallestChange, ...]
    sigma0: float
    views: tuple[str, ...]
    dots: int
    outliers: int
    warnings: tuple[str, ...]
    rig: Rig
    tested: Tested
    print_difference: PrintDifference | None = None

    @property
    def camera(self) -> str | None:
        """The camera that changed, where that can be determined; None where it cannot, or nothing changed."""
        if self.verdict is not CheckVerdict.CHANGED:
            return None
        likely = [name for name, probability in self.by_camera.items() if probability >= LIKELY]
        return likely[0] if len(likely) == 1 else None

    def mended(self) -> Rig:
        """Return the rig with the change corrected, and its covariance.

        Raises
        ------
        InputError
            Nothing has changed, or these pictures do not support a correction.
        """
        from labcal.guide.mend import mended_rig  # noqa: PLC0415 -- it takes checks

        return mended_rig(self)

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw how likely each change is, or what would have been found, and the errors of points in mm.

        Examples
        --------
        >>> from labcal import check, examples, pipeline
        >>> rig = pipeline.calibrate(examples.TARGET, examples.detections()).found.rig
        >>> check(rig, examples.detections(), examples.TARGET).plot().axes[0].get_title()
        'valid (p = 1)'
        """
        from labcal.guide.check_figure import check_figure  # noqa: PLC0415 -- imports matplotlib

        return check_figure(self)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line for each explanation: kind, cameras, probability and p-value.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        from labcal.extras import optional_module  # noqa: PLC0415 -- pandas is optional

        rows = [
            {
                "kind": one.kind.value,
                "cameras": " or ".join(one.cameras),
                "probability": one.probability,
                "p_value": one.p_value,
            }
            for one in self.changes
        ]
        frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(rows)
        return frame

    def _summary(self) -> Mapping[str, object]:
        summary: dict[str, object] = {"verdict": self.verdict.value, "p_value": f"{self.p_value:.2g}"}
        if self.verdict is CheckVerdict.CHANGED:
            summary["change"] = self.changes[0].words
        if self.cost is not None:
            summary["cost"] = f"{self.cost.rms_mm:.3g} mm"
        return {**summary, "views": len(self.views)}

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [[one.words, f"{one.probability:.2f}", f"{one.p_value:.2g}"] for one in self.changes]
        return [HtmlTable(("change", "probability", "p-value"), rows)]
