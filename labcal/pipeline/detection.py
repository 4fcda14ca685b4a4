"""Dots from pictures, and pictures at a glance."""

from typing import TYPE_CHECKING

from labcal.arguments import settings_of
from labcal.correspond.detections import Detections
from labcal.paths import AnyPath
from labcal.pipeline.pages import claimed_page, page_maker
from labcal.run.progress import Progress, progress_of
from labcal.shoot.tone_curve import AnyToneCurve, ToneCurve, find_tone_curve
from labcal.targets.catalogue import AnyTargets

if TYPE_CHECKING:
    from labcal.correspond.measure import Measurement
    from labcal.correspond.picture_set import AnyPictures
    from labcal.detect.settings import DetectSettings
    from labcal.report.inspection import Inspection
    from labcal.report.page.output import PageOutput
    from labcal.targets.code_text import PrintedTarget


def measure_pictures(
    pictures: "AnyPictures",
    target: "AnyTargets | PrintedTarget | None" = None,
    settings: "DetectSettings | None" = None,
    tone_curve: AnyToneCurve | AnyPath = ToneCurve.LINEAR,
    workers: int = 1,
    progress: Progress | None = None,
) -> "list[Measurement]":
    """Find the dots in pictures, and tell of each picture what came of it.

    Parameters
    ----------
    pictures : PictureSet, Shoot, path or sequence of paths
        As for :func:`~labcal.correspond.picture_set.open_pictures`, which takes the cameras' names, too.
    target : AnyTargets or PrintedTarget, optional
        What the pictures show; a shoot brings its own, and a print with a code tells it in any sharp picture.
        Several in a list are boards side by side.
    settings : DetectSettings, optional
        Thresholds, sizes and counts of the detector; the defaults where left out.
    tone_curve : str, path or AnyToneCurve
        The camera's, which is undone first: by itself, by name, or as a CSV file with the columns `value`
        and `light`.
    workers : int
        Processes at work; the results are the same for any number.
    progress : Progress, optional

    Returns
    -------
    list of Measurement
        In the order of the pictures; one that cannot be used is a result with a reason.

    Raises
    ------
    InputError
        There are no such pictures, the target is not known, or no code of a print tells it.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot")
    >>> first, *others = pipeline.measure_pictures(shoot)
    >>> first.indexed, first.source.view, first.source.camera, first.dots.flag.count("ok")
    (True, 'hand-0', 'left', 88)
    """
    from labcal.correspond.measure import measure_pictures as measure_sources
    from labcal.correspond.picture_set import open_pictures
    from labcal.detect.settings import DetectSettings
    from labcal.run.executor import open_executor

    curve, receiver = find_tone_curve(tone_curve), progress_of(progress)
    how = settings_of(settings, DetectSettings)
    opened = open_pictures(pictures)
    with open_executor(workers) as executor:
        shown = opened.shown(target, executor, receiver)
        return measure_sources(opened.sources, shown.printed, executor, receiver, curve, how)


def detect(
    pictures: "AnyPictures",
    target: "AnyTargets | PrintedTarget | None" = None,
    settings: "DetectSettings | None" = None,
    tone_curve: AnyToneCurve | AnyPath = ToneCurve.LINEAR,
    workers: int = 1,
    progress: Progress | None = None,
) -> Detections:
    """Find the dots in pictures, and return the table of them.

    Parameters
    ----------
    pictures, target, settings, tone_curve, workers, progress
        As of :func:`measure_pictures`, which tells of each picture by itself.

    Returns
    -------
    Detections
        The dots of all pictures that could be read; positions in px.

    Raises
    ------
    InputError
        As of :func:`measure_pictures`; or no picture could be read at all.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot")
    >>> pipeline.detect(shoot)
    Detections(views=2, cameras=['left', 'right'], dots=352, ok=352)
    >>> loose = pipeline.open_pictures("shoot/images", "_left=a,_right=b")
    >>> pipeline.detect(loose, examples.TARGET).cameras
    ('a', 'b')
    """
    from labcal.correspond.measure import detections_of

    return detections_of(measure_pictures(pictures, target, settings, tone_curve, workers, progress))


def inspect(
    pictures: "AnyPictures",
    target: AnyTargets | None = None,
    settings: "DetectSettings | None" = None,
    workers: int = 1,
    progress: Progress | None = None,
    *,
    page: "PageOutput | AnyPath | None" = None,
) -> "Inspection":
    """Return pictures at a glance: exposure, sharpness and dots of each, and a contact sheet of all.

    Parameters
    ----------
    pictures, target, settings, workers, progress
        As of :func:`measure_pictures`.
    page : path, optional
        A page to write, ``.html``, with all pictures and figures.

    Returns
    -------
    Inspection
        Figures of every picture and camera, and the contact sheet, which its `save` writes.

    Raises
    ------
    InputError
        There are no such pictures, the target is not known, or no picture could be read at all.
    OutputError
        The page may not be written.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> found = pipeline.inspect(examples.shoot("shoot"))
    >>> found.pictures[0].dots, found.pictures[0].saturated_share
    (88, 0.0)
    >>> round(found.cameras["left"].coverage, 2)
    0.52
    >>> found.save("sheet.png")
    """
    from labcal.correspond.picture_set import open_pictures
    from labcal.report.inspection import inspection

    opened, progress = open_pictures(pictures), progress_of(progress)
    output = claimed_page(page, opened.given, opened.sources)
    shown = opened.target(target)
    measurements = measure_pictures(opened, shown, settings, workers=workers, progress=progress)
    found = inspection(opened, measurements, shown, progress)
    if output is not None:
        from labcal.report.inspection_page import inspection_page

        given = {"pictures": opened.given, "target": target, "page": output.path}
        output.write(inspection_page(found, page_maker(output, "inspect", given)))
    return found
