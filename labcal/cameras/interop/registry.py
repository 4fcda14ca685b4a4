"""The formats by name, by the ending of a file, or by what it holds."""

from collections import ChainMap
from collections.abc import Mapping

from labcal.arguments import one_named
from labcal.cameras.interop.anipose import ANIPOSE
from labcal.cameras.interop.basalt import BASALT
from labcal.cameras.interop.camodocal import CAMODOCAL
from labcal.cameras.interop.colmap import COLMAP
from labcal.cameras.interop.colmap_binary import COLMAP_BINARY
from labcal.cameras.interop.dice import DICE
from labcal.cameras.interop.euroc import EUROC
from labcal.cameras.interop.exchange import Home, RigFormat, SourceText
from labcal.cameras.interop.kalibr import KALIBR
from labcal.cameras.interop.labcal_rig import LABCAL
from labcal.cameras.interop.matchid import MATCHID
from labcal.cameras.interop.matlab import MATLAB
from labcal.cameras.interop.metashape import METASHAPE
from labcal.cameras.interop.mrcal import MRCAL
from labcal.cameras.interop.nerfstudio import NERFSTUDIO
from labcal.cameras.interop.opencv import OPENCV
from labcal.cameras.interop.orb_slam import ORB_SLAM
from labcal.cameras.interop.ost import OST
from labcal.cameras.interop.ros import ROS
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path

FORMATS: dict[str, RigFormat] = {
    one.name: one
    for one in (LABCAL, OPENCV, MRCAL, KALIBR, ROS, COLMAP, COLMAP_BINARY, DICE, ANIPOSE, MATLAB, MATCHID)
}


READ_ONLY: dict[str, RigFormat] = {
    one.name: one for one in (EUROC, CAMODOCAL, ORB_SLAM, BASALT, OST, NERFSTUDIO, METASHAPE)
}
"""Formats that are read and not written."""
READ: Mapping[str, RigFormat] = ChainMap(READ_ONLY, FORMATS)
"""All formats that are read, those that are also written first."""


def format_to_read(name: str) -> RigFormat:
    """Return a format whose files are read.

    Raises
    ------
    UnknownNameError
        There is none of that name; the nearest one is offered.
    """
    return one_named(READ, "format", name)


def format_by_name(name: str) -> RigFormat:
    """Return a format that is written.

    Raises
    ------
    UnknownNameError
        There is none of that name; the nearest one is offered.
    InputError
        It is one that is only read.
    """
    if name in READ_ONLY:
        raise InputError(
            f"Files of the format '{name}' are read, not written. Choose one of {', '.join(FORMATS)}."
        )
    return one_named(FORMATS, "format", name)


def format_to_write(path: AnyPath) -> RigFormat:
    """Return the format that the ending of a file to write means.

    Raises
    ------
    InputError
        Several formats end so, or none.
    """
    path = as_path(path)
    fitting = [
        one for one in FORMATS.values() if one.home is Home.FILE and path.suffix.lower() in one.suffixes
    ]
    if LABCAL in fitting:
        return LABCAL  # others that end so are named with `to_format`
    if len(fitting) == 1:
        return fitting[0]
    names = ", ".join(one.name for one in fitting or FORMATS.values())
    raise InputError(
        f"The name {path} does not determine the format to write. Give it: `to_format='FORMAT'`, "
        f"one of {names}."
    )


def recognised_format(source: SourceText) -> RigFormat | None:
    """Return the format that a file's content is of, whatever its name; None where it is of none.

    Raises
    ------
    InputError
        Several formats take it for theirs.
    """
    fitting = [one for one in READ.values() if one.recognises(source.text)]
    if len(fitting) > 1:
        raise InputError(
            f"{source.path} could be of several formats: {', '.join(one.name for one in fitting)}. Say "
            "which: `from_format='FORMAT'`."
        )
    return fitting[0] if fitting else None
