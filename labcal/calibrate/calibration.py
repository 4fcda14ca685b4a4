"""The result of a complete calibration."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from labcal.calibrate.budget.shared_errors import measured_places
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_choice import LensChoice
from labcal.cameras.camera_pair import CameraPair
from labcal.cameras.expected_errors import ExpectedErrors
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable, PublicObject
from labcal.targets.places import DotPlaces

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(PublicObject):
    """A rig, and how it came to be.

    Attributes
    ----------
    found : HandheldCalibration
    lens : str
        The lens model.
    choice : LensChoice or None
        How it was chosen, and the reason; None where it was named, or is that of a rig to start from.
    held_out : tuple of str
        Views that the calibration did not see.
    calibrated_on : tuple of str
        Views that it comes from; those of a rig whose lenses were kept among them, and those that a measured
        print comes from.
    warnings : tuple of str
        What is not as it should be, for people.

    Examples
    --------
    >>> from labcal import examples, load_target, pipeline
    >>> made = pipeline.calibrate(load_target(examples.TARGET), examples.detections())
    >>> made
    Calibration(cameras=['left', 'right'], lens=brown5, views=8, rms=0.0281 px, warnings=0)
    """

    found: HandheldCalibration
    lens: str
    choice: LensChoice | None
    held_out: tuple[str, ...]
    calibrated_on: tuple[str, ...]
    warnings: tuple[str, ...]

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write the rig as ``rig.json``, which :meth:`Rig.load` reads; how it came to be is in no file.

        Raises
        ------
        OutputError
            The file exists and `force` is not set, or it cannot be written.
        """
        self.rig.save(path, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the table of :meth:`Rig.to_pandas` with views, dots and RMS of each camera.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        fits = [self.found.fits[name] for name in self.found.rig.cameras]
        return self.rig.to_pandas().assign(
            views=[len(fit.views) for fit in fits],
            dots=[fit.dots for fit in fits],
            rms_px=[fit.rms_px for fit in fits],
            rms_in_rig_px=[fit.rms_in_rig_px for fit in fits],
        )

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw the residuals in the rig: their RMS by view, px, and over each picture, enlarged.

        Residuals are predicted minus measured positions of the dots' centres.

        Examples
        --------
        >>> from labcal import examples, load_target, pipeline
        >>> made = pipeline.calibrate(load_target(examples.TARGET), examples.detections())
        >>> made.plot().axes[0].get_ylabel()
        'RMS residual (px)'
        """
        from labcal.calibrate.calibration_figure import (  # noqa: PLC0415 -- imports matplotlib
            calibration_figure,
        )

        return calibration_figure(self.found)

    def plot_displacements(self) -> "matplotlib.figure.Figure":
        """Draw how far freed dots are from their declared places, as magnified arrows; heights as colours.

        Raises
        ------
        InputError
            The dots were not freed.
        """
        from labcal.calibrate.displacement_figure import (  # noqa: PLC0415 -- imports matplotlib
            displacement_figure,
        )

        if self.found.freed is None:
            raise InputError(
                "The dots of this calibration were not freed. Calibrate with `dot_places='freed'` to draw "
                "them."
            )
        return displacement_figure(self.found.freed)

    def _summary(self) -> Mapping[str, object]:
        return {
            "cameras": list(self.found.rig.cameras),
            "lens": self.lens,
            "views": len(self.found.views),
            "rms": f"{self.found.rms_px:.3g} px",
            "warnings": len(self.warnings),
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [
            [name, str(len(fit.views)), str(fit.dots), f"{fit.rms_px:.4f}", f"{fit.rms_in_rig_px:.4f}"]
            for name, fit in self.found.fits.items()
        ]
        return [
            HtmlTable(("camera", "views", "dots", "RMS alone (px)", "RMS in the rig (px)"), rows),
            HtmlTable(("warnings",), [[warning] for warning in self.warnings]),
        ]

    @property
    def rig(self) -> Rig:
        """The cameras, and the views that they were calibrated from."""
        return self.found.rig.model_copy(update={"calibrated_on": self.calibrated_on})

    def pairs(self) -> tuple[CameraPair, ...]:
        """Return baseline and angle of every two cameras, with their standard deviations.

        Examples
        --------
        >>> from labcal import examples, load_target, pipeline
        >>> made = pipeline.calibrate(load_target(examples.TARGET), examples.detections())
        >>> (pair,) = made.pairs()
        >>> abs(pair.baseline_mm - 200.0) < 3 * pair.baseline_sigma_mm
        True
        """
        return self.found.pairs()

    def expected_errors(self) -> ExpectedErrors:
        """Return the errors to expect of points where the target was, of dots like these, mm.

        Examples
        --------
        >>> from labcal import examples, load_target, pipeline
        >>> made = pipeline.calibrate(load_target(examples.TARGET), examples.detections())
        >>> depth = made.expected_errors().depth
        >>> 0.0 < depth.noise_mm < depth.calibration_mm
        True
        """
        return self.found.expected_errors()

    @property
    def places(self) -> DotPlaces | None:
        """Places of the dots on the print, and the views that gave them; None if dots were not freed."""
        if self.found.freed is None:
            return None
        places = measured_places(self.found.freed, self.found.sources.print_share)
        return places.model_copy(update={"calibrated_on": self.calibrated_on})
