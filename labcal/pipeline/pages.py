"""The page that a function of the pipeline is asked for: claimed before the work, and what it was made by."""

import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from labcal.paths import AnyPath
from labcal.shoot.dataset import Shoot

if TYPE_CHECKING:
    from labcal.correspond.sources import Source
    from labcal.report.page.output import PageOutput
    from labcal.report.page_maker import PageMaker


def claimed_page(
    page: "PageOutput | AnyPath | None", given: Iterable[object], sources: "Iterable[Source]" = ()
) -> "PageOutput | None":
    """Return the page that is asked for, once it is known that it may be written; None if none is.

    Parameters
    ----------
    page : PageOutput, path or None
    given : iterable of object
        What the work begins with; paths among them, and folders of shoots, are read.
    sources : iterable of Source
        Pictures that are read.

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
    read = paths_read([*_paths(given), *output.inputs], sources)
    claim_outputs([output.file], read, force=output.force)
    return output


def page_maker(output: "PageOutput", function: str, arguments: Mapping[str, object]) -> "PageMaker":
    """Return what the builders of pages share.

    Parameters
    ----------
    output : PageOutput
    function : str
        Of the pipeline.
    arguments : mapping of str to object
        What it was given, by name.
    """
    from labcal.report.page.output import called
    from labcal.report.page.provenance import Provenance
    from labcal.report.page_maker import PageMaker

    command = output.command or called(function, arguments)
    inputs = output.inputs or _paths(value for name, value in arguments.items() if name != "page")
    return PageMaker(Provenance.of(command, inputs), output.phrase)


def _paths(given: Iterable[object]) -> list[AnyPath]:
    """Return the paths among things, and the folders of shoots."""
    folders = [one.folder if isinstance(one, Shoot) else one for one in given]
    return [one for one in folders if isinstance(one, str | os.PathLike)]
