"""The difference of two calibrations."""

from typing import TYPE_CHECKING

from labcal.arguments import settings_of
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig
from labcal.paths import AnyPath, as_path
from labcal.pipeline.pages import claimed_page, page_maker

if TYPE_CHECKING:
    from labcal.evaluate.comparison.compare_settings import CompareSettings
    from labcal.evaluate.comparison.rig_comparison import RigComparison
    from labcal.report.page.output import PageOutput


def compare(
    one: Rig | AnyPath,
    other: Rig | AnyPath,
    settings: "CompareSettings | None" = None,
    *,
    page: "PageOutput | AnyPath | None" = None,
) -> "RigComparison":
    """Return the difference of two calibrations after the rigid motion that no measurement tells.

    Lenses are compared over their pictures, px, after the motion of each camera that explains most of their
    difference; rigs over the volume where the target was, mm, after one motion of the world.

    Parameters
    ----------
    one, other : Rig or path
        Of the same cameras with pictures of the same sizes; lens models may differ.
    settings : CompareSettings, optional
        Names of cameras that differ, distances, and whether the pictures are the same.
    page : path, optional
        A page to write, ``.html``: maps of the differences and of both budgets.

    Returns
    -------
    RigComparison

    Raises
    ------
    InputError
        A rig cannot be read, the rigs have different cameras, or too little in common to be compared.
    OutputError
        The page may not be written.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples
    >>> target = labcal.load_target(examples.TARGET)
    >>> pictures = examples.detections()
    >>> half = [labcal.pipeline.calibrate(target, pictures, hold_out=views).rig
    ...         for views in (pictures.views[:4], pictures.views[4:])]
    >>> found = labcal.compare(*half)
    >>> found.pictures.value, found.is_consistent
    ('different', True)
    """
    from labcal.evaluate.comparison.compare_settings import CompareSettings
    from labcal.evaluate.comparison.compared_rigs import compared

    how = settings_of(settings, CompareSettings)
    output = claimed_page(page, [one, other])
    first, second = (rig if isinstance(rig, Rig) else read_rig(as_path(rig)) for rig in (one, other))
    found = compared(first, second, how)
    if output is not None:
        from labcal.report.comparison_page import comparison_page

        given = {"one": one, "other": other, "settings": settings, "page": output.path}
        output.write(comparison_page(found, page_maker(output, "compare", given)))
    return found
