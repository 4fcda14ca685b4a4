"""Conversion of detections between labcal's table and mrcal's ``corners.vnl``."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from labcal.bounds import LEAST_SHARE_OF_PITCH
from labcal.cameras.interop.conversion import Conversion, ConvertSettings
from labcal.correspond.detections_csv import KIND as TABLE_KIND
from labcal.correspond.detections_csv import detections_csv, read_detections
from labcal.correspond.interop import corners_vnl
from labcal.correspond.interop.corners_vnl import corners_text, read_corners
from labcal.correspond.sources import camera_endings
from labcal.errors import InputError, UnknownNameError
from labcal.paths import AnyPath, as_path
from labcal.run.claims import FileOutput, claim_outputs
from labcal.run.outputs import write_file
from labcal.shoot.pictures import read_picture
from labcal.targets.catalogue import AnyTarget, load_target
from labcal.wording import counted

TABLE, CORNERS = ".csv", ".vnl"
"""Endings of files that hold detections."""
_SMALL_MM = 0.01
"""A dot whose centroid is its centre."""


def is_of_detections(paths: Iterable[Path]) -> bool:
    """Tell whether files hold detections, by their endings."""
    return bool({path.suffix.lower() for path in paths} & {TABLE, CORNERS})


def convert_detections(
    inputs: Sequence[AnyPath],
    output: AnyPath,
    settings: ConvertSettings,
    read: Iterable[Path],
    *,
    force: bool,
) -> Conversion:
    """Write one ``detections.csv`` as a ``corners.vnl``, or the other way round.

    Parameters
    ----------
    inputs : sequence of paths
        One file.
    output : path
    settings : ConvertSettings
        `target` is needed.
    read : iterable of paths
        All files that are read, none of which is replaced.
    force : bool
        Replace what labcal wrote there.

    Raises
    ------
    InputError
        The files are not one of each kind, the detections cannot be read or hold no measurement, the target
        is not named, or a setting would be dropped.
    OutputError
        The output may not be written.
    """
    paths, output = [as_path(one) for one in inputs], as_path(output)
    ends = [path.suffix.lower() for path in (*paths, output)]
    if sorted(ends) != [TABLE, CORNERS]:
        raise InputError(
            "Detections are converted from one detections.csv to a corners.vnl, or back. Name both with "
            "these endings. Of tables of pixels, name the program that wrote them: `from_format='dlc'` (or "
            "colmap-tracks, dice-subsets, columns)."
        )
    settings.refuse(
        ("from_format", "to_format", "unit", "lens", "key"), "goes with cameras, not with detections"
    )
    settings.refuse(("columns", "likelihood"), "goes with tables of pixels, not with detections")
    beside = ("cameras", "size") if ends[0] == TABLE else ("only",)
    settings.refuse(beside, f"does not apply to {ends[0]} as input")
    if settings.target is None:
        raise InputError(
            "Name the target of these dots: `target='NAME'` ('labcal target list' shows the names; "
            "corners of mrgingham are those of a chessboard)."
        )
    target = load_target(settings.target)
    kind = TABLE_KIND if ends[0] == CORNERS else corners_vnl.KIND
    claim_outputs([FileOutput(output, kind)], read, force=force)
    if ends[0] == CORNERS:
        return _read(paths[0], output, target, settings, force=force)
    return _write(paths[0], output, target, settings, force=force)


def _read(
    path: Path, output: Path, target: AnyTarget, settings: ConvertSettings, *, force: bool
) -> Conversion:
    """Write the table of a ``corners.vnl``."""
    endings = {} if settings.cameras is None else camera_endings(settings.cameras)
    corners = read_corners(path, target, endings, lambda image: settings.picture_size or _size_on_disk(image))
    detections = corners.detections
    ok = int(detections.ok.sum())
    _require_points(ok, path)
    write_file(output, detections_csv(detections), kind=TABLE_KIND, force=force)
    notes = [*corners.notes, *_taken_for_centroids(target)]
    return _converted(("mrcal", "labcal"), output, detections.cameras, ok, notes)


def _write(
    path: Path, output: Path, target: AnyTarget, settings: ConvertSettings, *, force: bool
) -> Conversion:
    """Write the ``corners.vnl`` of a table."""
    detections = read_detections(path)
    if settings.only:
        detections = detections.where(_of_cameras(detections.camera.tolist(), list(settings.only)))
    found = corners_text(detections, target)
    _require_points(found.points, path)
    write_file(output, found.text, kind=corners_vnl.KIND, force=force)
    spacing_m = float(target.points()[1, 0] - target.points()[0, 0]) / 1000.0
    note = (
        f"For mrcal-calibrate-cameras: --corners-cache-has-weights --object-spacing {spacing_m!r} "
        f"--object-width-n {target.cols} --object-height-n {target.rows}."
    )
    if _has_large_dots(target):
        note += " It takes the centroids of dots for images of their centres."
    notes = [note]
    if found.left_out:
        alone = found.left_out == 1
        stand = "that is no measurement of the grid stands" if alone else "that are none of the grid stand"
        notes.append(f"{counted(found.left_out, 'dot')} {stand} as missing.")
    return _converted(("labcal", "mrcal"), output, detections.cameras, found.points, notes)


def _converted(
    formats: tuple[str, str], output: Path, cameras: tuple[str, ...], points: int, notes: list[str]
) -> Conversion:
    """Return what became of detections; `formats` are those that were read and written."""
    source, wanted = formats
    return Conversion(source, wanted, [str(output)], list(cameras), points, None, None, notes, [])


def _taken_for_centroids(target: AnyTarget) -> list[str]:
    """Return a note where dots are so large that the centroids of their images are off their centres."""
    if not _has_large_dots(target):
        return []
    largest = float(target.outer_diameters_mm().max())
    note = (
        f"x and y are taken for centroids of the dots of '{target.name}', {largest:g} mm wide. If they are "
        f"corners of a chessboard, name that as the target (kind: chessboard, with cols: {target.cols} and "
        f"rows: {target.rows})."
    )
    return [note]


def _has_large_dots(target: AnyTarget) -> bool:
    """Tell whether centroids of a target's dots are off the images of their centres."""
    return float(target.outer_diameters_mm().max()) > max(_SMALL_MM, _smallest_mm(target))


def _smallest_mm(target: AnyTarget) -> float:
    """Return the smallest dot that a target with these pitches may have, mm."""
    places = target.points().reshape(target.rows, target.cols, 3)
    return LEAST_SHARE_OF_PITCH * float(max(np.ptp(places[0, :2, 0]), np.ptp(places[:2, 0, 1])))


def _require_points(count: int, path: Path) -> None:
    """Raise where no point is a measurement."""
    if count == 0:
        raise InputError(f"None of the points in {path} is a measurement, so there is nothing to convert.")


def _of_cameras(cameras: list[str], wanted: list[str]) -> np.ndarray:
    """Return which lines are of the cameras that are wanted."""
    for name in wanted:
        if name not in cameras:
            raise UnknownNameError("camera in the detections", name, dict.fromkeys(cameras))
    return np.isin(cameras, wanted)


def _size_on_disk(image: Path) -> tuple[int, int]:
    """Return the size of a picture that is at hand."""
    if not image.is_file():
        raise InputError(
            f"The picture {image} is not at hand, so its size is not known. Give it: `size='1280x960'`, or "
            "go to the folder that the names start from."
        )
    height, width = read_picture(image).shape[:2]
    return (width, height)
