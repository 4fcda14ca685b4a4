"""Pictures with the marks that were found drawn on top."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import UInt8

from labcal.correspond.mark_measurement import MarkMeasurement
from labcal.correspond.sources import Source
from labcal.detect.grey import AnyPicture
from labcal.detect.marks.picture_marks import MarkFlag, PictureMarks
from labcal.paths import AnyPath, as_path
from labcal.reconstruct.found_marks import FoundMarks
from labcal.report.overlay import Colour, draw_dot, draw_text, draw_uncertainty, grey_canvas, stroke
from labcal.report.overlay_folder import write_overlay_folder

# Red, green, blue.
_COLOURS: dict[MarkFlag, Colour] = {
    MarkFlag.OK: (40, 200, 60),
    MarkFlag.CUT: (255, 150, 0),
    MarkFlag.HIDDEN: (150, 150, 150),
    MarkFlag.SATURATED: (255, 255, 0),
    MarkFlag.BLURRED: (180, 90, 255),
    MarkFlag.BAD_FIT: (255, 40, 40),
    MarkFlag.REPEATED: (255, 60, 220),
    MarkFlag.UNKNOWN_CODE: (255, 60, 220),
    MarkFlag.AMBIGUOUS: (60, 150, 255),
}


def mark_overlay_command(sources: Sequence[Source]) -> str:
    """Return what determines such a folder, for :func:`~labcal.run.unfinished.unfinished_folder`."""
    return "measure --overlay " + " ".join(source.image for source in sources)


def draw_marks(image: AnyPicture, marks: PictureMarks) -> UInt8[np.ndarray, "h w 3"]:
    """Draw marks over a picture, with their names, and flags where they are not measured.

    Parameters
    ----------
    image : ndarray
        The picture that the marks were found in.
    marks : PictureMarks

    Returns
    -------
    ndarray, shape (h, w, 3)
        Red, green, blue.
    """
    canvas = grey_canvas(image)
    thick = stroke(canvas)
    for i, flag in enumerate(marks.flag):
        draw_dot(canvas, marks, i, _COLOURS[flag], thick)
    draw_uncertainty(canvas, marks, thick)
    for i, flag in enumerate(marks.flag):
        text = marks.point[i] if flag is MarkFlag.OK else f"{marks.point[i]} {flag}".strip()
        x, y = (float(part) for part in marks.seen_at[i])
        width = 7.2 * thick * len(text)
        place = (
            int(np.clip(x + 4 * thick, 0, max(0.0, canvas.shape[1] - width))),
            int(np.clip(y - 4 * thick, 12 * thick, canvas.shape[0] - 4)),
        )
        draw_text(canvas, text, place, 0.35 * thick, _COLOURS[flag])
    return canvas


def write_mark_overlays(folder: AnyPath, found: FoundMarks, *, force: bool = False) -> None:
    """Write each picture that could be read with its marks drawn in, as ``<view>_<camera>.png``.

    Parameters
    ----------
    folder : path
        The folder to appear.
    found : FoundMarks
        As :func:`labcal.pipeline.find_marks` returns them; the pictures are read again.
    force : bool
        Replace a folder of such pictures.

    Raises
    ------
    OutputError
        The folder may not be made.

    Examples
    --------
    >>> from pathlib import Path
    >>> from labcal import examples, pipeline
    >>> found = pipeline.find_marks(examples.rig(), examples.shoot("shoot", views=1), "dots")
    >>> pipeline.write_mark_overlays("overlays", found)
    >>> sorted(path.name for path in Path("overlays").glob("*.png"))
    ['hand-0_left.png', 'hand-0_right.png']
    """
    measured: list[MarkMeasurement] = list(found.measurements)
    command = mark_overlay_command([one.source for one in measured])
    drawn = (
        (one.source, draw_marks(one.source.read(), one.marks)) for one in measured if one.marks is not None
    )
    write_overlay_folder(as_path(folder), command, drawn, force=force)
