"""``labcal detect``: dots in pictures."""

from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from labcal.cli.inputs import paths_read, pictures_and_target, say_whether_compiling
from labcal.cli.options import add_output, add_pictures, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.correspond.measure import Measurement
    from labcal.detect.dots import PictureDots
    from labcal.targets.catalogue import AnyTarget


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "detect",
        run,
        "Find the dots in the pictures of a shoot, or in loose pictures, and number them by the target.",
        example="labcal detect photos --target rings-10x8 --cameras '_0=left,_1=right' -o detections.csv",
    )
    add_pictures(parser)
    add_output(parser, "detections.csv", "table of dots to write")
    parser.add_argument(
        "--overlay", type=Path, metavar="DIR", help="folder for pictures with the dots drawn in"
    )
    parser.add_argument(
        "--tone-curve",
        default="linear",
        metavar="CURVE",
        help="undo the camera's tone curve first: srgb, rec709, gamma-2.2, or a CSV file with the columns "
        "value,light rising from 0,0 to 1,1 (default linear; curves of S shape move dots, the others hardly)",
    )
    add_workers(parser)


@dataclass(frozen=True)
class PictureResult:
    """One picture in the JSON document of ``labcal detect``."""

    image: str
    status: Literal["ok", "refused"]
    reason: str | None
    dots: int
    expected: int
    numberings: int | None
    """How many numberings fit as well, this one included: 1 where the dots are known for certain."""
    flags: dict[str, int]
    """How many dots have each flag but ``ok``."""


@dataclass(frozen=True)
class DetectResult:
    """The JSON document of ``labcal detect``."""

    images: list[PictureResult]
    indexed: int
    refused: int


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Detect, write the table, tell what came of each picture."""
    from labcal.correspond.detections import KIND, detections_csv
    from labcal.correspond.measure import detections_of
    from labcal.pipeline import measure
    from labcal.run.claims import FileOutput, FolderOutput, Output, claim_outputs
    from labcal.run.outputs import write_file
    from labcal.run.unfinished import unfinished_folder
    from labcal.shoot.tone_curve import find_tone_curve

    tone_curve = find_tone_curve(arguments.tone_curve)
    sources, target = pictures_and_target(arguments, session)
    drawing = "detect --overlay " + " ".join(source.image for source in sources)
    outputs: list[Output] = [FileOutput(arguments.output, KIND)]
    if arguments.overlay is not None:
        outputs.append(FolderOutput(arguments.overlay, drawing))
    read = paths_read([*arguments.pictures, arguments.target, arguments.tone_curve], sources)
    claim_outputs(outputs, read, force=arguments.force)
    say_whether_compiling(session)
    with session.progress() as progress:
        measurements = measure(sources, target, arguments.workers, progress, tone_curve)
    if arguments.overlay is not None:
        with unfinished_folder(arguments.overlay, drawing, force=arguments.force) as working:
            _write_overlays(working, measurements, target)
    result = _result(measurements, target)
    if any((image.numberings or 1) > 1 for image in result.images):
        session.warn(
            f"'{target.name}' looks the same when it is turned: all cameras of a view agree on its dots, but "
            "views may differ by such a turn. This does not matter to 'labcal calibrate'"
        )
    if result.indexed == 0:
        session.emit(result, _table(result))
        session.warn(f"no picture has dots that can be used, so {arguments.output} was not written")
        return ExitStatus.UNUSABLE
    table = detections_csv(detections_of(measurements))
    write_file(arguments.output, table, kind=KIND, force=arguments.force)
    session.emit(result, _table(result))
    return ExitStatus.PARTIAL if result.refused else ExitStatus.DONE


def _result(measurements: "list[Measurement]", target: "AnyTarget") -> DetectResult:
    images = [
        PictureResult(
            image=found.source.image,
            status="ok" if found.indexed else "refused",
            reason=found.reason,
            dots=0 if found.dots is None else int(found.dots.ok.sum()),
            expected=target.count,
            numberings=None if found.dots is None or not found.indexed else 1 + len(found.dots.others),
            flags={} if found.dots is None else _flags(found.dots),
        )
        for found in measurements
    ]
    indexed = sum(image.status == "ok" for image in images)
    return DetectResult(images, indexed, len(images) - indexed)


def _flags(dots: "PictureDots") -> dict[str, int]:
    """Return how many dots have each flag but ``ok``."""
    from collections import Counter

    return dict(sorted(Counter(flag.value for flag in dots.flag if flag.value != "ok").items()))


def _table(result: DetectResult) -> object:
    from rich.table import Table

    from labcal.cli.console import name_column
    from labcal.correspond.refused_pictures import shared_reasons

    shared = shared_reasons([(one.image, one.reason) for one in result.images if one.reason is not None])
    several = {image for reason in shared if len(reason.images) > 1 for image in reason.images}
    captions = [reason.words for reason in shared if len(reason.images) > 1]
    table = Table(
        name_column("picture"),
        "dots",
        "what came of it",
        caption="\n".join([*captions, f"{result.indexed} indexed, {result.refused} refused"]),
        caption_justify="left",
    )
    for image in result.images:
        others = ", ".join(f"{count} {flag}" for flag, count in image.flags.items())
        came = image.reason or ("ok" if not others else f"ok; not used: {others}")
        if image.image in several:
            came = "refused, see below"
        table.add_row(image.image, f"{image.dots} of {image.expected}", came)
    return table


def _write_overlays(folder: Path, measurements: "list[Measurement]", target: "AnyTarget") -> None:
    """Write each picture with its dots drawn in."""
    from labcal.report.overlay import draw_overlay
    from labcal.shoot.pictures import write_picture

    for found in measurements:
        if found.dots is not None:
            path = folder / f"{found.source.view}_{found.source.camera}.png"
            write_picture(path, draw_overlay(found.source.read(), found.dots, target), force=True)
