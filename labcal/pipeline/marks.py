"""Marks in pictures, as named pixels that `measure` makes points of."""

import os
from typing import TYPE_CHECKING

from labcal.arguments import wrong_type
from labcal.cameras.rig import Rig
from labcal.correspond.mark_search import MarkSearch
from labcal.correspond.named_pixels import NamedPixels
from labcal.errors import InputError, UnknownNameError
from labcal.estimators.model import Model
from labcal.paths import AnyPath, as_path
from labcal.run.progress import Progress, progress_of
from labcal.shoot.tone_curve import find_tone_curve

if TYPE_CHECKING:
    from labcal.correspond.picture_set import AnyPictures
    from labcal.reconstruct.found_marks import FoundMarks

AnyMarkers = MarkSearch | str | tuple[str, ...] | list[str]
"""Marks to look for as public functions take them."""


def find_marks(
    model: Model | Rig | AnyPath,
    pictures: "AnyPictures",
    markers: AnyMarkers,
    workers: int = 1,
    progress: Progress | None = None,
) -> "FoundMarks":
    """Find the marks in pictures: tags, coded dots, and plain dots, which are matched between the cameras.

    Parameters
    ----------
    model : Model, Rig or path
        Fitted method or cameras that the pixels are meant for, or the file of them.
    pictures : PictureSet, Shoot, path or sequence of paths
        As for :func:`~labcal.correspond.picture_set.open_pictures`, which takes the cameras' names, too.
    markers : MarkSearch, str or sequence of str
        Marks to look for: by name, as ``"apriltag-36h11"`` or ``"ring-23,dots"``, or with settings.
    workers : int
        Processes at work; the results are the same for any number.
    progress : Progress, optional

    Returns
    -------
    FoundMarks
        Named pixels, and what came of each picture: one that cannot be used is a result with a reason.

    Raises
    ------
    InputError
        There are no such pictures or kinds of marks, the model has no such camera, not one picture shows a
        mark, or plain dots are looked for with a fitted method.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot")
    >>> found = pipeline.find_marks(examples.rig(), shoot, pipeline.MarkSearch("dots", mark_diameter=10.0))
    >>> found.pixels.cameras
    ('left', 'right')
    """
    from labcal.correspond.mark_measurement import mark_pixels, measure_marks
    from labcal.correspond.picture_set import open_pictures
    from labcal.correspond.refused_pictures import no_picture_left
    from labcal.detect.marks.mark_kinds import mark_kinds
    from labcal.reconstruct.found_marks import found_marks
    from labcal.reconstruct.reconstruction import load_reconstructor
    from labcal.run.executor import open_executor

    search = mark_search(markers)
    kinds = mark_kinds(search.names)
    used = model if isinstance(model, Model | Rig) else load_reconstructor(as_path(model))
    refuse_pixels(pictures)
    opened = open_pictures(pictures)
    for source in opened.sources:
        if source.camera not in used.cameras:
            kind = "rig" if isinstance(used, Rig) else "model"
            raise UnknownNameError(f"camera in the {kind}", source.camera, tuple(used.cameras))
    sizes = (
        {name: record.size for name, record in used.cameras.items()}
        if isinstance(used, Rig)
        else dict(zip(used.cameras, used.image_sizes, strict=True))
    )
    how = (find_tone_curve(search.tone_curve), search.detector)
    with open_executor(workers) as executor:
        measured = measure_marks(opened.sources, kinds, sizes, how, executor, progress_of(progress))
    if all(one.reason is not None for one in measured):
        raise no_picture_left([(one.source.image, one.reason or "") for one in measured])
    return found_marks(used, measured, mark_pixels(measured, kinds, search.mark_diameter))


def refuse_pixel_sigma(pixel_sigma: float | None) -> None:
    """Raise where a noise is stated of pixels of marks, before they are looked for.

    Raises
    ------
    InputError
        The noise is not None.
    """
    if pixel_sigma is not None:
        raise InputError(
            "Marks that are found have covariances of their own, so that `pixel_sigma` would be dropped. "
            "Leave it out."
        )


def refuse_pixels(given: object) -> None:
    """Raise where named pixels are given in place of pictures.

    Raises
    ------
    InputError
        They are, or their table.
    """
    from labcal.correspond.named_pixels_csv import is_pixels
    from labcal.reconstruct.found_marks import FoundMarks

    one = given[0] if isinstance(given, list | tuple) and len(given) == 1 else given
    is_table = isinstance(one, str | os.PathLike) and as_path(one).is_file() and is_pixels(one)
    if is_table or isinstance(one, NamedPixels | FoundMarks):
        raise InputError(
            "Marks are looked for in pictures, but named pixels are given. Leave `markers` out, or give "
            "pictures."
        )


def mark_search(given: object) -> MarkSearch:
    """Return marks to look for, with settings.

    Raises
    ------
    InputTypeError
        They are of a wrong type.
    """
    if isinstance(given, MarkSearch):
        return given
    if isinstance(given, str):
        return MarkSearch(given)
    if isinstance(given, tuple | list):
        return MarkSearch(tuple(given))
    raise wrong_type(given, "names of kinds of marks, or MarkSearch(...)", "markers")
