"""Arguments of the functions of the chain: objects, or the files of them."""

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from labcal.correspond.detections import Detections, read_detections
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.pipeline.detection import detect
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.targets.catalogue import AnyTarget, load_target
from labcal.targets.target import Target

if TYPE_CHECKING:
    from labcal.report.page.output import PageOutput


def shown_by(source: Shoot | AnyTarget | AnyPath) -> Shoot | AnyTarget:
    """Return what dots are of: a shoot, by its folder, too, or a target, by its name, too."""
    if isinstance(source, Shoot | Target):
        return source
    return open_shoot(as_path(source)) if is_shoot(as_path(source)) else load_target(source)


def dots_of(detections: Detections | AnyPath | None, shown: Shoot | AnyTarget | None) -> Detections:
    """Return dots that are given, by the table's path, too, or those of a shoot."""
    if isinstance(detections, Detections):
        return detections
    if detections is not None:
        return read_detections(as_path(detections))
    if isinstance(shown, Shoot):
        return detect(shown)
    raise InputError("No dots are given. Give `detections`, or a shoot, in whose pictures they are found.")


def claimed_page(page: "PageOutput | AnyPath | None", given: Sequence[object]) -> "PageOutput | None":
    """Return the page that is asked for, once it is known that it may be written; None if none is.

    Parameters
    ----------
    page : PageOutput, path or None
    given : sequence of object
        What the work begins with; paths among them, and folders of shoots, are read.

    Raises
    ------
    OutputError
        It may not be written.
    """
    if page is None:
        return None
    from labcal.correspond.paths_read import paths_read
    from labcal.report.page.output import PageOutput
    from labcal.run.claims import claim_outputs

    output = PageOutput.of(page)
    claim_outputs([output.file], paths_read([*given_paths(given), *output.inputs]), force=output.force)
    return output


def given_paths(given: Iterable[object]) -> list[AnyPath]:
    """Return the paths among things, and the folders of shoots."""
    folders = [one.folder if isinstance(one, Shoot) else one for one in given]
    return [one for one in folders if isinstance(one, str | os.PathLike)]
