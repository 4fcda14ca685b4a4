"""A complete calibration: lens choice, held-out views, calibration, warnings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.boards.lens_of_boards import calibrate_boards_with_chosen_lens
from labcal.calibrate.boards.several import board_warnings, calibrate_boards
from labcal.calibrate.budget.shared_errors import measured_places
from labcal.calibrate.calibration_warnings import calibration_warnings
from labcal.calibrate.default_lens import calibrate_with_default_lens
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_candidates import AUTO, DEFAULT_LENS
from labcal.calibrate.lens_choice import LensChoice, choose_lens
from labcal.calibrate.lens_start import require_adjustable
from labcal.calibrate.parallel_rig import parallel_notes
from labcal.calibrate.print_warnings import warnings_of_print
from labcal.cameras.camera_pair import CameraPair
from labcal.cameras.expected_errors import ExpectedErrors
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.view_roles import HoldOut, held_out_views, holds_none, warning_of_test_views
from labcal.errors import InputError
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable, PublicObject
from labcal.run.progress import NoProgress, Progress
from labcal.targets.board_set import BoardSet
from labcal.targets.catalogue import AnyTarget
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


def calibrated(
    detections: Detections,
    target: AnyTarget,
    lens: str | None = None,
    settings: HandheldSettings | None = None,
    hold_out: HoldOut = (),
    progress: Progress | None = None,
) -> Calibration:
    """Calibrate every camera in the detections, and their places relative to the first.

    Parameters
    ----------
    detections : Detections
        Only dots flagged ``ok`` enter.
    target : AnyTarget
    lens : str, optional
        A lens model, or ``auto``: held-out views choose among all candidates. Where left out, that of the rig
        to start from; without one :data:`DEFAULT_LENS`, unless the views ask for another lens.
    settings : HandheldSettings, optional
    hold_out : int or sequence of str
        Views that do not enter: their names, or how many, spread evenly.
    progress : Progress, optional
        Of the choice of a lens.

    Raises
    ------
    UnknownNameError, InputError
        As of :func:`~labcal.calibrate.handheld.calibrate_handheld` and, of ``auto``, of
        :func:`~labcal.calibrate.lens_choice.choose_lens`; there are no such views to hold out, or a rig to
        start from is given with ``auto``.
    """
    settings = settings or HandheldSettings()
    refuse_contradictory(lens, settings)
    held_out = held_out_views(detections.views, hold_out)
    entering = detections.where(~np.isin(detections.view, held_out))
    choice, lens = None, lens or _lens_of(settings)
    if isinstance(target, BoardSet):
        if lens is None or lens == AUTO:
            choice, found = calibrate_boards_with_chosen_lens(
                entering, target, lens, settings, progress or NoProgress()
            )
            lens = choice.lens
        else:
            found = calibrate_boards(entering, target, lens, settings)
    elif lens is None:
        choice, found = calibrate_with_default_lens(entering, target, settings, progress or NoProgress())
        lens = choice.lens
    elif lens == AUTO:
        choice, found = _with_chosen_lens(entering, target, settings, progress or NoProgress())
        lens = choice.lens
    else:
        found = calibrate_handheld(entering, target, lens, settings)
    kept = settings.start_rig if settings.lenses is Lenses.FIXED else None
    before = () if settings.places is None else settings.places.calibrated_on
    learned = tuple(dict.fromkeys((*found.views, *(() if kept is None else kept.calibrated_on), *before)))
    asked = bool(held_out) or holds_none(hold_out, detections.views)
    tested = None if asked else warning_of_test_views(entering)
    notes = parallel_notes(found.rig, started=settings.start_rig is not None)
    warnings = (
        *(() if tested is None else (tested,)),
        *warnings_of_print(found, settings),
        *calibration_warnings(found, lens, target.name),
        *board_warnings(found),
        *notes,
    )
    return Calibration(found, lens, choice, held_out, learned, warnings)


def _with_chosen_lens(
    entering: Detections, target: AnyTarget, settings: HandheldSettings, progress: Progress
) -> tuple[LensChoice, HandheldCalibration]:
    """Choose the lens with the dots treated as they will be, and calibrate with it.

    Whether dots are freed depends on the lens: it is decided with :data:`DEFAULT_LENS` first, and with the
    lens that was chosen. Where both differ, the lens is chosen once more.
    """
    treatment = settings.dot_places
    if treatment is DotTreatment.AUTO:
        treatment = _treatment_with(DEFAULT_LENS, entering, target, settings)
    choice = choose_lens(entering, target, replace(settings, dot_places=treatment), progress)
    found = calibrate_handheld(entering, target, choice.lens, settings)
    if found.dot_decision.treatment is treatment:
        return choice, found
    treatment = found.dot_decision.treatment
    choice = choose_lens(entering, target, replace(settings, dot_places=treatment), progress)
    again = calibrate_handheld(entering, target, choice.lens, replace(settings, dot_places=treatment))
    return choice, replace(again, dot_decision=found.dot_decision)


def _treatment_with(
    lens: str, entering: Detections, target: AnyTarget, settings: HandheldSettings
) -> DotTreatment:
    """Return the treatment of the dots with a lens; as declared where it does not suit."""
    try:
        return calibrate_handheld(entering, target, lens, settings).dot_decision.treatment
    except InputError:
        return DotTreatment.DECLARED


def refuse_contradictory(lens: str | None, settings: HandheldSettings) -> None:
    """Raise where a lens model and settings cannot go together, whatever the dots are.

    Parameters
    ----------
    lens : str or None
        As of :func:`calibrated`.
    settings : HandheldSettings

    Raises
    ------
    UnknownNameError
        There is no such lens model.
    InputError
        The lens has nothing to calibrate, a rig to start from is given with ``auto``, or lenses are to be
        kept that no rig gives.
    """
    if lens == AUTO and settings.start_rig is not None:
        raise InputError(f"`lens='{AUTO}'` tries lens models from the beginning. Leave `start` out.")
    if lens not in (None, AUTO):
        require_adjustable(lens)
    if settings.lenses is Lenses.FIXED and settings.start_rig is None:
        raise InputError("The lenses of a rig can be kept only where there is one. Add `start='rig.json'`.")


def _lens_of(settings: HandheldSettings) -> str | None:
    """Return the lens model where none is named: that of the rig to start from, if all are alike.

    None without such a rig: the views decide.
    """
    if settings.start_rig is None:
        return None
    lenses = {record.lens for record in settings.start_rig.cameras.values()}
    return lenses.pop() if len(lenses) == 1 else DEFAULT_LENS
