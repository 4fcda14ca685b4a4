"""Calibration from several boards in the same pictures, on one plate or moved each by itself."""

from dataclasses import replace

from labcal.calibrate.boards.rigid_boards import calibrate_rigid_boards, refuse_freed
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.single_calibration import HandheldSettings
from labcal.correspond.detections import Detections
from labcal.targets.board_set import BoardSet, Mounting

_TIMES, _LEAST_PX = 3.0, 0.1
"""RMS in the rig over that of the cameras alone, and how much more, from which on boards are doubted."""


def calibrate_boards(
    detections: Detections, boards: BoardSet, lens: str, settings: HandheldSettings
) -> HandheldCalibration:
    """Calibrate cameras from several boards.

    Parameters
    ----------
    detections : Detections
        Numbered as dots of the set by :func:`~labcal.correspond.boards_table.on_target`.
    boards : BoardSet
    lens : str
        A lens model by name.
    settings : HandheldSettings

    Raises
    ------
    UnknownNameError, InputError
        There is no such lens model; dots are to be freed; or as of
        :func:`~labcal.calibrate.handheld.calibrate_handheld`.
    """
    refuse_freed(settings, boards)
    if boards.mounting is Mounting.RIGID:
        return calibrate_rigid_boards(detections, boards, lens, settings)
    as_declared = replace(settings, dot_places=DotTreatment.DECLARED)
    return calibrate_handheld(detections, boards, lens, as_declared)


def board_warnings(found: HandheldCalibration) -> list[str]:
    """Return the warning that boards are not where one plate would have them, in words."""
    if found.boards is None:
        return []
    together, alone = found.rms_px, found.rms_alone_px
    if together < max(_TIMES * alone, alone + _LEAST_PX):
        return []
    words = (
        f"in the rig the dots are off by {together:.2g} px (RMS), each board by itself only by {alone:.2g} "
        "px: the boards moved relative to each other, or pictures of a view were not taken together. Boards "
        "that move separately are described with 'mounting: separate'"
    )
    return [words]
