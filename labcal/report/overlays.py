"""A folder of pictures with what detection made of them drawn on top."""

from collections.abc import Sequence

from labcal.correspond.measure import Measurement
from labcal.correspond.sources import Source
from labcal.paths import AnyPath, as_path
from labcal.report.overlay import draw_overlay
from labcal.run.unfinished import unfinished_folder
from labcal.shoot.pictures import write_picture
from labcal.targets.catalogue import AnyTarget


def overlay_command(sources: Sequence[Source]) -> str:
    """Return what determines such a folder, for :func:`~labcal.run.unfinished.unfinished_folder`."""
    return "detect --overlay " + " ".join(source.image for source in sources)


def write_overlays(
    folder: AnyPath, measurements: Sequence[Measurement], target: AnyTarget, *, force: bool = False
) -> None:
    """Write each picture that could be read with its dots drawn in, as ``<view>_<camera>.png``.

    Raises
    ------
    OutputError
        The folder may not be made.
    """
    folder = as_path(folder)
    command = overlay_command([found.source for found in measurements])
    with unfinished_folder(folder, command, force=force) as working:
        for found in measurements:
            if found.dots is not None:
                path = working / f"{found.source.view}_{found.source.camera}.png"
                write_picture(path, draw_overlay(found.source.read(), found.dots, target), force=True)
