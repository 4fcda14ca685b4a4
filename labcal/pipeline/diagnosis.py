"""Diagnosis of a shoot: what is wrong with it, what that costs, and how to mend it."""

import os
from typing import TYPE_CHECKING, cast

from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig
from labcal.correspond.boards_table import on_target
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import read_detections
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.pipeline.detection import measure_pictures
from labcal.pipeline.pages import claimed_page, page_maker
from labcal.run.progress import Progress
from labcal.targets.catalogue import AnyTarget
from labcal.targets.one_kind import single_board

if TYPE_CHECKING:
    from labcal.correspond.picture_set import AnyPictures
    from labcal.guide.diagnosis.diagnosis import Diagnosis
    from labcal.report.page.output import PageOutput

_VIDEOS = frozenset(
    [".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm", ".mpg", ".mpeg", ".wmv", ".mts", ".3gp"]
)

_TAKES = "A diagnosis takes"
_ELSE = "Or calibrate from all, which says what is wrong with the pictures of each: 'labcal calibrate'."


def diagnose(
    source: "Detections | AnyPictures",
    target: AnyTarget | AnyPath | None = None,
    rig: Rig | AnyPath | None = None,
    workers: int = 1,
    progress: Progress | None = None,
    *,
    page: "PageOutput | AnyPath | None" = None,
) -> "Diagnosis":
    """Name what is wrong with a shoot, with its cost in mm and how to mend it, the most harmful first.

    Parameters
    ----------
    source : Detections, PictureSet, Shoot, path or sequence of paths
        A shoot, or pictures, in which dots are found; or dots, or the table of them, where checks of pictures
        are not made.
    target : AnyTarget, path or str, optional
        What the pictures are said to show; a shoot brings its own.
    rig : Rig or path, optional
        A calibration of these cameras, which names the lens model.
    workers : int
        Processes at work on pictures; the result is the same for any number.
    progress : Progress, optional
        Of the detection.
    page : path, optional
        A page to write, ``.html``: what is wrong, with the pictures that show it.

    Returns
    -------
    Diagnosis
        Findings, each with cameras, views, harm in mm and p-value; and checks that could not be made.

    Raises
    ------
    InputError
        There are no such pictures, the target is not known, or no picture could be read at all.
    OutputError
        The page may not be written.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> found = pipeline.diagnose(examples.detections(), examples.TARGET)
    >>> [one.check.value for one in found.findings]
    ['poor-coverage']
    """
    from labcal.correspond.measure import detections_of
    from labcal.correspond.picture_set import open_pictures, target_shown
    from labcal.guide.diagnosis.diagnosing import diagnosed
    from labcal.guide.diagnosis.evidence import Evidence

    output = claimed_page(page, [source, rig])
    known = read_rig(as_path(rig)) if isinstance(rig, str | os.PathLike) else rig
    dots = source if isinstance(source, Detections) else _table(source)
    if dots is not None:
        shown = single_board(target_shown(target, None, rig=known).target, _TAKES, _ELSE)
        evidence = Evidence(shown, on_target(dots, shown), rig=known)
    else:
        pictures = open_pictures(cast("AnyPictures", source))
        shown = single_board(pictures.target(target, known), _TAKES, _ELSE)
        found = measure_pictures(pictures, shown, workers=workers, progress=progress)
        evidence = Evidence(shown, detections_of(found), pictures.shoot, tuple(found), known)
    diagnosis = diagnosed(evidence)
    if output is not None:
        from labcal.report.diagnosis_page import diagnosis_page

        arguments = {"source": source, "target": target, "rig": rig, "page": output.path}
        output.write(diagnosis_page(diagnosis, page_maker(output, "diagnose", arguments)))
    return diagnosis


def _table(source: object) -> Detections | None:
    """Return the dots where a table of them is given; None of pictures."""
    from labcal.correspond.dot_source import is_dot_table

    if isinstance(source, str | os.PathLike):
        path = as_path(source)
        if path.is_file() and path.suffix.lower() in _VIDEOS:
            raise InputError(
                f"{path} is a video, and pictures are diagnosed. Take pictures out of it with 'labcal "
                f"capture', from the source video:{path}, and diagnose the shoot."
            )
        if is_dot_table(path):
            return read_detections(path)
    return None
