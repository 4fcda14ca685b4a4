"""Acceptance test of a measuring system by known lengths."""

import os
from typing import TYPE_CHECKING

from labcal.arguments import settings_of, wrong_type
from labcal.cameras.rig import Rig
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_pixels_csv import is_pixels
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.evaluate.acceptance.reference_lengths import ReferenceLengths, read_lengths
from labcal.paths import AnyPath, as_path
from labcal.pipeline.named_points import measure
from labcal.pipeline.pages import claimed_page, page_maker

if TYPE_CHECKING:
    from labcal.evaluate.acceptance.certificate import Certificate
    from labcal.evaluate.acceptance.certify_settings import CertifySettings
    from labcal.evaluate.acceptance.measured_lengths import AnyPoints
    from labcal.reconstruct.named_reconstruction import NamedReconstruction
    from labcal.reconstruct.reconstruction import Reconstruction
    from labcal.report.page.output import PageOutput


def certify(
    points: "Points | NamedPoints | NamedPixels | Reconstruction | NamedReconstruction | AnyPath",
    lengths: ReferenceLengths | AnyPath,
    settings: "CertifySettings | None" = None,
    *,
    rig: Rig | AnyPath | None = None,
    page: "PageOutput | AnyPath | None" = None,
) -> "Certificate":
    """Return the errors of known lengths against a limit, after VDI/VDE 2634 Part 1, with a decision.

    Parameters
    ----------
    points : Points, NamedPoints, NamedPixels, Reconstruction, NamedReconstruction or path
        The ends of the lengths, or the table of them: ``points.csv`` of named points or of dots, or
        ``pixels.csv``.
    lengths : ReferenceLengths or path
        Their calibrated values.
    settings : CertifySettings, optional
        Limit, decision rule, and what the certificate states.
    rig : Rig or path, optional
        What measures pixels; of points, what they were measured with, which the certificate names.
    page : path, optional
        The certificate, ``.html``: one to two pages of A4 when it is printed.

    Returns
    -------
    Certificate

    Raises
    ------
    InputError
        Something cannot be read, pixels come without a rig, or no length has both of its ends among the
        points.
    OutputError
        The page may not be written.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples
    >>> from labcal.pipeline import CertifySettings
    >>> settings = CertifySettings(limit_mm=0.01)
    >>> found = labcal.certify(examples.pixels(), examples.lengths(), settings, rig=examples.rig())
    >>> found.error_mm.round(3)
    array([ 0.019,  0.026, -0.004])
    """
    from labcal.evaluate.acceptance.certified import certified
    from labcal.evaluate.acceptance.certify_settings import CertifySettings

    how = settings_of(settings, CertifySettings)
    output = claimed_page(page, [points, lengths, rig])
    known = lengths if isinstance(lengths, ReferenceLengths) else read_lengths(as_path(lengths))
    found = certified(_points(points, rig, how.pixel_sigma), known, how)
    if output is not None:
        from labcal.report.certificate_page import certificate_page

        given = {"points": points, "lengths": lengths, "settings": settings, "rig": rig, "page": output.path}
        output.write(certificate_page(found, rig, page_maker(output, "certify", given)))
    return found


def _points(points: object, rig: Rig | AnyPath | None, pixel_sigma: float | None) -> "AnyPoints":
    """Return points: as they are given, read, or measured from pixels."""
    from labcal.correspond.named_points_csv import read_named_points
    from labcal.correspond.points_csv import read_points
    from labcal.reconstruct.measure_settings import MeasureSettings
    from labcal.reconstruct.named_reconstruction import NamedReconstruction
    from labcal.reconstruct.reconstruction import Reconstruction
    from labcal.run.file_reading import first_line

    if isinstance(points, Points | NamedPoints | Reconstruction | NamedReconstruction):
        return points
    pixels: NamedPixels | AnyPath
    if isinstance(points, NamedPixels):
        pixels = points
    else:
        if not isinstance(points, str | os.PathLike):
            raise wrong_type(points, "points, pixels, or the path of a table of them", "points")
        path = as_path(points)
        if not is_pixels(path):
            of_dots = first_line(path).startswith(b"view,col,")
            return read_points(path) if of_dots else read_named_points(path)
        pixels = path
    if rig is None:
        raise InputError("Pixels become points by a rig. Give `rig`, too, or a table of points.")
    return measure(rig, pixels, settings=MeasureSettings(pixel_sigma=pixel_sigma))
