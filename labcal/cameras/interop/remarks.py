"""Remarks on cameras that were read from files of other systems, which no file states."""

from collections.abc import Mapping

from labcal.cameras.blind_pixels import blind_pixels
from labcal.cameras.camera import Camera
from labcal.cameras.interop.exchange import RigFormat
from labcal.cameras.principal_point import exchanged_sides_note, principal_point_note

_OPTION = "If so, give their size: `size='{width}x{height}'`."
_IN_THE_FILE = "If so, exchange them in the file."


def remarks_on(cameras: Mapping[str, Camera], source: RigFormat) -> list[str]:
    """Return remarks on sizes, principal points and blind pixels of cameras, in their order.

    Parameters
    ----------
    cameras : mapping of str to Camera
        By name.
    source : RigFormat
        The format of the files that they were read from.
    """
    mend = _OPTION if "size" in source.options else _IN_THE_FILE
    found = []
    for name, camera in cameras.items():
        exchanged = exchanged_sides_note(name, camera, mend)
        found += [exchanged or principal_point_note(name, camera), blind_pixels(name, camera)]
    return [note for note in found if note is not None]
