"""``labcal calibrate``: cameras from a hand-held target."""

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.options import add_output, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.correspond.detections import Detections
    from labcal.solve.calibration import HandheldCalibration
    from labcal.solve.freed_dots import FreedDots
    from labcal.solve.handheld import HandheldSettings
    from labcal.solve.lens_choice import LensChoice
    from labcal.targets.catalogue import AnyTarget

DEFAULT_LENS = "brown5"
AUTO = "auto"
"""In the place of a lens model: the one that explains views best that it was not fitted to."""


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "calibrate",
        run,
        "Calibrate cameras from a target that was held in free poses. The first camera is the rig's world.",
        example="labcal calibrate detections.csv --target rings-10x8 --lens brown-k1k2 -o rig.json",
    )
    parser.add_argument("source", metavar="SHOOT-or-detections.csv", help="a shoot, or its table of dots")
    parser.add_argument("--target", metavar="NAME", help="the target; a shoot brings its own")
    parser.add_argument(
        "--lens",
        metavar="MODEL",
        help=f"lens model (default {DEFAULT_LENS}, or that of --start), or {AUTO}: chosen by views held out",
    )
    add_output(parser, "rig.json", "cameras to write")
    parser.add_argument(
        "--free-dots",
        action="store_true",
        help="estimate where each dot is on the print, too, and write it to RIG-dots.json",
    )
    parser.add_argument("--start", type=Path, metavar="rig.json", help="cameras to start from")
    parser.add_argument(
        "--fix-intrinsics", action="store_true", help="keep the lenses of --start; find only the poses"
    )
    parser.add_argument(
        "--overlay", type=Path, metavar="FILE.png", help="with --free-dots: how far dots are off, as arrows"
    )
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Calibrate and write the rig."""
    from labcal.cameras.rig import write_rig
    from labcal.cli.calibrate_result import calibrate_result, calibrate_table
    from labcal.cli.inputs import choose_target, read_or_detect
    from labcal.errors import InputError
    from labcal.run.outputs import refuse_existing, refuse_homeless
    from labcal.workflow import epipolar_rms

    outputs = [arguments.output]
    if arguments.free_dots:
        outputs.append(_dots_path(arguments.output))
    if arguments.overlay is not None:
        if not arguments.free_dots:
            raise InputError("--overlay draws how far freed dots are off. Add --free-dots.")
        outputs.append(arguments.overlay)
    for path in outputs:
        refuse_existing(path, force=arguments.force)
        refuse_homeless(path)
    settings = _settings(arguments)
    target = choose_target(arguments.target, [arguments.source])
    detections = read_or_detect(arguments.source, target, arguments.workers, session)
    lens = arguments.lens or _lens_of(settings)
    found, choice = calibrated(detections, target, lens, settings, session)
    write_rig(arguments.output, found.rig, force=arguments.force)
    if found.freed is not None:
        _write_dots(arguments, found.freed)
    known = target if found.disagreement is None else None  # else points may be nowhere near a target
    result = calibrate_result(found, epipolar_rms(found.rig, found.entering(detections), known), choice)
    session.emit(result, calibrate_table(result))
    return ExitStatus.PARTIAL if found.skipped or result.inconsistent else ExitStatus.DONE


def calibrated(
    detections: "Detections", target: "AnyTarget", lens: str, settings: "HandheldSettings", session: Session
) -> "tuple[HandheldCalibration, LensChoice | None]":
    """Return a rig and, where views held out chose the lens, how; say what is not as it should be."""
    from labcal.cli.calibrate_result import calibration_warnings
    from labcal.solve.lens_choice import choose_lens
    from labcal.workflow import calibrate

    choice = None
    if lens == AUTO:
        with session.progress() as progress:
            choice = choose_lens(detections, target, settings.bias_rounds, progress)
        lens = choice.lens
    found = calibrate(detections, target, lens, settings)
    for warning in calibration_warnings(found, lens, target.name):
        session.warn(warning)
    return found, choice


def _settings(arguments: Namespace) -> "HandheldSettings":
    """Return how to calibrate, and refuse a lens model or a rig that is of no use before any dot is found."""
    from labcal.cameras.rig import read_rig
    from labcal.errors import InputError
    from labcal.solve.adjustment.state import Lenses
    from labcal.solve.handheld import HandheldSettings, require_handheld_lens

    if arguments.lens == AUTO and arguments.start is not None:
        raise InputError(f"--lens {AUTO} tries lens models from the beginning. Leave --start out.")
    if arguments.lens not in (None, AUTO):
        require_handheld_lens(arguments.lens)
    if arguments.fix_intrinsics and arguments.start is None:
        raise InputError("--fix-intrinsics keeps the lenses of a rig. Name it: --start rig.json.")
    return HandheldSettings(
        lenses=Lenses.FIXED if arguments.fix_intrinsics else Lenses.FREE,
        start=None if arguments.start is None else read_rig(arguments.start),
        free_dots=arguments.free_dots,
    )


def _lens_of(settings: "HandheldSettings") -> str:
    """Return the lens model where none is named: that of the rig to start from, if all are alike."""
    if settings.start is None:
        return DEFAULT_LENS
    lenses = {record.lens for record in settings.start.cameras.values()}
    return lenses.pop() if len(lenses) == 1 else DEFAULT_LENS


def _dots_path(output: Path) -> Path:
    return output.with_name(f"{output.stem}-dots.json")


def _write_dots(arguments: Namespace, freed: "FreedDots") -> None:
    """Write the places of the dots and, where wanted, the picture of them."""
    from labcal.report.displacement_picture import draw_displacements
    from labcal.run.outputs import write_file
    from labcal.targets.places import write_places

    write_places(_dots_path(arguments.output), freed.places(), force=arguments.force)
    if arguments.overlay is not None:
        write_file(arguments.overlay, draw_displacements(freed), force=arguments.force)
