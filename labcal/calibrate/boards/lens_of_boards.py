"""The lens model of cameras that see several boards: every picture of a board counts as a view."""

from dataclasses import replace

import numpy as np

from labcal.calibrate.boards.rigid_boards import refuse_freed
from labcal.calibrate.boards.several import calibrate_boards
from labcal.calibrate.default_lens import calibrate_with_default_lens
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_candidates import AUTO
from labcal.calibrate.lens_choice import LensChoice, choose_lens
from labcal.calibrate.single_calibration import HandheldSettings
from labcal.correspond.boards_table import by_board
from labcal.correspond.detections import Detections
from labcal.run.progress import Progress
from labcal.targets.board_set import BoardSet, Mounting


def calibrate_boards_with_chosen_lens(
    detections: Detections, boards: BoardSet, lens: str | None, settings: HandheldSettings, progress: Progress
) -> tuple[LensChoice, HandheldCalibration]:
    """Choose a lens model by held-out views of single boards, and calibrate from all boards.

    Parameters
    ----------
    detections : Detections
        Numbered as dots of the set by :func:`~labcal.correspond.boards_table.on_target`.
    boards : BoardSet
    lens : {"auto"} or None
        All candidates are tried; or, where left out, the usual lens unless the views ask for another.
    settings : HandheldSettings
    progress : Progress
        Of the choice.

    Raises
    ------
    InputError
        Dots are to be freed, a camera has too few views of boards; or as of
        :func:`~labcal.calibrate.boards.several.calibrate_boards`.
    """
    refuse_freed(settings, boards)
    settings = replace(settings, dot_places=DotTreatment.DECLARED)
    measured = detections.where(detections.ok)
    each, alone = measured, boards
    if boards.mounting is Mounting.RIGID:
        names = np.array(boards.names)[boards.board_number[measured.index[:, 0]]]
        each = by_board(measured, names)
        alone = boards.model_copy(update={"mounting": Mounting.SEPARATE, "places": None})
    if lens == AUTO:
        choice = choose_lens(each, alone, settings, progress)
        return choice, calibrate_boards(detections, boards, choice.lens, settings)

    def rig(chosen: str) -> HandheldCalibration:
        return calibrate_boards(detections, boards, chosen, settings)

    return calibrate_with_default_lens(each, alone, settings, progress, rig)
