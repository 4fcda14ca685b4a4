"""The dots that a command is given: measured already, or found now."""

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.compiling import announce_compiling
from labcal.cli.options import refuse_option
from labcal.cli.session import Session
from labcal.errors import InputError

if TYPE_CHECKING:
    from labcal.correspond.detections import Detections
    from labcal.correspond.dot_source import DotSource
    from labcal.targets.catalogue import AnyTarget


def dots_given(
    source: "DotSource", target: "AnyTarget | None", arguments: Namespace, session: Session
) -> "Detections":
    """Return the dots of a source, and warn of pictures without ids."""
    from labcal.correspond.dot_source import dots_found
    from labcal.pipeline import detect_settings, measure_pictures

    if source.table is not None:
        return source.table
    settings = detect_settings(arguments.changes)
    announce_compiling(session)
    with session.progress() as progress:
        measurements = measure_pictures(
            source.pictures, target, settings, workers=arguments.workers, progress=progress
        )
    detections, refused = dots_found(measurements)
    for words in refused:
        session.warn(words)
    return detections


def refuse_idle_detection(arguments: Namespace) -> None:
    """Raise where options of the detection are given and no dots are to be found.

    Raises
    ------
    InputError
        It is.
    """
    if Path(arguments.source).is_file() or getattr(arguments, "detections", None) is not None:
        refuse_option(arguments, "workers", "is for finding dots in pictures; a table holds them")
        if arguments.changes:
            raise InputError("--set is for finding dots in pictures; a table holds them. Leave it out.")
