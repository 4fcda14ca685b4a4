"""A folder of pictures with something drawn on top, one for each camera of each view."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from labcal.correspond.sources import Source
from labcal.run.unfinished import unfinished_folder
from labcal.shoot.pictures import write_picture


def write_overlay_folder(
    folder: Path, command: str, drawn: Iterable[tuple[Source, UInt8[np.ndarray, "h w 3"]]], *, force: bool
) -> None:
    """Write each picture as ``<view>_<camera>.png``.

    Parameters
    ----------
    folder : Path
        The folder to appear.
    command : str
        What determines it, for :func:`~labcal.run.unfinished.unfinished_folder`.
    drawn : iterable of (Source, ndarray)
        Where each picture comes from, and the picture: red, green, blue. They are taken one after the other,
        so that an iterator needs the memory of one.
    force : bool
        Replace a folder of the same kind.

    Raises
    ------
    OutputError
        The folder may not be made.
    """
    with unfinished_folder(folder, command, force=force) as working:
        for source, canvas in drawn:
            write_picture(working / f"{source.view}_{source.camera}.png", canvas, force=True)
