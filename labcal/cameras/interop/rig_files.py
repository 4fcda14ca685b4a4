"""Rigs in files of any format: reading one file, several or a folder, and writing them."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from labcal.cameras.interop.exchange import (
    NOTHING_GIVEN,
    Home,
    OutputText,
    ReadOptions,
    ReadRig,
    RigFormat,
    RigTexts,
    Unit,
)
from labcal.cameras.interop.given_files import given_files, one_format
from labcal.cameras.interop.placement import scaled_rig
from labcal.cameras.interop.registry import READ, format_to_read, recognised_format
from labcal.cameras.interop.source_file import read_source
from labcal.cameras.interop.strange_files import words_on_strange
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import checked_rig
from labcal.errors import InputError
from labcal.geometry.poses import inverse
from labcal.paths import AnyPath, as_path
from labcal.run.claims import FileOutput, FolderOutput, Output
from labcal.run.file_kinds import FileKind
from labcal.run.outputs import write_file
from labcal.run.overwriting import require_file_place
from labcal.run.unfinished import unfinished_folder

_MOST_BYTES = max(one.most_bytes for one in READ.values())
_MOST_TOGETHER = 4 * _MOST_BYTES
_LIKELY_MM = (1.0, 1e5)
"""Distances of two cameras that are taken as they stand."""


def read_rig_files(
    paths: Sequence[AnyPath], format_name: str | None, given: ReadOptions = NOTHING_GIVEN
) -> tuple[RigFormat, ReadRig]:
    """Read a rig from one file, several, or a folder.

    Parameters
    ----------
    paths : sequence of str or os.PathLike
        A folder stands for the files in it that are of the format.
    format_name : str, optional
        Found by what the files hold where not given.
    given : ReadOptions
        Facts that the files do not state.

    Returns
    -------
    RigFormat, ReadRig

    Raises
    ------
    UnknownNameError
        There is no such format.
    InputError
        A file cannot be read, is of no format, of two, or of another one than the rest; it is damaged; what
        is given does not apply to its format; or cameras are so near to each other or so far apart that
        lengths are hardly in the unit that they are taken for.
    """
    wanted = None if format_name is None else format_to_read(format_name)
    given_paths = [as_path(path) for path in paths]
    files = given_files(given_paths, wanted)
    together = sum(path.stat().st_size for path in files if path.is_file())
    _require_size(files[0], together, _MOST_TOGETHER)
    sources = [read_source(path, _MOST_BYTES if wanted is None else wanted.most_bytes) for path in files]
    in_folder = any(path.is_dir() for path in given_paths)
    keyed = None if given.key is None or in_folder else READ["opencv"]  # whose files have keys to name
    found = [(source, wanted or recognised_format(source) or keyed) for source in sources]
    by_path = {source.path: source for source in sources}
    known = [(source, one) for source, one in found if one is not None]
    strange = [source.path for source, one in found if one is None]
    if strange and not (in_folder and known):
        raise InputError(words_on_strange(by_path[strange[0]]))
    kinds = {one.name: one for _, one in known}
    chosen, of_both = one_format(list(kinds.values()), sources)
    if chosen.home is not Home.FOLDER:
        sources = [source for source, _ in known]
    for source in sources:
        _require_size(source.path, len(source.data), chosen.most_bytes)
        if not source.is_text and not chosen.binary and not chosen.recognises(source.text):
            raise InputError(f"{source.path} is no text file, as those of the format '{chosen.name}' are.")
    _require_options(chosen, given)
    read = chosen.read(sources, given)
    unit = _unit_of(read, chosen, given)
    rig = scaled_rig(read.rig, unit.mm / chosen.unit.mm)
    checked_rig(rig, str(sources[0].path))
    return chosen, replace(read, rig=rig, unit=unit, notes=(*([of_both] if of_both else ()), *read.notes))


def baseline_mm(rig: Rig) -> float | None:
    """Return the distance of the first two cameras, mm; None where there is one."""
    centres = [inverse(np.array(record.T_cam_world))[:3, 3] for record in rig.cameras.values()]
    return float(np.linalg.norm(centres[1] - centres[0])) if len(centres) > 1 else None


def _require_options(chosen: RigFormat, given: ReadOptions) -> None:
    """Raise where something is given that the files of a format state themselves."""
    for name in given.named:
        if name not in chosen.options:
            raise InputError(
                f"`{name}` does not apply to files of the format '{chosen.name}', which state it themselves. "
                "Leave it out."
            )


def _unit_of(read: ReadRig, chosen: RigFormat, given: ReadOptions) -> Unit:
    """Return the unit of lengths in files: what they state, or is given, or is usual and makes sense.

    Raises
    ------
    InputError
        Files and `given` contradict each other; or nothing is given, and the distance of the cameras speaks
        for another unit than the usual one, or for either.
    """
    if given.unit is not None and read.unit not in (None, given.unit):
        raise InputError(
            f"The files state themselves that lengths are in {read.unit.value}, but "
            f"`unit='{given.unit.value}'` states otherwise. Leave that out."
        )
    stated = given.unit or read.unit
    baseline = baseline_mm(read.rig)
    if stated is not None or "unit" not in chosen.options or baseline is None:
        return stated or chosen.unit
    low, high = _LIKELY_MM
    apart = baseline / chosen.unit.mm  # in the unit of the file
    likely = [unit for unit in Unit if low <= apart * unit.mm <= high]
    if chosen.unit_is_usual and chosen.unit in likely:
        return chosen.unit
    if not chosen.unit_is_usual and len(likely) == 1:
        return likely[0]
    if chosen.unit_is_usual:
        raise InputError(
            f"The first two cameras would be {baseline:.4g} mm apart, if lengths are in {chosen.unit.value} "
            f"as in most files of the format '{chosen.name}'. State their unit: `unit='mm'` or `unit='m'`."
        )
    raise InputError(
        f"The first two cameras are {apart:.4g} apart, and files of the format '{chosen.name}' do not state "
        "whether that is in millimetres or in metres. State it: `unit='mm'` or `unit='m'`."
    )


def write_rig_files(path: AnyPath, chosen: RigFormat, texts: RigTexts, *, force: bool) -> list[Path]:
    """Write a rig and return the files.

    Parameters
    ----------
    path : str or os.PathLike
        The file to write. Where there is one a camera, its name gets the camera's behind it, as in
        ``rig-left.yaml``; a `path` without an ending is a folder for them.
    chosen : RigFormat
    texts : RigTexts
        What its ``write`` returned.
    force : bool
        Replace what labcal wrote.

    Raises
    ------
    OutputError
        A file exists and `force` is not set, or it cannot be written.
    """
    path = as_path(path)
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
        write_file(file, one.text, kind=_file_kind(chosen), force=force)
    return paths


def rig_outputs(path: AnyPath, chosen: RigFormat, texts: RigTexts) -> list[Output]:
    """Return what :func:`write_rig_files` would write, as the outputs of a command."""
    path = as_path(path)
    folder = _folder(path, chosen, texts)
    if folder is not None:
        return [FolderOutput(path, _command(folder))]
    return [FileOutput(_file(path, one), _file_kind(chosen)) for one in texts.files]


def chosen_cameras(rig: Rig, names: Sequence[str]) -> Rig:
    """Return the rig of some cameras only, in the order of the names.

    Raises
    ------
    InputError
        The rig has no such camera.
    """
    for name in names:
        rig.camera(name)
    covariance = (
        rig.covariance if tuple(rig.cameras) == tuple(names) else None
    )  # it is of all, in their order
    return rig.model_copy(
        update={"cameras": {name: rig.cameras[name] for name in names}, "covariance": covariance}
    )


def _folder(path: Path, chosen: RigFormat, texts: RigTexts) -> dict[str, str | bytes] | None:
    """Return the texts by name where they are to be a folder, else None."""
    if chosen.home is Home.FOLDER:
        return {one.label: one.text for one in texts.files}
    if not path.suffix and texts.files[0].label:
        return {f"{one.label}{chosen.suffixes[0]}": one.text for one in texts.files}
    return None


def _file(path: Path, one: OutputText) -> Path:
    """Return where one text goes that is no part of a folder."""
    return path.with_name(f"{path.stem}-{one.label}{path.suffix}") if one.label else path


def _file_kind(chosen: RigFormat) -> FileKind:
    """Return the kind of a file that is no part of a folder."""
    return FileKind(
        f"cameras of {chosen.name}",
        lambda content: chosen.recognises(content.decode("latin-1")),
        chosen.mark,
    )


def _command(folder: dict[str, str | bytes]) -> str:
    return f"convert {sorted(folder)}"


def _require_size(path: Path, length: int, most: int) -> None:
    """Raise where there is more to read than any cameras take."""
    if length > most:
        raise InputError(f"{path} is not read: there are more than {most} bytes, and no file of cameras has.")
