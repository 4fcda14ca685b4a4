"""A complete calibration: lens choice, held-out views, calibration, warnings."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.boards.lens_of_boards import calibrate_boards_with_chosen_lens
from labcal.calibrate.boards.several import board_warnings, calibrate_boards
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
from labcal.correspond.detections import Detections
from labcal.correspond.view_roles import HoldOut, held_out_views, holds_none, warning_of_test_views
from labcal.errors import InputError
from labcal.run.progress import NoProgress, Progress
from labcal.targets.board_set import BoardSet
from labcal.targets.catalogue import AnyTarget

if TYPE_CHECKING:
    pass


from labcal.calibrate.calibration import Calibration


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
