"""Pictures as ideal cameras in the same places would have taken them, with the maps and the new cameras."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from pathlib import Path

import numpy as np

from labcal.arguments import set_checked, truth_value, wrong_type
from labcal.bounds import LEAST_MM, MOST_MM
from labcal.cameras.camera import Camera
from labcal.cameras.ideal import ideal_camera, rectified_pair, whole_ideal_camera
from labcal.cameras.remapping import source_pixels
from labcal.cameras.rig import Rig, contradiction_note
from labcal.cameras.rig_file import write_rig
from labcal.correspond.picture_set import PictureSet
from labcal.correspond.refused_pictures import no_picture_left, shared_reasons
from labcal.correspond.sources import Source
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.public_object import HtmlTable, PublicObject
from labcal.run.claims import FolderOutput, claim_outputs
from labcal.run.made import make_folder
from labcal.run.progress import Progress
from labcal.run.unfinished import abandon, unfinished_folder
from labcal.shoot.exr import write_exr
from labcal.shoot.pictures import write_picture
from labcal.shoot.resampling import resampled

_PAIR = 2


@dataclass(frozen=True)
class UndistortSettings:
    """Options of the undistorted pictures.

    Examples
    --------
    >>> from labcal.pipeline import UndistortSettings
    >>> UndistortSettings(rectify=True).whole
    False
    """

    rectify: bool = False
    """A pair is turned so that a point has the same row in both pictures."""
    whole: bool = False
    """The pictures are enlarged so that nothing within 60 degrees of the axis is cut."""
    distance_mm: float | None = None
    """Distance at which the pictures are right, for a lens prescription or behind a window."""
    force: bool = False
    """Replace what labcal made there."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, or there is no such distance.
        """
        flags = {name: truth_value(getattr(self, name), name) for name in ("rectify", "whole", "force")}
        set_checked(self, flags)
        if self.distance_mm is None:
            return
        if isinstance(self.distance_mm, bool) or not isinstance(self.distance_mm, Real):
            raise wrong_type(self.distance_mm, "a distance in mm", "distance_mm")
        if not LEAST_MM <= self.distance_mm <= MOST_MM:
            raise InputError(
                f"`distance_mm` must be from {LEAST_MM:g} to {MOST_MM:g}, but {self.distance_mm!r} was given."
            )
        set_checked(self, {"distance_mm": float(self.distance_mm)})


@dataclass(frozen=True, eq=False, repr=False)
class Undistorted(PublicObject):
    """Result of an undistortion; the JSON document of ``labcal undistort``."""

    folder: str
    images: list[str]
    """Relative to the folder."""
    cameras: list[str]
    skipped: list[str]
    """Pictures that could not be used, each with its reason."""
    inconsistent: list[str]
    """Causes of contradictions between the views that the rig was calibrated from, the likeliest first."""
    warnings: list[str]
    """Warnings, for people."""

    def _summary(self) -> Mapping[str, object]:
        return {
            "folder": self.folder,
            "images": len(self.images),
            "cameras": self.cameras,
            "skipped": len(self.skipped),
            "warnings": len(self.warnings),
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        return [HtmlTable(("skipped, and warnings",), [[one] for one in (*self.skipped, *self.warnings)])]


def undistort_pictures(
    rig: Rig,
    pictures: PictureSet,
    folder: AnyPath,
    settings: UndistortSettings,
    read: Iterable[Path],
    progress: Progress,
) -> Undistorted:
    """Resample pictures as pinhole cameras in the same places would have taken them.

    Parameters
    ----------
    rig : Rig
    pictures : PictureSet
        Of its cameras; loose pictures are of the only camera where it has one.
    folder : str or os.PathLike
        To appear, with ``images``, ``maps`` and the new cameras, ``rig.json``.
    settings : UndistortSettings
    read : iterable of Path
        All files that are read, none of which is replaced.
    progress : Progress

    Raises
    ------
    InputError
        No picture can be used, one is of no camera of the rig, the rig is no pair to rectify, or a setting
        would be dropped.
    OutputError
        The folder may not be made.
    """
    folder = as_path(folder)
    if settings.rectify and settings.whole:
        raise InputError("`whole` is what `rectify` does anyway. Leave it out.")
    sources = [_with_camera(source, rig) for source in pictures.sources]
    names = list(dict.fromkeys(source.camera for source in sources))
    if settings.distance_mm is not None and all(rig.camera(name).optics.closed for name in names):
        raise InputError(
            "`distance_mm` is for a lens prescription or a flat window; there is none. Leave it out."
        )
    ideals = _ideal_cameras(settings, rig, names)
    how = (settings.rectify, settings.whole, settings.distance_mm)
    command = f"undistort {rig.model_dump_json()} {[source.image for source in sources]} {how}"
    claim_outputs([FolderOutput(folder, command)], read, force=settings.force)
    with unfinished_folder(folder, command, force=settings.force) as working:
        maps = {
            name: _write_map(working, name, rig.camera(name), ideal, settings.distance_mm)
            for name, ideal in ideals.items()
            if any(source.camera == name and _fits(source, rig) for source in sources)
        }
        known = {"calibration": rig.calibration, "target": rig.target}
        ideal = Rig.of(ideals).model_copy(update=known)
        write_rig(working / "rig.json", ideal, force=True)
        written, skipped = [], []
        progress.start("undistorting", len(sources))
        for source in sources:
            try:
                written.append(_write_picture(working, source, rig, maps.get(source.camera)))
            except InputError as error:
                skipped.append((source.image, str(error)))
            progress.advance()
        if not written:
            abandon(working)  # nothing in it is of use to a better command
            raise no_picture_left(skipped)
    warnings = [*pictures.warnings, *(shared.words for shared in shared_reasons(skipped))]
    if note := contradiction_note(rig):
        warnings.append(note)
    return Undistorted(
        folder=str(folder),
        images=written,
        cameras=list(ideals),
        skipped=[reason for _, reason in skipped],
        inconsistent=[] if rig.calibration is None else list(rig.calibration.inconsistent),
        warnings=warnings,
    )


def _with_camera(source: Source, rig: Rig) -> Source:
    """Return a picture of a camera of the rig; loose pictures without `cameras` are the only camera's."""
    if source.camera in rig.cameras:
        return source
    if source.camera == "camera" and len(rig.cameras) == 1:
        return replace(source, camera=next(iter(rig.cameras)))
    named = ",".join(f"PATTERN={name}" for name in rig.cameras)
    raise InputError(
        f"{source.image} is of camera '{source.camera}', but the rig has only {', '.join(rig.cameras)}. Give "
        f"each the name that it has in the rig: `cameras='{named}'`, where PATTERN is the end of the "
        "pictures' names (_0), or as in left* or LEFT/*."
    )


def _ideal_cameras(settings: UndistortSettings, rig: Rig, names: list[str]) -> dict[str, Camera]:
    """Return the camera that each camera's pictures shall be those of."""
    if settings.rectify:
        if len(rig.cameras) != _PAIR:
            raise InputError(
                f"`rectify` takes a rig of two cameras, but this one has {len(rig.cameras)}. Choose two "
                "with 'labcal convert': `only='left,right'`."
            )
        first, second = rig.cameras
        pair = rectified_pair(rig.camera(first), rig.camera(second))
        return dict(zip((first, second), pair, strict=True))
    make = whole_ideal_camera if settings.whole else ideal_camera
    return {name: make(rig.camera(name)) for name in names}


def _write_map(
    folder: Path, name: str, camera: Camera, ideal: Camera, distance_mm: float | None
) -> np.ndarray:
    """Write where each new pixel comes from (R: x, G: y, B: 1 where there is such a place), and return it."""
    source = source_pixels(camera, ideal, distance_mm)
    seen = np.isfinite(source).all(axis=2)
    picture = np.where(seen[..., None], source, np.float32(-1.0))
    make_folder(folder / "maps")
    texts = {
        "labcal:map": "R, G: x, y in the original picture, px, (0, 0) the centre of its top-left pixel; B: 1 "
        "where the camera images what the pixel looks at"
    }
    path = folder / "maps" / f"{name}.exr"
    write_exr(path, np.dstack([picture, seen.astype(np.float32)]), texts, force=True)
    return source


def _fits(source: Source, rig: Rig) -> bool:
    """Tell whether a picture is of its camera's size: no map is computed for what only a file says."""
    try:
        height, width = source.read().shape[:2]
    except InputError:
        return False
    return (width, height) == rig.cameras[source.camera].size


def _write_picture(folder: Path, source: Source, rig: Rig, source_of: np.ndarray | None) -> str:
    """Resample one picture and return its new name; there is a map where any picture of the camera fits."""
    picture = source.read()
    size, expected = (picture.shape[1], picture.shape[0]), rig.cameras[source.camera].size
    if size != expected or source_of is None:
        raise InputError(
            f"{source.image} is {size[0]} x {size[1]}, but camera '{source.camera}' takes {expected[0]} x "
            f"{expected[1]}: it is a picture of another camera, or it was scaled."
        )
    make_folder(folder / "images")
    made = resampled(picture, source_of)
    # Without loss, whatever the original was: it is measured in next.
    name = f"images/{source.view}_{source.camera}.{'exr' if made.dtype == np.float32 else 'png'}"
    if made.dtype == np.float32:
        write_exr(folder / name, made, {}, force=True)
    else:
        write_picture(folder / name, made, force=True)
    return name
