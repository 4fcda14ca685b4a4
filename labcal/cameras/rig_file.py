"""The file of a rig, ``rig.json``: written, read, and checked for cameras that can be."""

from pathlib import Path

from labcal.arguments import object_of
from labcal.cameras.rig import Rig
from labcal.cameras.rig_covariance import wrong_parameters
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.documents import read_document
from labcal.run.file_kinds import beginning_with
from labcal.run.names import differ_in_case
from labcal.run.outputs import write_file

_BEGINNING = 1000
"""Bytes of a file in which labcal's formats are named."""
KIND = beginning_with("a rig.json", b'{\n  "format": "labcal-rig"')


def write_rig(path: AnyPath, rig: Rig, *, force: bool = False) -> None:
    """Write ``rig.json``.

    Parameters
    ----------
    path : str or os.PathLike
        The file to appear.
    rig : Rig
        What to write.
    force : bool
        Replace a rig.json of labcal's that exists.

    Raises
    ------
    InputError, InputTypeError
        It is no rig, or names of cameras differ in capital letters alone.
    OutputError
        The file exists and `force` is not set, or it cannot be written.

    Examples
    --------
    >>> from labcal import examples, read_rig, write_rig
    >>> write_rig("rig.json", examples.rig())
    >>> read_rig("rig.json") == examples.rig()
    True
    """
    _require_names_apart(object_of(rig, Rig, "rig"), "The rig cannot be written")
    write_file(as_path(path), rig.model_dump_json(indent=2) + "\n", kind=KIND, force=force)


def read_rig(path: AnyPath) -> Rig:
    """Read ``rig.json``.

    Parameters
    ----------
    path : str or os.PathLike
        The file.

    Returns
    -------
    Rig

    Raises
    ------
    InputError
        The file cannot be read, is no rig, comes from a newer version, or a camera in it is impossible.

    Examples
    --------
    >>> from labcal import examples, read_rig
    >>> examples.rig().save("rig.json")
    >>> read_rig("rig.json")
    Rig(cameras=['left', 'right'], lens=brown5, baseline=200.0 mm)
    """
    path = as_path(path)
    try:
        rig = read_document(Rig, "rig", path)
    except InputError as error:
        if not _may_be_foreign(path):
            raise
        raise InputError(
            f"{error} If it is another program's file of cameras, convert it first: labcal convert {path} "
            "rig.json."
        ) from error
    return checked_rig(rig, str(path))


def _may_be_foreign(path: Path) -> bool:
    """Tell whether a file that is no rig is one, and does not say that it would be labcal's."""
    try:
        with path.open("rb") as file:
            return b"labcal-" not in file.read(_BEGINNING)
    except OSError:
        return False


def checked_rig(rig: Rig, source: str) -> Rig:
    """Return a rig that was read, whatever its file: the one place that asks whether its cameras can be.

    Parameters
    ----------
    rig : Rig
    source : str
        Where it comes from, at the beginning of a sentence.

    Raises
    ------
    InputError
        A camera is impossible, or its lens images nothing in the middle of its picture.
    """
    _require_names_apart(rig, source)
    for name, record in rig.cameras.items():
        try:
            record.sensible_camera(name)
        except InputError as error:
            raise InputError(f"{source}: {error}") from error
    wrong = None if rig.covariance is None else wrong_parameters(rig.cameras, rig.covariance)
    if wrong is not None:
        raise InputError(f"{source}: {wrong}. Take the file as 'labcal calibrate' wrote it.")
    return rig


def _require_names_apart(rig: Rig, source: str) -> None:
    """Raise where names of cameras differ in capital letters alone."""
    alike = differ_in_case(rig.cameras)
    if alike is not None:
        raise InputError(
            f"{source}: the cameras '{alike[0]}' and '{alike[1]}' differ only in capital letters, so that "
            "their files would be the same ones on many disks. Rename one of them."
        )
