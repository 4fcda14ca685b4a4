"""Errors of lengths in views held out from the calibration, without a table of points."""

from typing import TYPE_CHECKING

from labcal.arguments import one_text, settings_of, whole_number
from labcal.correspond.boards_table import on_target
from labcal.correspond.detections import Detections
from labcal.paths import AnyPath
from labcal.pipeline.given import dots_of, shown_by
from labcal.run.progress import Progress, progress_of
from labcal.shoot.dataset import Shoot
from labcal.targets.catalogue import AnyTargets

if TYPE_CHECKING:
    from labcal.calibrate.handheld import HandheldSettings
    from labcal.evaluate.held_out_lengths import HeldOutLengths


def evaluate_held_out(
    source: Shoot | AnyTargets,
    detections: Detections | AnyPath | None = None,
    lens: str | None = None,
    settings: "HandheldSettings | None" = None,
    parts: int | None = None,
    progress: Progress | None = None,
) -> "HeldOutLengths":
    """Calibrate from a part of the views and measure the rest, until each view was measured once.

    The target's own lengths are no proof in pictures that calibrated: here every length is measured by
    cameras that have not seen its view.

    Parameters
    ----------
    source : Shoot, AnyTarget, path or str
        A shoot or its folder, of which all views count; or the target that the dots are of, or its name.
    detections : Detections or path, optional
        Dots, or the table of them; those of the shoot are found in its pictures where left out.
    lens : str, optional
        As of :func:`~labcal.pipeline.calibrate`.
    settings : HandheldSettings, optional
        Of the calibrations. Where dots are freed, lengths are compared with the print as the other views
        found it.
    parts : int, optional
        In how many parts views are held out, one after the other; 4 if left out, or fewer of fewer views.
    progress : Progress, optional

    Returns
    -------
    HeldOutLengths
        Errors of lengths in mm, of all parts together and of each.

    Raises
    ------
    UnknownNameError, InputError
        As of :func:`~labcal.pipeline.calibrate`; or there are no such parts.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> pipeline.evaluate_held_out(examples.TARGET, examples.detections(), parts=2)
    HeldOutLengths(n=30624, rms=0.0463 mm, max=0.329 mm, scale=+33.2 ppm, parts=2)
    """
    from labcal.calibrate.handheld import HandheldSettings
    from labcal.evaluate.calibrations_in_parts import PARTS, held_out_lengths

    lens = None if lens is None else one_text(lens, "lens")
    settings, progress = settings_of(settings, HandheldSettings), progress_of(progress)
    shown = shown_by(source)
    target = shown.target if isinstance(shown, Shoot) else shown
    dots = on_target(dots_of(detections, shown, progress), target)
    count = min(PARTS, len(dots.views)) if parts is None else whole_number(parts, "parts", 2)
    return held_out_lengths(dots, target, lens, settings, count, progress)
