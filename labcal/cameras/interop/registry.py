"""The formats by name, by the ending of a file, or by what it holds."""

from collections.abc import Sequence
from pathlib import Path

from labcal.cameras.interop.colmap import COLMAP
from labcal.cameras.interop.dice import DICE
from labcal.cameras.interop.exchange import Home, ReadRig, RigFormat, SourceText
from labcal.cameras.interop.kalibr import KALIBR
from labcal.cameras.interop.labcal_rig import LABCAL
from labcal.cameras.interop.mrcal import MRCAL
from labcal.cameras.interop.opencv import OPENCV
from labcal.cameras.interop.ros import ROS
from labcal.cameras.rig import Rig
from labcal.errors import InputError, UnknownNameError

FORMATS: dict[str, RigFormat] = {one.name: one for one in (LABCAL, OPENCV, MRCAL, KALIBR, ROS, COLMAP, DICE)}
_MOST_BYTES = max(one.most_bytes for one in FORMATS.values())
_MOST_FILES = 100


def format_by_name(name: str) -> RigFormat:
    """Return a format.

    Raises
    ------
    UnknownNameError
        There is none of that name; the nearest one is offered.
    """
    if name not in FORMATS:
        raise UnknownNameError("format", name, FORMATS)
    return FORMATS[name]


def format_to_write(path: Path) -> RigFormat:
    """Return the format that the ending of a file to write means.

    Raises
    ------
    InputError
        Several formats end so, or none.
    """
    fitting = [
        one for one in FORMATS.values() if one.home is Home.FILE and path.suffix.lower() in one.suffixes
    ]
    if len(fitting) == 1:
        return fitting[0]
    names = ", ".join(one.name for one in fitting or FORMATS.values())
    raise InputError(
        f"The name {path} does not tell the format to write. Say it: --to FORMAT, one of {names}."
    )


def read_rig_files(paths: Sequence[Path], format_name: str | None) -> tuple[RigFormat, ReadRig]:
    """Read a rig from one file, several, or a folder.

    Parameters
    ----------
    paths : sequence of Path
        A folder stands for the files in it that are of the format.
    format_name : str, optional
        Found by what the files hold where not given.

    Raises
    ------
    UnknownNameError
        There is no such format.
    InputError
        A file cannot be read, is of no format, of two, or of another one than the rest; or it is damaged.
    """
    wanted = None if format_name is None else format_by_name(format_name)
    given = [_source(path, wanted) for path in _files(paths)]
    found = [(source, wanted or _recognised(source.text)) for source in given]
    in_folder = any(path.is_dir() for path in paths)
    known = [(source, one) for source, one in found if one is not None]
    strange = [source.path for source, one in found if one is None]
    if strange and not (in_folder and known):
        raise InputError(
            f"{strange[0]} is of no format that is read here ({', '.join(FORMATS)}). If it should be, name "
            f"it: --from FORMAT."
        )
    kinds = {one.name: one for _, one in known}
    if len(kinds) != 1:
        raise InputError(f"These files are of several formats: {', '.join(kinds)}. Name one: --from FORMAT.")
    (chosen,) = kinds.values()
    sources = given if chosen.home is Home.FOLDER else [source for source, _ in known]
    return chosen, chosen.read(sources)


def chosen_cameras(rig: Rig, names: Sequence[str]) -> Rig:
    """Return the rig of some cameras only, in the order of the names.

    Raises
    ------
    InputError
        The rig has no such camera.
    """
    for name in names:
        rig.camera(name)
    return Rig(cameras={name: rig.cameras[name] for name in names})


def _recognised(text: str) -> RigFormat | None:
    """Return the format of a text, None where none or several take it for theirs."""
    fitting = [one for one in FORMATS.values() if one.recognises(text)]
    return fitting[0] if len(fitting) == 1 else None


def _files(paths: Sequence[Path]) -> list[Path]:
    """Return files, with folders replaced by the text files in them."""
    endings = {suffix for one in FORMATS.values() for suffix in one.suffixes}
    files: list[Path] = []
    for path in paths:
        if path.is_dir():
            files += sorted(entry for entry in path.iterdir() if entry.suffix.lower() in endings)
        else:
            files.append(path)
    if not files:
        raise InputError(f"There is no file of any format in {', '.join(map(str, paths))}.")
    if len(files) > _MOST_FILES:
        raise InputError(
            f"These are {len(files)} files, more than cameras of any rig. Name those of the rig."
        )
    return files


def _source(path: Path, wanted: RigFormat | None) -> SourceText:
    """Read a text file of sensible size."""
    most = _MOST_BYTES if wanted is None else wanted.most_bytes
    try:
        if path.exists() and not path.is_file():
            raise InputError(f"{path} cannot be read: it is no file.")
        if path.stat().st_size > most:
            raise InputError(
                f"{path} is not read: it has more than {most} bytes, and no file of cameras has."
            )
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    try:
        return SourceText(path, data.decode("utf-8-sig"))
    except UnicodeDecodeError:
        if b"\0" in data:
            raise InputError(f"{path} is no text file.") from None
        return SourceText(path, data.decode("latin-1"))
