"""What a page says that it was made by."""

from collections.abc import Mapping

from labcal.pipeline.given import given_paths
from labcal.report.page.output import PageOutput, called
from labcal.report.page.provenance import Provenance
from labcal.report.page_maker import PageMaker


def page_maker(output: PageOutput, function: str, arguments: Mapping[str, object]) -> PageMaker:
    """Return what the builders of pages share.

    Parameters
    ----------
    output : PageOutput
    function : str
        Of the pipeline.
    arguments : mapping of str to object
        What it was given, by name.
    """
    command = output.command or called(function, arguments)
    return PageMaker(Provenance.of(command, output.inputs or given_paths(arguments.values())), output.phrase)
