"""Calibration of cameras from boards on one plate, whose poses relative to each other are unknown.

Each camera is calibrated alone with every picture of a board as a view of its own. Pictures that show two
boards, or the same board to two cameras, then place all boards and cameras; the rig is adjusted with one pose
of the plate a view, and the boards' poses on the plate among the unknowns.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.observations import observations_of
from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.agreeing_views import SingleCameras
from labcal.calibrate.assembled import assembled_rig, recorded_rig, refuse_far
from labcal.calibrate.boards.board_motion import BoardsAdjusted, adjust_boards, adjust_known_boards
from labcal.calibrate.boards.plate import Plate, plate_of
from labcal.calibrate.dot_treatment import DotDecision, DotTreatment
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_start import require_adjustable
from labcal.calibrate.rig_start import rig_start
from labcal.calibrate.single_calibration import AdjustedDots, HandheldSettings
from labcal.calibrate.usable_dots import unmeasured_pictures, usable_dots
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.run.threads import one_blas_thread
from labcal.targets.board_set import BoardSet

_MOST_TIMES = 4
"""Calibrations until no picture contradicts the others."""


@one_blas_thread()
def calibrate_rigid_boards(
    detections: Detections, boards: BoardSet, lens: str, settings: HandheldSettings
) -> HandheldCalibration:
    """Calibrate every camera in the detections, their places relative to the first, and those of boards.

    Parameters
    ----------
    detections : Detections
        Numbered as dots of the set; only those flagged ``ok`` enter.
    boards : BoardSet
        On one plate. Stated places are kept.
    lens : str
    settings : HandheldSettings

    Raises
    ------
    UnknownNameError
        There is no such lens model.
    InputError
        Dots are to be freed; the views do not link all cameras and boards; or as of
        :func:`~labcal.calibrate.handheld.calibrate_handheld`.
    """
    require_adjustable(lens)
    refuse_freed(settings, boards)
    usable, left_out = usable_dots(detections, boards), unmeasured_pictures(detections)
    for number in range(_MOST_TIMES):
        plate = plate_of(usable, detections.cameras, boards, (lens, settings))
        wrong = plate.contradictory() if number + 1 < _MOST_TIMES else []
        if not wrong:
            break
        out = {(one.camera, plate.views[one.view]) for one in wrong}
        pictures = zip(usable.camera.tolist(), usable.view.tolist(), strict=True)
        usable = usable.where(np.array([picture not in out for picture in pictures], dtype=bool))
        reasons = (f"view '{plate.views[one.view]}' of camera '{one.camera}': {one.reason}" for one in wrong)
        left_out = (*left_out, *reasons)
    return _in_rig(replace(plate, left_out=(*left_out, *plate.left_out)), settings)


def _in_rig(plate: Plate, settings: HandheldSettings) -> HandheldCalibration:
    """Adjust the rig and the boards on their plate."""
    names, boards = tuple(camera.name for camera in plate.cameras), plate.boards
    observations = observations_of(plate.entering, boards, names, plate.views)
    start = rig_start([camera.single for camera in plate.cameras], boards.points())
    adjust = adjust_boards if plate.open_places else adjust_known_boards
    found = adjust(start, observations, boards, Lenses(settings.lenses), settings.eccentricity_rounds)
    whole = AdjustedDots(found.adjusted, observations, None)
    refuse_far(whole, plate.entering, boards)
    Rig.of(dict(zip(names, found.adjusted.state.cameras, strict=True)))  # raises beyond bounds of sense
    sigma = _sigmas(found)
    placed = found.boards.with_sigmas(sigma) if plate.open_places else found.boards
    single = SingleCameras(plate.cameras, plate.entering, plate.left_out)
    made = assembled_rig(single, whole, placed, _decision(settings), None)
    kept = settings.start_rig if settings.lenses is Lenses.FIXED else None
    rig = made.rig if len(names) == 1 else recorded_rig(made, plate.entering, placed, (None, kept))
    return replace(made, rig=rig, boards=placed)


def _sigmas(found: BoardsAdjusted) -> Float64[np.ndarray, "boards 6"]:
    """Return standard deviations of the poses of boards: rotation (rad), then origin (mm)."""
    return np.asarray(np.sqrt(np.maximum(np.diagonal(found.covariance, axis1=1, axis2=2), 0.0)))


def _decision(settings: HandheldSettings) -> DotDecision:
    """Return the treatment of dots, which are where they are declared on each board."""
    asked = DotTreatment(settings.dot_places)
    return DotDecision(
        asked, DotTreatment.DECLARED, "as declared on each board; boards as found on their plate"
    )


def refuse_freed(settings: HandheldSettings, boards: BoardSet) -> None:
    """Raise where dots are to be freed, or measured places are given."""
    if settings.dot_places == DotTreatment.FREED or settings.dots is not None:
        raise InputError(
            f"Dots of several boards ('{boards.name}') are taken as declared: they cannot be freed, nor kept "
            "where they were measured. Calibrate from one board to free its dots."
        )
