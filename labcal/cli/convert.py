"""``labcal convert``: cameras and detections from and to the files of other systems."""

from argparse import Action, ArgumentParser, ArgumentTypeError, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.options import OnceAction
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.run.decimal_words import decimal
from labcal.wording import counted

if TYPE_CHECKING:
    from labcal.pipeline import ConvertSettings

_MOST_DIGITS = 9
_FORMATS = "labcal, opencv, mrcal, kalibr, ros, colmap, colmap-binary, dice, anipose, matlab, matchid"
_READ_ONLY = "euroc, camodocal, orb-slam, basalt, ost, nerfstudio, metashape"
_PIXEL_FORMATS = "colmap-tracks, dlc, dice-subsets, columns"


class _WithoutOutput(Action):
    """A switch with which OUT may be left out."""

    def __init__(self, option_strings: list[str], dest: str, output: Action, help: str) -> None:  # noqa: A002 - argparse's name
        super().__init__(option_strings, dest, nargs=0, default=False, help=help)
        self._output = output

    def __call__(
        self, _parser: ArgumentParser, namespace: Namespace, _values: object, _option: str | None = None
    ) -> None:
        """Take the switch."""
        setattr(namespace, self.dest, True)
        self._output.required = False


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "convert",
        run,
        "Convert cameras (rig.json) and detections (detections.csv) from and to the files of OpenCV, mrcal, "
        "Kalibr, ROS, COLMAP, DICe, aniposelib, MATLAB and MatchID; read those of EuRoC, VINS, ORB-SLAM, "
        "Basalt, Nerfstudio and Metashape; and make pixels.csv from tables of pixels. "
        "docs/reference/formats.md lists what each holds.",
        example="labcal convert rig.json rig.cameramodel\n"
        "  labcal convert rig-left.cameramodel rig-right.cameramodel rig.json\n"
        "  labcal convert rig.json stereo.yml --to opencv\n"
        "  labcal convert detections.csv corners.vnl --target rings-14x10\n"
        "  labcal convert left.csv right.csv pixels.csv --from dlc\n"
        "  labcal convert --check stereo.yml",
    )
    parser.add_argument(
        "inputs", nargs="+", type=Path, metavar="IN", help="a file, one a camera, or a folder"
    )
    output = parser.add_argument(
        "output", type=Path, metavar="OUT", help="file to write; of COLMAP, a folder"
    )
    parser.add_argument(
        "--check",
        action=_WithoutOutput,
        output=output,
        help="write nothing: print what is understood of cameras, as unit, baseline, lens and field of view",
    )
    parser.add_argument("--force", action="store_true", help="replace what labcal made there")
    parser.add_argument(
        "--from",
        dest="from_format",
        metavar="FORMAT",
        help=f"{_FORMATS}, {_READ_ONLY}; if left out, the content tells; of tables of pixels: "
        f"{_PIXEL_FORMATS}",
    )
    parser.add_argument(
        "--to",
        dest="to_format",
        metavar="FORMAT",
        help=f"the same up to {_FORMATS.rpartition(' ')[-1]}; determined by the ending of OUT if that is "
        "clear",
    )
    parser.add_argument(
        "--only", type=_names, default=(), metavar="CAMERA,...", help="only these cameras, in this order"
    )
    parser.add_argument(
        "--target", metavar="NAME", action=OnceAction, help="for corners.vnl: what the pictures show"
    )
    parser.add_argument(
        "--cameras",
        metavar="NAMES",
        help="from corners.vnl and tables of pixels: cameras by the names of images or files, as of 'labcal "
        "detect': '_0=left,_1=right'",
    )
    parser.add_argument(
        "--size",
        type=picture_size,
        metavar="WxH",
        help="of the pictures: for corners.vnl where they are not at hand, for files of cameras that do not "
        "state it, or exchange its sides",
    )
    parser.add_argument(
        "--unit",
        choices=["mm", "m"],
        help="unit of lengths in the files that are read, if it is not the usual one of their format",
    )
    parser.add_argument(
        "--lens",
        metavar="MODEL",
        help="of files with four coefficients of OpenCV that do not state it: brown5 or fisheye-kb4",
    )
    parser.add_argument(
        "--key",
        action="append",
        metavar="NAME=KEY,...",
        help="of OpenCV's files with keys of their own: camera_matrix=cameraMatrixL, or M1, D1, M2, D2, R, T",
    )
    parser.add_argument(
        "--columns",
        metavar="NAME=COLUMN,...",
        help="of --from columns: where pixels stand, as in 'point=id,left=x+u:y+v,right=x+q:y+r'; + adds",
    )
    parser.add_argument(
        "--likelihood",
        type=decimal,
        metavar="P",
        help="of --from dlc: least likelihood of a pixel that is used (0.6 if left out)",
    )


def _names(text: str) -> list[str]:
    """Read names between commas."""
    return text.split(",")


def picture_size(text: str) -> tuple[int, int]:
    """Read a picture size such as ``1280x960``."""
    from labcal.bounds import LONGEST_SIDE_PX

    width, x, height = text.partition("x")
    sides = [int(side) if side.isdecimal() and len(side) <= _MOST_DIGITS else 0 for side in (width, height)]
    if not (x and 1 <= min(sides) <= max(sides) <= LONGEST_SIDE_PX):
        raise ArgumentTypeError(f"'{text}' should be width and height in pixels, as in 1280x960")
    return (sides[0], sides[1])


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Convert, and report what the files do not state as the original did."""
    from dataclasses import fields

    from labcal.pipeline import ConvertSettings, convert

    settings = ConvertSettings(**{one.name: getattr(arguments, one.name) for one in fields(ConvertSettings)})
    if arguments.check:
        last = [] if arguments.output is None else [arguments.output]
        return _check([*arguments.inputs, *last], settings, session)
    result = convert(arguments.inputs, arguments.output, settings, force=arguments.force)
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


def _check(paths: list[Path], settings: "ConvertSettings", session: Session) -> ExitStatus:
    """Print what is understood of cameras."""
    from labcal.cameras.interop.understanding import described
    from labcal.pipeline import understand

    found = understand(paths, settings)
    for note in found.notes:
        session.warn(note)
    apart = "one camera"
    if found.baseline_mm is not None:
        apart = f"the first two cameras are {found.baseline_mm:.6g} mm apart"
    lines = [f"format {found.source}; lengths were taken for {found.unit}: {apart}"]
    for name, camera in found.cameras.items():
        lines += [name, *(f"  {label:<20} {text}" for label, text in described(camera))]
    session.emit(found, "\n".join(lines))
    return ExitStatus.DONE
