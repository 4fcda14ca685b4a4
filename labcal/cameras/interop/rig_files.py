"""Rigs in files of any format: reading one file, several or a folder, and writing them."""

from collections.abc import Sequence
from pathlib import Path

from labcal.cameras.interop.exchange import Home, OutputText, ReadRig, RigFormat, RigTexts, SourceText
from labcal.cameras.interop.registry import FORMATS, format_by_name, recognised_format
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.run.claims import FileKind, FileOutput, FolderOutput, Output
from labcal.run.outputs import write_file
from labcal.run.standing import require_file_place
from labcal.run.unfinished import unfinished_folder

_MOST_BYTES = max(one.most_bytes for one in FORMATS.values())
_MOST_TOGETHER = 4 * _MOST_BYTES
_MOST_FILES = 100


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
    files = _files(paths)
    together = sum(path.stat().st_size for path in files if path.is_file())
    _require_size(files[0], together, _MOST_TOGETHER)
    given = [_source(path, wanted) for path in files]
    found = [(source, wanted or recognised_format(source.text)) for source in given]
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
    for source in sources:
        _require_size(source.path, len(source.text), chosen.most_bytes)
    return chosen, chosen.read(sources)


def write_rig_files(path: Path, chosen: RigFormat, texts: RigTexts, *, force: bool) -> list[Path]:
    """Write a rig and return the files.

    Parameters
    ----------
    path : Path
        The file to write. Where there is one a camera, its name gets the camera's behind it, as in
        ``rig-left.yaml``; a `path` without an ending is a folder for them.
    chosen : RigFormat
    texts : RigTexts
        What its ``write`` returned.
    force : bool
        Replace what exists.

    Raises
    ------
    OutputError
        A file exists and `force` is not set, or it cannot be written.
    """
    folder = _folder(path, chosen, texts)
    if folder is not None:
        with unfinished_folder(path, _command(folder), force=force) as working:
            for name, text in folder.items():
                write_file(working / name, text, force=True)
        return [path / name for name in folder]
    paths = [_file(path, one) for one in texts.files]
    for file in paths:
        require_file_place(file, force=force)
    for file, one in zip(paths, texts.files, strict=True):
        write_file(file, one.text, force=force)
    return paths


def rig_outputs(path: Path, chosen: RigFormat, texts: RigTexts) -> list[Output]:
    """Return what :func:`write_rig_files` would write, as the outputs of a command."""
    folder = _folder(path, chosen, texts)
    if folder is not None:
        return [FolderOutput(path, _command(folder))]
    kind = FileKind(f"cameras of {chosen.name}", lambda content: chosen.recognises(content.decode("latin-1")))
    return [FileOutput(_file(path, one), kind) for one in texts.files]


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


def _folder(path: Path, chosen: RigFormat, texts: RigTexts) -> dict[str, str] | None:
    """Return the texts by name where they are to be a folder, else None."""
    if chosen.home is Home.FOLDER:
        return {one.label: one.text for one in texts.files}
    if not path.suffix and texts.files[0].label:
        return {f"{one.label}{chosen.suffixes[0]}": one.text for one in texts.files}
    return None


def _file(path: Path, one: OutputText) -> Path:
    """Return where one text goes that is no part of a folder."""
    return path.with_name(f"{path.stem}-{one.label}{path.suffix}") if one.label else path


def _command(folder: dict[str, str]) -> str:
    return f"convert {sorted(folder)}"


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
        _require_size(path, path.stat().st_size, most)
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    try:
        return SourceText(path, data.decode("utf-8-sig"))
    except UnicodeDecodeError:
        if b"\0" in data:
            raise InputError(f"{path} is no text file.") from None
        return SourceText(path, data.decode("latin-1"))


def _require_size(path: Path, length: int, most: int) -> None:
    """Raise where there is more to read than any cameras take."""
    if length > most:
        raise InputError(f"{path} is not read: there are more than {most} bytes, and no file of cameras has.")
