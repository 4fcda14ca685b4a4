"""``labcal convert``: cameras and detections from and to the files of other systems."""

from argparse import ArgumentTypeError, Namespace
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.options import refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.wording import counted

if TYPE_CHECKING:
    import numpy as np

    from labcal.targets.catalogue import AnyTarget

DETECTIONS, CORNERS = ".csv", ".vnl"
_SMALL_MM = 0.01
"""A dot whose centroid is its centre."""
_MOST_DIGITS = 9
_FORMATS = "labcal, opencv, mrcal, kalibr, ros, colmap, dice"


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "convert",
        run,
        "Convert cameras (rig.json) and detections (detections.csv) from and to the files of OpenCV, mrcal, "
        "Kalibr, ROS, COLMAP and DICe. docs/reference/formats.md says what each holds.",
        example="labcal convert rig.json rig.cameramodel\n"
        "  labcal convert rig-left.cameramodel rig-right.cameramodel rig.json\n"
        "  labcal convert rig.json stereo.yml --to opencv\n"
        "  labcal convert detections.csv corners.vnl --target rings-14x10",
    )
    parser.add_argument(
        "inputs", nargs="+", type=Path, metavar="IN", help="a file, one a camera, or a folder"
    )
    parser.add_argument("output", type=Path, metavar="OUT", help="file to write; of COLMAP, a folder")
    parser.add_argument("--force", action="store_true", help="replace what labcal made there")
    parser.add_argument(
        "--from", dest="source", metavar="FORMAT", help=f"{_FORMATS}; told by the content where left out"
    )
    parser.add_argument(
        "--to",
        dest="wanted",
        metavar="FORMAT",
        help="the same; told by the ending of OUT where that is clear",
    )
    parser.add_argument("--only", metavar="CAMERA,...", help="only these cameras, in this order")
    parser.add_argument("--target", metavar="NAME", help="for corners.vnl: what the pictures show")
    parser.add_argument(
        "--cameras",
        metavar="NAMES",
        help="from corners.vnl: cameras by the images' names, as of 'labcal detect': '_0=left,_1=right'",
    )
    parser.add_argument(
        "--size",
        type=picture_size,
        metavar="WxH",
        help="of the pictures: for corners.vnl where they are not at hand, for files of OpenCV and VIC-3D "
        "that do not say it",
    )
    parser.add_argument(
        "--unit",
        choices=["mm", "m"],
        help="what lengths in the files that are read are in, where it is not what their format has",
    )
    parser.add_argument(
        "--lens",
        metavar="MODEL",
        help="of OpenCV's files with four coefficients that do not say it: brown5 or fisheye-kb4",
    )


def picture_size(text: str) -> tuple[int, int]:
    """Read a picture size such as ``1280x960``."""
    from labcal.bounds import LONGEST_SIDE_PX

    width, x, height = text.partition("x")
    sides = [int(side) if side.isdecimal() and len(side) <= _MOST_DIGITS else 0 for side in (width, height)]
    if not (x and 1 <= min(sides) <= max(sides) <= LONGEST_SIDE_PX):
        raise ArgumentTypeError(f"'{text}' should be width and height in pixels, as in 1280x960")
    return (sides[0], sides[1])


@dataclass(frozen=True)
class ConvertResult:
    """The JSON document of ``labcal convert``."""

    source: str
    """Format of what was read."""
    wanted: str
    """Format of what was written."""
    files: list[str]
    cameras: list[str]
    points: int | None
    """Of detections; null for cameras."""
    unit: str | None
    """What lengths in the files of cameras that were read were taken for; labcal's own are in mm."""
    baseline_mm: float | None
    """From the first camera to the second, of those that were read; null for one camera and detections."""
    notes: list[str]
    """What the reader of the files should know."""
    inconsistent: list[str]
    """Why the views that a rig was calibrated from contradict each other, the likeliest cause first."""


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Convert and tell what the files do not say as the original did."""
    endings = {path.suffix.lower() for path in (*arguments.inputs, arguments.output)}
    convert = _convert_detections if endings & {DETECTIONS, CORNERS} else _convert_cameras
    result = convert(arguments)
    for note in result.notes:
        session.warn(note)
    if result.unit is not None:
        apart = "one camera"
        if result.baseline_mm is not None:
            apart = f"the first two cameras are {result.baseline_mm:.6g} mm apart"
        session.say(f"lengths of '{result.source}' were taken for {result.unit}: {apart}")
    of = counted(len(result.cameras), "camera") if result.points is None else counted(result.points, "point")
    session.emit(result, f"{', '.join(result.files)}: {of} ({', '.join(result.cameras)}), {result.wanted}.")
    return ExitStatus.PARTIAL if result.inconsistent else ExitStatus.DONE


def _convert_cameras(arguments: Namespace) -> ConvertResult:
    from labcal.cameras.blind_pixels import blind_pixels
    from labcal.cameras.interop.exchange import ReadOptions, Unit
    from labcal.cameras.interop.registry import format_by_name, format_to_write
    from labcal.cameras.interop.rig_files import (
        baseline_mm,
        chosen_cameras,
        read_rig_files,
        read_unit,
        rig_outputs,
        write_rig_files,
    )
    from labcal.cameras.rig import contradiction_note
    from labcal.cli.inputs import paths_read
    from labcal.run.claims import claim_outputs

    for option in ("target", "cameras"):
        refuse_option(arguments, option, "goes with detections (.csv, corners.vnl), not with cameras")
    output = arguments.output
    wanted = format_by_name(arguments.wanted) if arguments.wanted else format_to_write(output)
    given = ReadOptions(arguments.size, Unit(arguments.unit) if arguments.unit else None, arguments.lens)
    source, read = read_rig_files(arguments.inputs, arguments.source, given)
    rig = chosen_cameras(read.rig, arguments.only.split(",")) if arguments.only else read.rig
    texts = wanted.write(rig, output.suffix)
    claim_outputs(rig_outputs(output, wanted, texts), paths_read(arguments.inputs), force=arguments.force)
    files = write_rig_files(output, wanted, texts, force=arguments.force)
    notes = [*read.notes, *texts.notes]
    contradiction = contradiction_note(rig)
    if contradiction is not None:
        notes.append(contradiction)
    notes += [note for name in rig.cameras if (note := blind_pixels(name, rig.camera(name))) is not None]
    return ConvertResult(
        source=source.name,
        wanted=wanted.name,
        files=[str(file) for file in files],
        cameras=list(rig.cameras),
        points=None,
        unit=read_unit(source, given).value,
        baseline_mm=baseline_mm(read.rig),
        notes=notes,
        inconsistent=[] if rig.calibration is None else list(rig.calibration.inconsistent),
    )


def _convert_detections(arguments: Namespace) -> ConvertResult:
    from labcal.cli.inputs import paths_read
    from labcal.correspond import detections as labcal_table
    from labcal.correspond.detections import detections_csv, read_detections
    from labcal.correspond.interop import corners_vnl
    from labcal.correspond.interop.corners_vnl import corners_text, read_corners
    from labcal.correspond.sources import parse_camera_endings
    from labcal.errors import InputError
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.run.outputs import write_file
    from labcal.targets.catalogue import load_target

    ends = [path.suffix.lower() for path in (*arguments.inputs, arguments.output)]
    if sorted(ends) != [DETECTIONS, CORNERS]:
        raise InputError(
            "Detections are converted from one detections.csv to a corners.vnl, or back. Name both with "
            "these endings."
        )
    for option in ("source", "wanted", "unit", "lens"):
        refuse_option(arguments, option, "goes with cameras, not with detections")
    for option in ("cameras", "size") if ends[0] == DETECTIONS else ("only",):
        refuse_option(arguments, option, f"does not apply to {ends[0]} as input")
    if arguments.target is None:
        raise InputError("Say whose dots these are: --target NAME ('labcal target list' shows the names).")
    target = load_target(arguments.target)
    path, output = arguments.inputs[0], arguments.output
    kind = labcal_table.KIND if ends[0] == CORNERS else corners_vnl.KIND
    read = paths_read([*arguments.inputs, arguments.target])
    claim_outputs([FileOutput(output, kind)], read, force=arguments.force)
    if ends[0] == CORNERS:
        sides = parse_camera_endings(arguments.cameras) if arguments.cameras else {}
        corners = read_corners(path, target, sides, lambda image: arguments.size or _size_on_disk(image))
        detections = corners.detections
        ok = int(detections.ok.sum())
        _require_points(ok, path)
        write_file(output, detections_csv(detections), kind=kind, force=arguments.force)
        notes = [*corners.notes, *_taken_for_centroids(target)]
        return _converted(("mrcal", "labcal"), output, detections.cameras, ok, notes)
    detections = read_detections(path)
    if arguments.only:
        detections = detections.where(_of_cameras(detections.camera.tolist(), arguments.only.split(",")))
    found = corners_text(detections, target)
    _require_points(found.points, path)
    write_file(output, found.text, kind=kind, force=arguments.force)
    spacing_m = float(target.points()[1, 0] - target.points()[0, 0]) / 1000.0
    told = (
        f"For mrcal-calibrate-cameras: --corners-cache-has-weights --object-spacing {spacing_m!r} "
        f"--object-width-n {target.cols} --object-height-n {target.rows}. It takes the centroids of dots for "
        "images of their centres."
    )
    notes = [told]
    if found.left_out:
        alone = found.left_out == 1
        stand = "that is no measurement of the grid stands" if alone else "that are none of the grid stand"
        notes.append(f"{counted(found.left_out, 'dot')} {stand} as missing.")
    return _converted(("labcal", "mrcal"), output, detections.cameras, found.points, notes)


def _converted(
    formats: tuple[str, str], output: Path, cameras: tuple[str, ...], points: int, notes: list[str]
) -> ConvertResult:
    """Return what became of detections; `formats` are those that were read and written."""
    source, wanted = formats
    return ConvertResult(source, wanted, [str(output)], list(cameras), points, None, None, notes, [])


def _taken_for_centroids(target: "AnyTarget") -> list[str]:
    """Return a note where dots are so large that the centroids of their images are off their centres."""
    largest = float(target.outer_diameters_mm().max())
    if largest < _SMALL_MM:
        return []
    told = (
        f"x and y are taken for centroids of the dots of '{target.name}', {largest:g} mm wide. If they are "
        "corners of a chessboard, name a target with a dot_diameter_mm of 0.001."
    )
    return [told]


def _require_points(count: int, path: Path) -> None:
    """Raise where no point is a measurement."""
    from labcal.errors import InputError

    if count == 0:
        raise InputError(f"None of the points in {path} is a measurement, so there is nothing to convert.")


def _of_cameras(cameras: "list[str]", wanted: "list[str]") -> "np.ndarray":
    """Return which lines are of the cameras that are wanted."""
    import numpy as np

    from labcal.errors import InputError

    for name in wanted:
        if name not in cameras:
            raise InputError(
                f"The detections have no camera '{name}', only {', '.join(dict.fromkeys(cameras))}."
            )
    return np.isin(cameras, wanted)


def _size_on_disk(image: Path) -> tuple[int, int]:
    """Return the size of a picture that is at hand."""
    from labcal.errors import InputError
    from labcal.shoot.pictures import read_picture

    if not image.is_file():
        raise InputError(
            f"The picture {image} is not at hand, so its size is not known. Say it: --size 1280x960, or go "
            "to the folder that the names start from."
        )
    height, width = read_picture(image).shape[:2]
    return (width, height)
