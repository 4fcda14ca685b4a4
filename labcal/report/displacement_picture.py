"""Displacements of the dots of a print, as a picture of arrows on the grid."""

from io import BytesIO

from labcal.calibrate.displacement_figure import displacement_figure
from labcal.calibrate.freed_dots import FreedDots


def draw_displacements(dots: FreedDots) -> bytes:
    """Return a PNG of the arrows; as :meth:`labcal.Calibration.plot_displacements` draws them.

    Parameters
    ----------
    dots : FreedDots
    """
    picture = BytesIO()
    displacement_figure(dots).savefig(picture, format="png", metadata={"Software": None})
    return picture.getvalue()
