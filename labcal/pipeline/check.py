"""Check of a calibration by new views."""

import os
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.arguments import settings_of
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig
from labcal.correspond.boards_table import each_board
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import read_detections
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.pipeline.detection import detect
from labcal.pipeline.fixed_marks import check_by_marks, is_table
from labcal.pipeline.pages import claimed_page, page_maker
from labcal.pipeline.print_places import dots_beside, given_places
from labcal.run.progress import Progress, progress_of
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces

if TYPE_CHECKING:
    from labcal.correspond.named_pixels import NamedPixels
    from labcal.correspond.picture_set import AnyPictures
    from labcal.guide.check_settings import CheckSettings
    from labcal.guide.rig_check import RigCheck
    from labcal.reconstruct.found_marks import FoundMarks
    from labcal.report.page.output import PageOutput


def check(
    rig: Rig | AnyPath,
    source: "Detections | NamedPixels | FoundMarks | AnyPictures",
    target: AnyTarget | DotPlaces | AnyPath | None = None,
    settings: "CheckSettings | None" = None,
    progress: Progress | None = None,
    *,
    page: "PageOutput | AnyPath | None" = None,
) -> "RigCheck":
    """Check whether a calibration is still valid, by new views of a target, or of marks that stay in place.

    Parameters
    ----------
    rig : Rig or path
        With the covariance of its calibration.
    source : Detections, NamedPixels, FoundMarks, PictureSet, Shoot, path or sequence of paths
        Dots or the table of them, a shoot, or pictures, in which dots are found: three views or more. Of
        fixed marks their pixels, the table of them, or pictures with `markers`; one view is enough.
    target : AnyTarget, DotPlaces, path or str, optional
        What the pictures show; if left out, the target of the shoot, or else the one that the rig was
        calibrated with. Of a print that a calibration with free dots measured, its dots, or the file of them,
        which finds smaller changes; the file beside that of the rig, ``RIG-dots.json``, is taken by itself
        where it is of this target.
    settings : CheckSettings, optional
        The log that the check is added to; places and kinds of fixed marks.
    progress : Progress, optional
        Of the detection.
    page : path, optional
        A page to write, ``.html``: the verdict, what changed, and the log over time.

    Returns
    -------
    RigCheck
        Verdict, p-value, changes by camera, their cost in mm; :meth:`RigCheck.mended` corrects the rig.

    Raises
    ------
    InputError
        The rig states no covariance, pictures are not of its cameras or show no target, or no rig explains
        the dots.
    OutputError
        Log or page may not be written.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> rig = pipeline.calibrate(examples.TARGET, examples.detections()).found.rig
    >>> found = pipeline.check(rig, examples.detections(), examples.TARGET)
    >>> found.verdict.value, found.p_value > 0.01
    ('valid', True)
    """
    from labcal.correspond.paths_read import paths_read
    from labcal.correspond.picture_set import target_shown
    from labcal.guide.check_log import KIND, CheckRecord, read_check_log, write_check_log
    from labcal.guide.check_settings import CheckSettings
    from labcal.guide.checking import checked
    from labcal.run.claims import FileOutput, claim_outputs

    how = settings_of(settings, CheckSettings)
    given = [rig, *(source if isinstance(source, Sequence) and not isinstance(source, str) else [source])]
    output = claimed_page(page, [*given, how.log])
    records: tuple[CheckRecord, ...] = ()
    if how.log is not None:
        log = as_path(how.log)
        read = [one for one in given if isinstance(one, str | os.PathLike)]
        claim_outputs([FileOutput(log, KIND)], paths_read(read), force=True)
        records = read_check_log(log) if log.is_file() and log.stat().st_size else ()
    used = rig if isinstance(rig, Rig) else read_rig(as_path(rig))
    if how.places is None:
        shown = given_places(target)
        named = shown.target if isinstance(shown, DotPlaces) else shown
        dots, board = _dots(source, named, used, progress_of(progress))
        known = shown if isinstance(shown, DotPlaces) else board or target_shown(named, None, rig=used).target
        if not isinstance(known, DotPlaces):
            dots, each = each_board(dots, known)
            known = dots_beside(rig, each)
        found = checked(used, dots, known)
    else:
        found = check_by_marks(used, source, target, how, progress)
    if how.log is not None:
        date = how.date or datetime.now(UTC).isoformat(timespec="seconds")
        name = "" if isinstance(rig, Rig) else Path(as_path(rig)).name
        records = (*records, CheckRecord.of(found, date, name, how.temperature_c, how.note))
        write_check_log(as_path(how.log), records)
    if output is not None:
        from labcal.report.check_page import check_page

        arguments = {"rig": rig, "source": source, "target": target, "page": output.path}
        output.write(check_page(found, records, page_maker(output, "check", arguments)))
    return found


def _dots(
    source: "Detections | NamedPixels | FoundMarks | AnyPictures",
    target: AnyTarget | AnyPath | None,
    rig: Rig,
    progress: Progress,
) -> tuple[Detections, AnyTarget | None]:
    """Return the dots, and the target of a shoot."""
    from labcal.correspond.dot_source import is_dot_table
    from labcal.correspond.named_pixels import NamedPixels
    from labcal.correspond.named_pixels_csv import is_pixels
    from labcal.correspond.picture_set import open_pictures
    from labcal.reconstruct.found_marks import FoundMarks

    if isinstance(source, Detections):
        return source, None
    if isinstance(source, NamedPixels | FoundMarks) or is_table(source, is_pixels):
        raise InputError(
            "Named pixels are given, but no places of their points. Give `places`, the table that "
            "'labcal measure' wrote of the same marks before."
        )
    if isinstance(source, str | os.PathLike) and is_dot_table(source):
        return read_detections(as_path(source)), None
    opened = open_pictures(source)
    shown = opened.target(target, rig)
    if not opened.sources:
        raise InputError("No picture is given. Give a shoot, pictures, or the table of their dots.")
    return detect(opened, shown, progress=progress), shown
