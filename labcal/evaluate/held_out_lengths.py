"""Errors of lengths in views held out: each part is measured by cameras calibrated from the others."""

from collections.abc import Mapping
from dataclasses import dataclass

from labcal.evaluate.own_lengths import LengthErrors


@dataclass(frozen=True)
class HeldOutPart:
    """One part of the views, measured by cameras that were calibrated from the others."""

    views: tuple[str, ...]
    """Held out and scored."""
    calibrated_on: int
    """Number of the others."""
    n: int
    """Number of lengths."""
    rms_mm: float
    scale_ppm: float
    warnings: tuple[str, ...]
    """Of this calibration, for people."""


@dataclass(frozen=True, eq=False, repr=False)
class HeldOutLengths(LengthErrors):
    """The JSON document of ``labcal evaluate --holdout``: lengths of all parts, and each part.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> errors = pipeline.evaluate_held_out(examples.TARGET, examples.detections(), parts=2)
    >>> len(errors.parts), errors.views_calibrated_on
    (2, 0)
    """

    lens: str
    """Lens model of the calibrations; of several, where views chose different ones, between commas."""
    parts: tuple[HeldOutPart, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings, for people; those of the calibrations are in `parts`."""
        doubtful = sum(bool(part.warnings) for part in self.parts)
        if not doubtful:
            return super().warnings
        note = (
            f"{doubtful} of {len(self.parts)} calibrations have warnings of their own: see `parts` in the "
            "result, or calibrate from all views"
        )
        return (*super().warnings, note)

    def _summary(self) -> Mapping[str, object]:
        return {**super()._summary(), "parts": len(self.parts)}
