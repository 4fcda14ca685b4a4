"""Conversion of other programs' tables of pixels to ``pixels.csv``."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from labcal.cameras.interop.conversion import Conversion, ConvertSettings
from labcal.cameras.interop.registry import FORMATS
from labcal.correspond.interop.pixels.exchange import PixelOptions
from labcal.correspond.interop.pixels.registry import PIXEL_FORMATS
from labcal.correspond.named_pixels_csv import KIND, write_pixels
from labcal.correspond.sources import camera_endings
from labcal.errors import InputError, UnknownNameError
from labcal.paths import AnyPath, as_path
from labcal.run.claims import FileOutput, claim_outputs

_FOREIGN = ("to_format", "only", "target", "size", "unit", "lens", "key")


def is_of_pixels(settings: ConvertSettings) -> bool:
    """Tell whether a format of named pixels is to be read."""
    return settings.from_format in PIXEL_FORMATS


def require_known_format(settings: ConvertSettings) -> None:
    """Raise where a format to read is named that is none, of cameras or of pixels.

    Raises
    ------
    UnknownNameError
        The nearest one is offered.
    """
    known = [*FORMATS, *PIXEL_FORMATS]
    if settings.from_format is not None and settings.from_format not in known:
        raise UnknownNameError("format", settings.from_format, known)


def convert_pixels(
    inputs: Sequence[AnyPath],
    output: AnyPath,
    settings: ConvertSettings,
    read: Iterable[Path],
    *,
    force: bool,
) -> Conversion:
    """Write other programs' tables of pixels as one ``pixels.csv``.

    Parameters
    ----------
    inputs : sequence of paths
        The tables; of COLMAP, a folder.
    output : path
        A ``.csv``.
    settings : ConvertSettings
        Its `from_format` is one of pixels.
    read : iterable of paths
        All files that are read, none of which is replaced.
    force : bool
        Replace a table of pixels that exists.

    Raises
    ------
    InputError
        A table cannot be read or holds no pixel, or a setting would be dropped.
    OutputError
        The output may not be written.
    """
    paths, place = [as_path(one) for one in inputs], as_path(output)
    wanted = PIXEL_FORMATS[str(settings.from_format)]
    settings.refuse(_FOREIGN, "does not apply to tables of pixels")
    others = {"cameras", "columns", "likelihood"} - set(wanted.options)
    settings.refuse(sorted(others), f"does not apply to the format '{wanted.name}'")
    if place.suffix.lower() != ".csv":
        raise InputError(f"Named pixels are written as a pixels.csv, but {place} ends otherwise.")
    claim_outputs([FileOutput(place, KIND)], read, force=force)
    endings = {} if settings.cameras is None else camera_endings(settings.cameras)
    found = wanted.read(paths, PixelOptions(endings, settings.columns, settings.likelihood))
    if not len(found.pixels):
        raise InputError(f"There is no pixel of a point in {', '.join(map(str, paths[:3]))}.")
    write_pixels(place, found.pixels, force=force)
    cameras = list(found.pixels.cameras)
    return Conversion(
        wanted.name, "labcal", [str(place)], cameras, len(found.pixels), None, None, list(found.notes), []
    )
