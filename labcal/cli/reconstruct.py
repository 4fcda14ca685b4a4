"""``labcal reconstruct``: points in space from dots."""

from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path

from labcal.cli.options import add_output, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "reconstruct",
        run,
        "Reconstruct the dots that all cameras of a model measured.",
        example="labcal reconstruct model.safetensors shoot -o points.csv",
    )
    parser.add_argument(
        "model", type=Path, metavar="MODEL-or-rig.json", help="from 'labcal fit' or 'labcal calibrate'"
    )
    parser.add_argument("source", metavar="SHOOT-or-detections.csv", help="a shoot, or its table of dots")
    add_output(parser, "points.csv", "table of points to write")
    add_workers(parser)


@dataclass(frozen=True)
class ReconstructResult:
    """The JSON document of ``labcal reconstruct``."""

    file: str
    n: int
    flags: dict[str, int]


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Reconstruct and write the points."""
    from collections import Counter

    from labcal.cli.inputs import read_or_detect
    from labcal.correspond.points import points_csv
    from labcal.run.outputs import refuse_existing, write_file
    from labcal.solve.reconstruction import load_reconstructor, reconstruct_points

    refuse_existing(arguments.output, force=arguments.force)
    model = load_reconstructor(arguments.model)
    detections = read_or_detect(arguments.source, None, arguments.workers, session)
    points = reconstruct_points(model, detections)
    write_file(arguments.output, points_csv(points), force=arguments.force)
    flags = dict(sorted(Counter(points.flag.tolist()).items()))
    told = ", ".join(f"{count} {flag}" for flag, count in flags.items())
    session.emit(ReconstructResult(str(arguments.output), len(points), flags), f"{arguments.output}: {told}.")
    return ExitStatus.DONE
