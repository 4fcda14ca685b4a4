"""Check of a calibration by marks that stay where they are."""

import os
from collections.abc import Callable
from typing import TYPE_CHECKING

from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.pipeline.marks import find_marks
from labcal.run.progress import Progress

if TYPE_CHECKING:
    from labcal.correspond.detections import Detections
    from labcal.correspond.named_pixels import NamedPixels
    from labcal.correspond.picture_set import AnyPictures
    from labcal.guide.check_settings import CheckSettings
    from labcal.guide.rig_check import RigCheck
    from labcal.reconstruct.found_marks import FoundMarks


def check_by_marks(
    rig: Rig,
    source: "Detections | NamedPixels | FoundMarks | AnyPictures",
    target: object,
    how: "CheckSettings",
    progress: Progress | None,
) -> "RigCheck":
    """Check a rig by new pictures of marks whose places it measured before.

    Parameters
    ----------
    rig : Rig
    source : NamedPixels, FoundMarks, PictureSet, Shoot, path or sequence of paths
        Pixels of the marks or the table of them; or pictures, with `markers`.
    target : None
        No target is shown.
    how : CheckSettings
        With places.
    progress : Progress, optional
        Of the search for marks.

    Raises
    ------
    InputError
        A target is given, too, or no pixels of marks.
    """
    from labcal.correspond.detections import Detections
    from labcal.correspond.named_pixels import NamedPixels
    from labcal.correspond.named_points import NamedPoints
    from labcal.correspond.named_points_csv import read_named_points
    from labcal.guide.checking import checked_by_marks
    from labcal.reconstruct.found_marks import FoundMarks

    if target is not None or how.places is None or isinstance(source, Detections):
        raise InputError(
            "`places` are those of fixed marks, which take the place of a target. Leave out either `target` "
            "and its dots, or `places`."
        )
    places = how.places if isinstance(how.places, NamedPoints) else read_named_points(how.places)
    pixels = _pixels(source)
    if pixels is not None:
        if how.markers is not None:
            raise InputError(
                "`markers` are looked for in pictures, but named pixels are given. Leave it out."
            )
        return checked_by_marks(rig, pixels, places)
    if how.markers is None:
        raise InputError(
            "Pictures are given, but not which marks to look for in them. Give `markers`, as in "
            "'apriltag-36h11', or the table of their pixels."
        )
    if isinstance(source, NamedPixels | FoundMarks):
        raise TypeError("The pixels of these marks have been taken already.")
    return checked_by_marks(rig, find_marks(rig, source, how.markers, 1, progress).pixels, places)


def _pixels(source: object) -> "NamedPixels | None":
    """Return the pixels that are given or that a table holds; None of pictures."""
    from labcal.correspond.named_pixels import NamedPixels
    from labcal.correspond.named_pixels_csv import is_pixels, read_pixels
    from labcal.reconstruct.found_marks import FoundMarks

    one = source[0] if isinstance(source, list | tuple) and len(source) == 1 else source
    if isinstance(one, FoundMarks):
        return one.pixels
    if isinstance(one, str | os.PathLike) and is_table(one, is_pixels):
        return read_pixels(one)
    return one if isinstance(one, NamedPixels) else None


def is_table(source: object, is_kind: Callable[[AnyPath], bool]) -> bool:
    """Return whether one file is given that is a table of a kind."""
    one = source[0] if isinstance(source, list | tuple) and len(source) == 1 else source
    return isinstance(one, str | os.PathLike) and as_path(one).is_file() and is_kind(one)
