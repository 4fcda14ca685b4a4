"""A folder of pictures with what detection made of them drawn on top."""

from collections.abc import Sequence

from labcal.correspond.measure import Measurement
from labcal.correspond.sources import Source
from labcal.paths import AnyPath, as_path
from labcal.report.overlay import draw_overlay
from labcal.report.overlay_folder import write_overlay_folder
from labcal.targets.catalogue import AnyTarget


def overlay_command(sources: Sequence[Source]) -> str:
    """Return what determines such a folder, for :func:`~labcal.run.unfinished.unfinished_folder`."""
    return "detect --overlay " + " ".join(source.image for source in sources)


def write_overlays(
    folder: AnyPath, measurements: Sequence[Measurement], target: AnyTarget, *, force: bool = False
) -> None:
    """Write each picture that could be read with its dots drawn in, as ``<view>_<camera>.png``.

    Parameters
    ----------
    folder : path
        The folder to appear.
    measurements : sequence of Measurement
        As :func:`labcal.pipeline.measure_pictures` returns them; their pictures are read again.
    target : AnyTarget
        What the pictures show.
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
    >>> shoot = examples.shoot("shoot", views=1)
    >>> pipeline.write_overlays("overlays", pipeline.measure_pictures(shoot), shoot.target)
    >>> sorted(path.name for path in Path("overlays").glob("*.png"))
    ['hand-0_left.png', 'hand-0_right.png']
    """
    command = overlay_command([found.source for found in measurements])
    drawn = (
        (found.source, draw_overlay(found.source.read(), found.dots, target))
        for found in measurements
        if found.dots is not None
    )
    write_overlay_folder(as_path(folder), command, drawn, force=force)
