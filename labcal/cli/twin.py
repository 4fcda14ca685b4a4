"""``labcal twin``: a shoot rendered again with its calibrated rig, and what that does not explain."""

from argparse import ArgumentTypeError, Namespace
from pathlib import Path

from labcal.cli.options import add_output, add_seed, add_target_and_cameras, add_workers, positive_number
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "twin",
        run,
        "Render a shoot again with its calibrated rig, lay renderings beside the photographs, and tell which "
        "residuals simulation predicts, and what it does not explain: the print, the lens, single pictures, "
        "edge widths, the paper. RIG-dots.json beside the rig is taken by itself.",
        example="labcal twin shoot rig.json -o twin\n"
        "  labcal twin photos rig.json --target rings-10x8 --cameras '_0=left,_1=right' -o twin --views 3",
    )
    parser.add_argument(
        "pictures", nargs="+", metavar="SHOOT-or-IMAGES", help="one shoot, or pictures and folders"
    )
    parser.add_argument("rig", type=Path, metavar="RIG", help="from 'labcal calibrate' of these pictures")
    add_output(parser, "DIR", "folder to appear: page, twin.json, pictures, the renderings as a shoot")
    add_target_and_cameras(parser)
    parser.add_argument(
        "--dots",
        type=Path,
        metavar="RIG-dots.json",
        help="in place of --target: the dots of this print, from 'labcal calibrate --free-dots'; of a rig "
        "with such a file beside it, --target with another target renders the print as declared",
    )
    parser.add_argument(
        "--views",
        type=_views,
        metavar="N-or-NAMES",
        help="only so many views, spread evenly over the shoot, or those named: 'pose-01,pose-07'",
    )
    parser.add_argument(
        "--spp", type=positive_number, default=256, metavar="N", help="rays a pixel at edges (default 256)"
    )
    parser.add_argument(
        "--draws",
        type=positive_number,
        default=2,
        metavar="N",
        help="renderings with noise of their own for each picture, at least 2 (default 2)",
    )
    add_seed(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Make the twin, report."""
    from labcal.cli.compiling import announce_compiling
    from labcal.cli.options import refuse_option
    from labcal.pipeline import TwinSettings, open_pictures, twin
    from labcal.report.twin_result import twin_result
    from labcal.report.twin_words import twin_words

    if arguments.dots is not None:
        refuse_option(arguments, "target", "is that of --dots, which names it")
    settings = TwinSettings(
        views=arguments.views,
        spp=arguments.spp,
        draws=arguments.draws,
        seed=arguments.seed,
        workers=arguments.workers,
        force=arguments.force,
    )
    pictures = open_pictures(arguments.pictures, arguments.cameras, arguments.raw)
    for warning in pictures.warnings:
        session.warn(warning)
    announce_compiling(session)
    shown = arguments.dots or arguments.target
    with session.progress() as progress:
        found = twin(pictures, arguments.rig, arguments.output, shown, settings, progress)
    for warning in found.warnings:
        session.warn(warning)
    result = twin_result(arguments.output, found)
    session.emit(result, twin_words(result))
    return ExitStatus.DONE


def _views(text: str) -> int | tuple[str, ...]:
    """Return a number of views, or their names."""
    if text.isdigit():
        return positive_number(text)
    names = tuple(name.strip() for name in text.split(","))
    if not all(names):
        raise ArgumentTypeError(f"should be a number, or names of views with commas, but is '{text}'")
    return names
