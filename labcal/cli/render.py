"""``labcal render``: a shoot from the rendered laboratory."""

from argparse import Namespace
from dataclasses import dataclass

from labcal.cli.options import add_output, add_seed, add_workers, positive_number
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.wording import counted


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    from labcal.cli.scene import add_scene

    parser = commands.add(
        "render",
        run,
        "Render a scene into a shoot: pictures, a manifest, and the truth in a folder apart.",
        example="labcal render webcam-plane -o shoot --set noise=off",
    )
    add_scene(parser)
    add_output(parser, "SHOOT", "folder to appear")
    parser.add_argument(
        "--spp",
        type=positive_number,
        metavar="N",
        help="rays a pixel (the scene's own where not given)",
    )
    parser.add_argument("--views", type=positive_number, metavar="N", help="only the first N views")
    add_seed(parser)
    add_workers(parser)


@dataclass(frozen=True)
class RenderResult:
    """The JSON document of ``labcal render``."""

    shoot: str
    views: int
    images: int


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Render the shoot."""
    from labcal.pipeline import RenderSettings, render
    from labcal.run.claims import FolderOutput, claim_outputs

    claim_outputs([FolderOutput(arguments.output)], [arguments.scene], force=arguments.force)
    settings = RenderSettings(
        spp=arguments.spp,
        views=arguments.views,
        seed=arguments.seed,
        workers=arguments.workers,
        force=arguments.force,
    )
    with session.progress() as progress:
        shoot = render(arguments.scene, arguments.output, settings, arguments.overrides, progress)
    images = sum(len(view.images) for view in shoot.views())
    result = RenderResult(str(arguments.output), len(shoot.views()), images)
    session.emit(
        result, f"{arguments.output}: {counted(result.images, 'picture')} of {counted(result.views, 'view')}."
    )
    return ExitStatus.DONE
