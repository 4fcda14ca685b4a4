"""Differences of the print in new pictures from that of the calibration, as they are reported."""

from dataclasses import dataclass

from labcal.calibrate.validity.print_dots import DisplacedDots, displaced_dots
from labcal.calibrate.validity.print_scale import print_scale
from labcal.calibrate.validity.tested import Tested
from labcal.targets.catalogue import AnyTarget

_WORTH_A_WORD = 0.05
"""Probability of a print of another scale from which on it is said."""


@dataclass(frozen=True)
class DisplacedDot:
    """A dot that is off by itself: its column and row, and the distance from its place, mm."""

    col: int
    row: int
    off_mm: float


@dataclass(frozen=True)
class PrintDifference:
    """Signs that the new pictures show another print than that of the calibration.

    Attributes
    ----------
    scale_ppm, scale_sigma_ppm, scale_probability : float or None
        A print of another scale that explains the pictures with the rig as it was, and how probable it is
        beside all changes of the rig; None where the rig is not changed, or this is no explanation.
    uneven_mm, expected_mm, uneven_p_value : float or None
        RMS distance of the dots from their places, that of the calibration's print, and the probability that
        chance explains it; None where they are as even as expected.
    dots : tuple of DisplacedDot
        Single dots that are off by themselves, the farthest first; at most three.
    """

    scale_ppm: float | None = None
    scale_sigma_ppm: float | None = None
    scale_probability: float | None = None
    uneven_mm: float | None = None
    expected_mm: float | None = None
    uneven_p_value: float | None = None
    dots: tuple[DisplacedDot, ...] = ()

    @classmethod
    def of(cls, found: Tested, target: AnyTarget, *, changed: bool) -> "PrintDifference | None":
        """Return the differences; None where there are none.

        Parameters
        ----------
        found : Tested
        target : AnyTarget
        changed : bool
            Whether the rig is found to be changed; else there is nothing that a scale could explain.
        """
        scale = print_scale(found) if changed else None
        if scale is not None and scale.probability < _WORTH_A_WORD:
            scale = None
        displaced = displaced_dots(found)
        if scale is None and displaced is None:
            return None
        by_scale: tuple[float | None, float | None, float | None] = (None, None, None)
        if scale is not None:
            by_scale = (scale.ppm, scale.sigma_ppm, scale.probability)
        if displaced is None:
            return cls(*by_scale)
        return cls(
            *by_scale, displaced.rms_mm, displaced.expected_mm, displaced.p_value, _dots(displaced, target)
        )

    @property
    def words(self) -> tuple[str, ...]:
        """The differences for people, each a warning of its own."""
        said = []
        if self.scale_ppm is not None:
            size = "larger" if self.scale_ppm > 0.0 else "smaller"
            said.append(
                f"an unchanged rig and another print explain these pictures, too (probability "
                f"{self.scale_probability:.2f}): its pitch is {abs(self.scale_ppm):.0f} +- "
                f"{self.scale_sigma_ppm:.0f} ppm {size} than declared. Measure the print, or take pictures "
                "of the calibration's, before you correct the rig"
            )
        if self.uneven_mm is not None:
            chance = f"p = {self.uneven_p_value:.1g}"
            words = (
                f"this is not the print of the calibration, or it was damaged: in all pictures alike, dots "
                f"lie {self.uneven_mm:.2g} mm RMS from their places, where {self.expected_mm:.2g} mm are "
                f"expected ({chance})"
            )
            if self.dots:
                named = ", ".join(f"({one.col}, {one.row}) by {one.off_mm:.2g} mm" for one in self.dots)
                words += f"; above all {named}"
            said.append(f"{words}. The test allows for it, and finds less")
        return tuple(said)


def _dots(displaced: DisplacedDots, target: AnyTarget) -> tuple[DisplacedDot, ...]:
    """Return the named dots by column and row."""
    indices = target.indices()
    return tuple(
        DisplacedDot(int(indices[number, 0]), int(indices[number, 1]), off) for number, off in displaced.named
    )
