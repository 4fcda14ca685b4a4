"""``labcal calibrate``: cameras from a hand-held target."""

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.calibrate.lens_candidates import AUTO, DEFAULT_LENS
from labcal.cli.dot_places import add_dot_places, dot_treatment
from labcal.cli.options import (
    add_detector_settings,
    add_hold_out,
    add_output,
    add_page,
    add_targets,
    add_workers,
)
from labcal.cli.parser import CommandGroup
from labcal.cli.print_scale import add_print_scale, scaled_target, store_scale
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.calibrate.calibration import Calibration
    from labcal.calibrate.handheld import HandheldSettings


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "calibrate",
        run,
        "Calibrate cameras from views of a hand-held target. The first camera is the rig's world.",
        example="labcal calibrate detections.csv --target rings-10x8 --lens brown-k1k2 -o rig.json",
    )
    parser.add_argument(
        "source",
        metavar="SHOOT-or-detections.csv",
        help="a shoot, whose test views are left out, or a table of dots",
    )
    parser.add_argument(
        "--detections",
        type=Path,
        metavar="FILE",
        help="detections.csv of the shoot, instead of detecting anew",
    )
    add_hold_out(parser)
    add_targets(parser)
    add_print_scale(parser, "of a shoot it goes into shoot.json, of a table into RIG-dots.json")
    parser.add_argument(
        "--lens",
        metavar="MODEL",
        help=f"lens model (default: that of --start, or {DEFAULT_LENS} unless the views ask for another), "
        f"or {AUTO}: all models are tried on views held out",
    )
    add_output(parser, "rig.json", "cameras to write")
    add_dot_places(parser, "; the places go to RIG-dots.json")
    parser.add_argument(
        "--dots",
        type=Path,
        metavar="RIG-dots.json",
        help="keep the dots where an earlier calibration freed them on this print, with the errors of that",
    )
    parser.add_argument("--start", type=Path, metavar="rig.json", help="cameras to start from")
    parser.add_argument(
        "--fix-intrinsics", action="store_true", help="keep the lenses of --start; find only the poses"
    )
    parser.add_argument(
        "--overlay",
        type=Path,
        metavar="FILE.png",
        help="with --free-dots: arrows from declared to estimated places",
    )
    add_page(parser)
    add_detector_settings(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Calibrate and write the rig."""
    from labcal.cameras.rig_file import KIND, write_rig
    from labcal.cli.dots import dots_given, refuse_idle_detection
    from labcal.cli.page import asked_page
    from labcal.correspond.boards_table import on_target
    from labcal.correspond.dot_source import DotSource, open_dots
    from labcal.correspond.paths_read import paths_read
    from labcal.errors import InputError
    from labcal.pipeline import calibrate
    from labcal.report.calibrate_result import calibrate_result, calibrate_table
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.run.overwriting import require_name
    from labcal.shoot.pictures import png_output
    from labcal.targets.catalogue import target_of
    from labcal.targets.places import KIND as DOTS_KIND
    from labcal.wording import listed

    require_name(arguments.output)
    kept = arguments.keep_dots or arguments.dots is not None
    if arguments.overlay is not None and kept:
        raise InputError("--overlay draws the places of freed dots, but these dots are kept. Leave it out.")
    outputs = [FileOutput(arguments.output, KIND)]
    outputs += [] if kept else [FileOutput(_dots_path(arguments.output), DOTS_KIND)]
    outputs += [] if arguments.overlay is None else [png_output(arguments.overlay)]
    page = asked_page(
        arguments, session, [arguments.source, arguments.detections, arguments.dots, arguments.start]
    )
    outputs += [] if page is None else [page.file]
    read = paths_read(
        [arguments.source, arguments.detections, arguments.target, arguments.dots, arguments.start]
    )
    claim_outputs(outputs, read, force=arguments.force)
    settings = _settings(arguments)
    refuse_idle_detection(arguments)
    named = None if arguments.target is None else target_of(arguments.target)
    given = open_dots(arguments.source, arguments.detections)
    if named is None and given.shoot is None and settings.places is not None:
        named = settings.places.target
    target = scaled_target(given.target(named), arguments)
    if arguments.print_scale is not None and given.shoot is not None:
        given = DotSource(store_scale(given.shoot, target, session), given.table)
    detections = dots_given(given, target, arguments, session)
    hold_out = arguments.hold_out or ()
    with session.progress() as progress:
        made = calibrate(
            given.showing(target), detections, arguments.lens, settings, hold_out, progress, page=page
        )
    for warning in made.warnings:
        session.warn(warning)
    if made.held_out:
        note = "" if arguments.hold_out else " (test views of the shoot; '--hold-out none' uses them, too)"
        session.say(f"held out, to be scored by 'labcal evaluate': {listed(made.held_out)}{note}")
    write_rig(arguments.output, made.rig, force=arguments.force)
    _write_dots(arguments, made, session)
    result = calibrate_result(made, on_target(detections, target), target)
    session.emit(result, calibrate_table(result))
    return ExitStatus.PARTIAL if result.doubtful else ExitStatus.DONE


def _settings(arguments: Namespace) -> "HandheldSettings":
    """Return how to calibrate; raise where that is of no use, before any dot is found."""
    from labcal.calibrate.adjustment.state import Lenses
    from labcal.calibrate.calibrated import refuse_contradictory
    from labcal.calibrate.handheld import HandheldSettings

    settings = HandheldSettings(
        lenses=Lenses.FIXED if arguments.fix_intrinsics else Lenses.FREE,
        start=arguments.start,
        dot_places=dot_treatment(arguments),
        dots=arguments.dots,
    )
    refuse_contradictory(arguments.lens, settings)
    return settings


def _dots_path(output: Path) -> Path:
    return output.with_name(f"{output.stem}-dots.json")


def _write_dots(arguments: Namespace, made: "Calibration", session: Session) -> None:
    """Write the places of the dots and, where wanted, the picture of them."""
    from labcal.targets.places import write_places

    if made.places is not None:
        write_places(_dots_path(arguments.output), made.places, force=arguments.force)
    elif _dots_path(arguments.output).exists():
        session.warn(f"{_dots_path(arguments.output)} is of an earlier calibration: now no dots were freed")
    if arguments.overlay is not None and made.found.freed is None:
        session.warn(f"{arguments.overlay} is not written: no dots were freed. --free-dots frees them")
    elif arguments.overlay is not None and made.found.freed is not None:
        from labcal.report.displacement_picture import save_displacements  # imports matplotlib

        save_displacements(arguments.overlay, made.found.freed, force=arguments.force)
