"""Calibrations of all parts of the views but one, and lengths in that one, in turn."""

import numpy as np

from labcal.arrays import Lengths
from labcal.calibrate.calibrated import calibrated
from labcal.calibrate.calibration import Calibration
from labcal.calibrate.epipolar_residual import epipolar_rms
from labcal.calibrate.single_calibration import HandheldSettings
from labcal.correspond.boards_points import with_known_lengths
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.evaluate.held_out_lengths import HeldOutLengths, HeldOutPart
from labcal.evaluate.own_lengths import LengthError, LengthErrors, errors_of_lengths
from labcal.evaluate.scored_views import ScoredPart
from labcal.reconstruct.reconstruction import reconstruct_centres
from labcal.run.progress import Progress
from labcal.targets.catalogue import AnyTarget
from labcal.wording import counted, listed

PARTS = 4
"""Parts of the views where none are asked for: each calibration sees three quarters of them."""
_FEWEST = 2


def held_out_lengths(
    detections: Detections,
    target: AnyTarget,
    lens: str | None,
    settings: HandheldSettings,
    parts: int,
    progress: Progress,
) -> HeldOutLengths:
    """Calibrate as often as there are parts of the views, and measure each part by the others' cameras.

    Parameters
    ----------
    detections : Detections
    target : AnyTarget
        Lengths are compared with its own: as declared or, where the settings keep or free its dots, as
        measured in the other views.
    lens : str or None
        As of :func:`~labcal.calibrate.calibrated.calibrated`.
    settings : HandheldSettings
    parts : int
        Views are dealt to so many parts in turn, so that each part has views from everywhere.
    progress : Progress

    Raises
    ------
    InputError
        There are fewer parts than two or more than views, or the others of a part are not enough.
    """
    views = detections.views
    if not _FEWEST <= parts <= len(views):
        raise InputError(
            f"{counted(len(views), 'view')} can be held out in {_FEWEST} to {len(views)} parts, but {parts} "
            "were asked for."
        )
    progress.start("calibrations", parts)
    made, scored, epipolar = list[Calibration](), list[LengthErrors](), list[float]()
    for number in range(parts):
        held = views[number::parts]
        found, errors, squares = _of_part(detections, target, lens, settings, held)
        made.append(found)
        scored.append(errors)
        epipolar.append(squares)
        progress.advance()
    return _together(made, scored, np.array(epipolar))


def _of_part(
    detections: Detections,
    target: AnyTarget,
    lens: str | None,
    settings: HandheldSettings,
    held: tuple[str, ...],
) -> tuple[Calibration, LengthErrors, float]:
    """Return a calibration from all other views, the errors in those held out, and their epipolar RMS."""
    dots = detections.where(np.isin(detections.view, held))
    try:
        made = calibrated(detections, target, lens, settings, held)
        points = with_known_lengths(reconstruct_centres(made.rig, dots, target).points, target)
        reference = made.places or settings.places or target
        return (
            made,
            errors_of_lengths(points, reference, made.calibrated_on),
            epipolar_rms(made.rig, dots, target),
        )
    except InputError as error:
        raise InputError(f"With {listed(held)} held out: {error}") from error


def _together(made: list[Calibration], scored: list[LengthErrors], epipolar: Lengths) -> HeldOutLengths:
    """Return the errors of all parts as one."""
    error = np.concatenate([one.error for one in scored])
    weight = np.array([one.n for one in scored], dtype=np.float64)
    scales = np.array([one.scale_ppm for one in scored])
    parts = tuple(
        HeldOutPart(
            views=one.views_scored,
            calibrated_on=len(calibration.found.views),
            n=one.n,
            rms_mm=one.length_error_mm.rms,
            scale_ppm=one.scale_ppm,
            warnings=calibration.warnings,
        )
        for calibration, one in zip(made, scored, strict=True)
    )
    views = tuple(name for part in parts for name in part.views)
    return HeldOutLengths(
        n=len(error),
        length_error_mm=LengthError(max=float(np.abs(error).max()), rms=float(np.sqrt((error**2).mean()))),
        epipolar_rms_px=float(np.sqrt(np.average(epipolar**2, weights=weight))),
        scale_ppm=float(np.average(scales, weights=weight)),
        scored_views=ScoredPart(
            sum(one.n_ok for one in scored), views, sum(one.views_calibrated_on or 0 for one in scored)
        ),
        error=error,
        lens=", ".join(dict.fromkeys(one.lens for one in made)),
        parts=parts,
    )
