"""Displacements of the dots of a print, as a picture of arrows on the grid."""

from io import BytesIO
from pathlib import Path

from labcal.calibrate.displacement_figure import displacement_figure
from labcal.calibrate.freed_dots import FreedDots
from labcal.run.outputs import write_file
from labcal.shoot.pictures import png_output


def draw_displacements(dots: FreedDots) -> bytes:
    """Return a PNG of the arrows; as :meth:`labcal.Calibration.plot_displacements` draws them.

    Parameters
    ----------
    dots : FreedDots
    """
    picture = BytesIO()
    displacement_figure(dots).savefig(picture, format="png", metadata={"Software": None})
    return picture.getvalue()


def save_displacements(path: Path, dots: FreedDots, *, force: bool) -> None:
    """Write the PNG of :func:`draw_displacements`.

    Raises
    ------
    OutputError
        The file exists and `force` is not set, or it cannot be written.
    """
    write_file(path, draw_displacements(dots), kind=png_output(path).kind, force=force)
