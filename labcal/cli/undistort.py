"""``labcal undistort``: pictures as ideal cameras would have taken them."""

import math
from argparse import ArgumentTypeError, Namespace
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.inputs import paths_read, pictures_given
from labcal.cli.options import add_output, refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    import numpy as np

    from labcal.cameras.camera import Camera
    from labcal.cameras.rig import Rig
    from labcal.correspond.sources import Source

_PAIR = 2


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "undistort",
        run,
        "Make pictures as pinhole cameras in the same places would have taken them. DIR gets images, maps "
        "and the new "
        "cameras, rig.json.",
        example="labcal undistort rig.json photos --cameras '_0=left,_1=right' --rectify -o rectified",
    )
    parser.add_argument("model", type=Path, metavar="rig.json", help="the cameras, from 'labcal calibrate'")
    parser.add_argument(
        "pictures", nargs="+", metavar="SHOOT-or-IMAGES", help="one shoot, or pictures and folders"
    )
    parser.add_argument(
        "--cameras",
        metavar="NAMES",
        help="cameras of loose pictures by the end of the name, '_0=left,_1=right', or by a pattern: "
        "'left*=left,right*=right', 'L/*=left,R/*=right'; '*=camera' says that one camera took all",
    )
    parser.add_argument(
        "--rectify", action="store_true", help="turn a pair so that a point has the same row in both pictures"
    )
    parser.add_argument(
        "--whole",
        action="store_true",
        help="enlarge the pictures so that nothing within 60 degrees of the axis is cut (as --rectify does)",
    )
    parser.add_argument(
        "--distance-mm",
        type=_distance,
        metavar="D",
        help="where the pictures are right, for a lens prescription or behind a window",
    )
    add_output(parser, "DIR", "folder to appear")


def _distance(text: str) -> float:
    """Read a distance."""
    from labcal.bounds import LEAST_MM, MOST_MM

    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not LEAST_MM <= value <= MOST_MM:
        raise ArgumentTypeError(f"'{text}' should be a distance in mm, more than 0, up to {MOST_MM:g}")
    return value


@dataclass(frozen=True)
class UndistortResult:
    """The JSON document of ``labcal undistort``."""

    folder: str
    images: list[str]
    """Relative to the folder."""
    cameras: list[str]
    skipped: list[str]
    """Pictures that could not be used, each with its reason."""


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Resample all pictures and write them with the maps and the new cameras."""
    from labcal.cameras.rig import Rig, contradiction_note, read_rig, write_rig
    from labcal.correspond.refused_pictures import no_picture_left, shared_reasons
    from labcal.errors import InputError
    from labcal.run.claims import FolderOutput, claim_outputs
    from labcal.run.unfinished import abandon, unfinished_folder
    from labcal.wording import counted

    rig = read_rig(arguments.model)
    if arguments.rectify:
        refuse_option(arguments, "whole", "is what --rectify does anyway")
    sources = [_with_camera(source, rig) for source in pictures_given(arguments, session)]
    names = list(dict.fromkeys(source.camera for source in sources))
    if all(rig.camera(name).optics.closed for name in names):
        refuse_option(arguments, "distance_mm", "is for a lens prescription or a flat window; there is none")
    ideals = _ideal_cameras(arguments, rig, names)
    how = (arguments.rectify, arguments.whole, arguments.distance_mm)
    command = f"undistort {rig.model_dump_json()} {[source.image for source in sources]} {how}"
    read = paths_read([arguments.model, *arguments.pictures], sources)
    claim_outputs([FolderOutput(arguments.output, command)], read, force=arguments.force)
    with unfinished_folder(arguments.output, command, force=arguments.force) as working:
        maps = {
            name: _write_map(working, name, rig.camera(name), ideal, arguments.distance_mm)
            for name, ideal in ideals.items()
            if any(source.camera == name and _fits(source, rig) for source in sources)
        }
        ideal = Rig.of(ideals).model_copy(update={"calibration": rig.calibration})
        write_rig(working / "rig.json", ideal, force=True)
        written, skipped = [], []
        with session.progress() as progress:
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
    for shared in shared_reasons(skipped):
        session.warn(shared.words)
    if told := contradiction_note(rig):
        session.warn(told)
    result = UndistortResult(str(arguments.output), written, list(ideals), [reason for _, reason in skipped])
    session.emit(result, f"{arguments.output}: {counted(len(written), 'picture')} of {', '.join(ideals)}.")
    return ExitStatus.PARTIAL if skipped or told else ExitStatus.DONE


def _with_camera(source: "Source", rig: "Rig") -> "Source":
    """Return a picture of a camera of the rig; loose pictures without --cameras are the only camera's."""
    from dataclasses import replace

    from labcal.errors import InputError

    if source.camera in rig.cameras:
        return source
    if source.camera == "camera" and len(rig.cameras) == 1:
        return replace(source, camera=next(iter(rig.cameras)))
    raise InputError(
        f"{source.image} is of camera '{source.camera}', but the rig has only {', '.join(rig.cameras)}. Tell "
        f"cameras by "
        "the end of the pictures' names: --cameras '_0=left,_1=right'."
    )


def _ideal_cameras(arguments: Namespace, rig: "Rig", names: list[str]) -> "dict[str, Camera]":
    """Return the camera that each camera's pictures shall be those of."""
    from labcal.cameras.ideal import ideal_camera, rectified_pair, whole_ideal_camera
    from labcal.errors import InputError

    if arguments.rectify:
        if len(rig.cameras) != _PAIR:
            raise InputError(
                f"--rectify takes a rig of two cameras, but this one has {len(rig.cameras)}. Choose two: "
                f"'labcal convert "
                "rig.json pair.json --only left,right'."
            )
        first, second = rig.cameras
        pair = rectified_pair(rig.camera(first), rig.camera(second))
        return dict(zip((first, second), pair, strict=True))
    make = whole_ideal_camera if arguments.whole else ideal_camera
    return {name: make(rig.camera(name)) for name in names}


def _write_map(
    folder: Path, name: str, camera: "Camera", ideal: "Camera", distance_mm: float | None
) -> "np.ndarray":
    """Write where each new pixel comes from (R: x, G: y, B: 1 where there is such a place), and return it."""
    import numpy as np

    from labcal.cameras.remapping import source_pixels
    from labcal.run.made import make_folder
    from labcal.shoot.exr import write_exr

    source = source_pixels(camera, ideal, distance_mm)
    seen = np.isfinite(source).all(axis=2)
    picture = np.where(seen[..., None], source, np.float32(-1.0))
    make_folder(folder / "maps")
    texts = {
        "labcal:map": "R, G: x, y in the original picture, px, (0, 0) the centre of its top-left pixel; B: 1 "
        "where "
        "the camera images what the pixel looks at"
    }
    path = folder / "maps" / f"{name}.exr"
    write_exr(path, np.dstack([picture, seen.astype(np.float32)]), texts, force=True)
    return source


def _fits(source: "Source", rig: "Rig") -> bool:
    """Tell whether a picture is of its camera's size: no map is computed for what only a file says."""
    from labcal.errors import InputError

    try:
        height, width = source.read().shape[:2]
    except InputError:
        return False
    return (width, height) == rig.cameras[source.camera].size


def _write_picture(folder: Path, source: "Source", rig: "Rig", source_of: "np.ndarray | None") -> str:
    """Resample one picture and return its new name; there is a map where any picture of the camera fits."""
    import numpy as np

    from labcal.errors import InputError
    from labcal.run.made import make_folder
    from labcal.shoot.exr import write_exr
    from labcal.shoot.pictures import write_picture
    from labcal.shoot.resampling import resampled

    picture = source.read()
    size, expected = (picture.shape[1], picture.shape[0]), rig.cameras[source.camera].size
    if size != expected or source_of is None:
        raise InputError(
            f"{source.image} is {size[0]} x {size[1]}, but camera '{source.camera}' takes {expected[0]} x "
            f"{expected[1]}: it "
            "is a picture of another camera, or it was scaled."
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
