"""Formats that are read and not written: other programs' files of cameras, for which labcal is no source."""

from collections.abc import Callable, Sequence

from labcal.cameras.interop.exchange import (
    Home,
    ReadOptions,
    ReadRig,
    RigFormat,
    RigTexts,
    SourceText,
    Unit,
)
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.run.file_marks import TEXT_COMMENT


def read_only_format(
    name: str,
    suffixes: tuple[str, ...],
    recognises: Callable[[str], bool],
    read: Callable[[Sequence[SourceText], ReadOptions], ReadRig],
    unit: Unit,
    options: tuple[str, ...] = ("unit",),
) -> RigFormat:
    """Return a format of text files that refuses to write.

    Parameters
    ----------
    name, suffixes, recognises, read, unit, options
        As of :class:`~labcal.cameras.interop.exchange.RigFormat`.
    """

    def refuse(_rig: Rig, _suffix: str) -> RigTexts:
        raise InputError(f"Files of the format '{name}' are read, not written. Choose opencv or kalibr.")

    return RigFormat(
        name, suffixes, Home.FILE, 2**20, recognises, read, refuse, TEXT_COMMENT, unit, options=options
    )
