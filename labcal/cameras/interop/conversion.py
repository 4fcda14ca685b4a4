"""Conversion of files between labcal and other systems: what is wanted, what came of it, and cameras."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from labcal.arguments import any_number, one_text, set_checked, texts, whole_number, wrong_type
from labcal.bounds import LONGEST_SIDE_PX
from labcal.cameras.interop.exchange import ReadOptions, Unit
from labcal.cameras.interop.registry import format_by_name, format_to_write
from labcal.cameras.interop.remarks import remarks_on
from labcal.cameras.interop.rig_files import (
    baseline_mm,
    chosen_cameras,
    read_rig_files,
    rig_outputs,
    write_rig_files,
)
from labcal.cameras.rig import contradiction_note
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path, as_text
from labcal.public_object import HtmlTable, PublicObject
from labcal.run.claims import claim_outputs


@dataclass(frozen=True)
class ConvertSettings:
    """Facts that the files to convert do not state, and options of the conversion.

    Examples
    --------
    >>> from labcal.pipeline import ConvertSettings
    >>> ConvertSettings(from_format="kalibr", size=(640, 480)).unit is None
    True
    """

    from_format: str | None = None
    """Recognised by the content if left out."""
    to_format: str | None = None
    """Determined by the ending of the output if that is clear."""
    only: Sequence[str] = ()
    """These cameras alone, in this order; all where empty."""
    target: AnyPath | None = None
    """Of detections: what the pictures show."""
    cameras: Mapping[str, str] | str | None = None
    """Of detections: cameras by the images' names, as in ``_0=left,_1=right``."""
    size: tuple[int, int] | str | None = None
    """Width and height of the pictures, px: ``(1280, 960)``, or ``"1280x960"``."""
    unit: str | None = None
    """Of lengths in the files that are read, ``mm`` or ``m``."""
    lens: str | None = None
    """Of files with four coefficients of OpenCV that do not state it: ``brown5`` or ``fisheye-kb4``."""
    key: Mapping[str, str] | Sequence[str] | str | None = None
    """Of OpenCV's files: their keys by the usual ones, ``camera_matrix=cameraMatrixL``."""
    columns: str | None = None
    """Of tables of pixels without a fixed form: ``point=id,left=x+u:y+v,right=x+q:y+r``; ``+`` adds."""
    likelihood: float | None = None
    """Of DeepLabCut's tables: least likelihood of a pixel that is used; 0.6 if left out."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, or there is no such size or unit.
        """
        values: dict[str, object] = {"only": texts(self.only, "only")}
        for name in ("from_format", "to_format", "unit", "lens", "columns"):
            given = getattr(self, name)
            values[name] = None if given is None else one_text(given, name)
        if self.target is not None:
            values["target"] = as_text(self.target)
        if self.size is not None:
            values["size"] = _picture_size(self.size)
        if self.key is not None:
            values["key"] = _keys(self.key)
        if self.likelihood is not None:
            values["likelihood"] = _likelihood(self.likelihood)
        _unit(self.unit)
        set_checked(self, values)

    @property
    def picture_size(self) -> tuple[int, int] | None:
        """Width and height of the pictures, px, as numbers."""
        return self.size if isinstance(self.size, tuple) else None

    @property
    def keys(self) -> Mapping[str, str] | None:
        """Keys of files by the usual ones."""
        return self.key if isinstance(self.key, Mapping) else None

    def refuse(self, names: Iterable[str], why: str) -> None:
        """Raise where something is given that would be dropped.

        Raises
        ------
        InputError
            It is; `why`, which begins with a verb, states what it goes with.
        """
        for name in names:
            if getattr(self, name) not in (None, ()):
                raise InputError(f"`{name}` {why}. Leave it out.")


@dataclass(frozen=True, eq=False, repr=False)
class Conversion(PublicObject):
    """Result of a conversion; the JSON document of ``labcal convert``."""

    source: str
    """Format of what was read."""
    wanted: str
    """Format of what was written."""
    files: list[str]
    cameras: list[str]
    points: int | None
    """Of detections; null for cameras."""
    unit: str | None
    """Unit that was assumed of lengths in the files of cameras that were read; labcal's own are in mm."""
    baseline_mm: float | None
    """From the first camera to the second, of those that were read; null for one camera and detections."""
    notes: list[str]
    """Notes for the reader of the files."""
    inconsistent: list[str]
    """Causes of contradictions between the views that a rig was calibrated from, the likeliest first."""

    def _summary(self) -> Mapping[str, object]:
        of = {"cameras": self.cameras} if self.points is None else {"points": self.points}
        return {"source": self.source, "wanted": self.wanted, "files": self.files, **of}

    def _html_tables(self) -> Sequence[HtmlTable]:
        return [HtmlTable(("notes",), [[note] for note in self.notes])]


def convert_cameras(
    inputs: Sequence[AnyPath],
    output: AnyPath,
    settings: ConvertSettings,
    read: Iterable[Path],
    *,
    force: bool,
) -> Conversion:
    """Write cameras in the format of another system, or read them from one.

    Parameters
    ----------
    inputs : sequence of paths
        A file, one a camera, or a folder.
    output : path
        The file to write; of COLMAP, a folder.
    settings : ConvertSettings
    read : iterable of paths
        All files that are read, none of which is replaced.
    force : bool
        Replace what labcal wrote there.

    Raises
    ------
    InputError
        The cameras cannot be read, or not be held by that format; or a setting would be dropped.
    OutputError
        The output may not be written.
    """
    paths, output = [as_path(one) for one in inputs], as_path(output)
    to_format = settings.to_format
    wanted = format_by_name(to_format) if to_format else format_to_write(output)
    given = read_options(settings)
    source, found = read_rig_files(paths, settings.from_format, given)
    rig = chosen_cameras(found.rig, list(settings.only)) if settings.only else found.rig
    texts = wanted.write(rig, output.suffix)
    claim_outputs(rig_outputs(output, wanted, texts), read, force=force)
    files = write_rig_files(output, wanted, texts, force=force)
    notes = [*found.notes, *texts.notes]
    contradiction = contradiction_note(rig)
    if contradiction is not None:
        notes.append(contradiction)
    cameras = {name: rig.camera(name) for name in rig.cameras}
    notes += remarks_on(cameras, source)
    return Conversion(
        source=source.name,
        wanted=wanted.name,
        files=[str(file) for file in files],
        cameras=list(rig.cameras),
        points=None,
        unit=None if found.unit is None else found.unit.value,
        baseline_mm=baseline_mm(found.rig),
        notes=notes,
        inconsistent=[] if rig.calibration is None else list(rig.calibration.inconsistent),
    )


def read_options(settings: ConvertSettings) -> ReadOptions:
    """Return what settings state of files of cameras.

    Raises
    ------
    InputError
        A setting goes with other files.
    """
    settings.refuse(("target", "cameras"), "goes with detections (.csv, corners.vnl), not with cameras")
    settings.refuse(("columns", "likelihood"), "goes with tables of pixels, not with cameras")
    return ReadOptions(settings.picture_size, _unit(settings.unit), settings.lens, settings.keys)


def _picture_size(given: object) -> tuple[int, int]:
    """Return a picture size that is given as a pair of numbers, or as text such as ``"1280x960"``."""
    if isinstance(given, str):
        given = [int(side) if side.isdecimal() else side for side in given.split("x")]
    sides = tuple(given) if isinstance(given, Iterable) and not isinstance(given, str) else ()
    if len(sides) != 2:  # noqa: PLR2004 -- width and height
        raise wrong_type(given, "width and height in pixels, as in (1280, 960)", "size")
    width, height = (whole_number(side, "size", 1) for side in sides)
    if max(width, height) > LONGEST_SIDE_PX:
        raise InputError(f"`size` is at most {LONGEST_SIDE_PX} px a side, but {width} x {height} was given.")
    return (width, height)


def _keys(given: Mapping[str, str] | Sequence[str] | str) -> dict[str, str]:
    """Return keys of files by the usual ones, from a mapping or from texts such as ``a=b,c=d``."""
    if isinstance(given, Mapping):
        return {one_text(usual, "key"): one_text(theirs, "key") for usual, theirs in given.items()}
    listed = [given] if isinstance(given, str) else texts(given, "key")
    keys: dict[str, str] = {}
    for part in [part for text in listed for part in text.split(",")]:
        usual, _, theirs = (word.strip() for word in part.partition("="))
        if not (usual and theirs) or usual in keys:
            raise InputError(
                "`key` is a list such as camera_matrix=cameraMatrixL, each name once, but "
                f"'{part:.60}' was given."
            )
        keys[usual] = theirs
    return keys


def _likelihood(given: object) -> float:
    """Return a likelihood, 0 to 1."""
    likelihood = any_number(given, "likelihood", "a number from 0 to 1")
    if not 0.0 <= likelihood <= 1.0:
        raise InputError(f"`likelihood` is a number from 0 to 1, but {likelihood:g} was given.")
    return likelihood


def _unit(name: str | None) -> Unit | None:
    """Return a unit by its name."""
    if name is None:
        return None
    if name not in [unit.value for unit in Unit]:
        raise InputError(f"`unit` is {' or '.join(unit.value for unit in Unit)}, but '{name}' was given.")
    return Unit(name)
