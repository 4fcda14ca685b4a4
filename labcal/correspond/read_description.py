"""The description of a target, from one picture of its print."""

import os

import numpy as np

from labcal.detect.codes.reading import PictureCodes, read_codes
from labcal.detect.grey import AnyPicture
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.shoot.pictures import read_picture
from labcal.targets.code_text import PrintedTarget
from labcal.wording import counted, listed


def read_description(picture: AnyPath | AnyPicture) -> PrintedTarget:
    """Read which target a picture shows, from the code on its print.

    Parameters
    ----------
    picture : path or ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.

    Returns
    -------
    PrintedTarget
        The target as designed, and the number of the print.

    Raises
    ------
    InputError
        The picture cannot be read, shows no code that can be read, one that is not believed, or several.

    Examples
    --------
    >>> from labcal import load_target, read_description
    >>> from labcal.targets.artwork import export_artwork
    >>> drawn = export_artwork(load_target("rings-14x10"), "print.png", copy=2)
    >>> found = read_description("print.png")
    >>> found.name, found.target == load_target("rings-14x10")
    ('rings-14x10#2', True)
    """
    loaded = read_picture(as_path(picture)) if isinstance(picture, str | os.PathLike) else np.asarray(picture)
    codes = read_codes(loaded)
    if len(codes.prints) == 1:
        return codes.prints[0]
    if codes.prints:
        raise InputError(
            f"The picture shows {counted(len(codes.prints), 'print')}: "
            f"{listed([one.name for one in codes.prints])}. Cut out the one that is wanted."
        )
    raise InputError(f"The picture does not tell which target it shows. {_why(codes)}")


def _why(codes: PictureCodes) -> str:
    """Return why no description is read, for people."""
    if codes.refused:
        return f"Its code is not believed. {codes.refused[0]}"
    if codes.foreign:
        return f"Its QR code is not labcal's: {codes.foreign[0]!r}."
    if codes.blocks:
        return "The tags beside a code are seen, but the code is too small or too blurred to be read."
    return "It shows no code of a print that 'labcal target export' makes."
