"""``labcal scene``: what stands in the rendered laboratory."""

from argparse import Namespace
from dataclasses import dataclass

from labcal.cli.options import add_output, add_seed
from labcal.cli.parser import CommandGroup, Parser
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.wording import counted


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    scene = commands.add_group("scene", "List, show and check scenes.", example="labcal scene check lab.yaml")
    scene.add("list", run_list, "List the scenes that labcal ships.", example="labcal scene list")
    show = scene.add(
        "show",
        run_show,
        "Show a scene as YAML, to change and render.",
        example="labcal scene show webcam-plane > lab.yaml",
    )
    check = scene.add(
        "check",
        run_check,
        "Check a scene without rendering it: what is wrong with it.",
        example="labcal scene check lab.yaml",
    )
    gallery = scene.add(
        "gallery",
        run_gallery,
        "Render a picture of every scene that labcal ships, and a page of them.",
        example="labcal scene gallery -o docs/gallery --force",
    )
    for parser in (show, check):
        add_scene(parser)
    add_output(gallery, "DIR", "folder to appear")
    for parser in (check, gallery):
        add_seed(parser)


def add_scene(parser: Parser) -> None:
    """Add the scene's name and ``--set``."""
    parser.add_argument("scene", metavar="SCENE", help="name of a scene, or path of a YAML file")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="key=value",
        dest="overrides",
        help="change a value of the scene: --set noise=off --set cameras.left.focal_px=800",
    )


@dataclass(frozen=True)
class SceneEntry:
    """A scene in the JSON document of ``labcal scene list``."""

    name: str
    target: str
    cameras: dict[str, tuple[int, int]]
    views: int
    description: str


@dataclass(frozen=True)
class SceneList:
    """The JSON document of ``labcal scene list``."""

    scenes: list[SceneEntry]


@dataclass(frozen=True)
class SceneCheck:
    """The JSON document of ``labcal scene check``."""

    scene: str
    ok: bool
    views: list[str]


@dataclass(frozen=True)
class SceneGallery:
    """The JSON document of ``labcal scene gallery``."""

    page: str
    scenes: list[str]


def run_list(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - it has no arguments
    """List the shipped scenes."""
    from rich.table import Table

    from labcal.report.columns import name_column
    from labcal.scene.catalogue import load_scene, scene_names
    from labcal.scene.views import planned_views

    entries = []
    for name in scene_names():
        scene = load_scene(name)
        sizes = {camera: description.size for camera, description in scene.cameras.items()}
        entries.append(
            SceneEntry(name, scene.target.name, sizes, len(planned_views(scene, 0)), scene.description)
        )
    table = Table(name_column("scene"), name_column("target"), "cameras", "views", "what it is")
    for entry in entries:
        cameras = ", ".join(f"{camera} {w} x {h}" for camera, (w, h) in entry.cameras.items())
        table.add_row(entry.name, entry.target, cameras, str(entry.views), entry.description)
    session.emit(SceneList(entries), table)
    return ExitStatus.DONE


def run_show(arguments: Namespace, session: Session) -> ExitStatus:
    """Show one scene."""
    from labcal.scene.catalogue import load_scene

    scene = load_scene(arguments.scene, tuple(arguments.overrides))
    session.emit(scene, scene.to_yaml().rstrip())
    return ExitStatus.DONE


def run_check(arguments: Namespace, session: Session) -> ExitStatus:
    """Check one scene."""
    from labcal.scene.catalogue import load_scene
    from labcal.scene.check import check_scene
    from labcal.scene.views import planned_views

    scene = load_scene(arguments.scene, tuple(arguments.overrides))
    check_scene(scene, arguments.seed)
    views = [view.name for view in planned_views(scene, arguments.seed)]
    session.emit(
        SceneCheck(scene.name, ok=True, views=views),
        f"{scene.name}: {counted(len(views), 'view')}, nothing wrong.",
    )
    return ExitStatus.DONE


def run_gallery(arguments: Namespace, session: Session) -> ExitStatus:
    """Render the gallery."""
    from labcal.bench.gallery import make_gallery
    from labcal.run.claims import FolderOutput, claim_outputs

    claim_outputs([FolderOutput(arguments.output)], (), force=arguments.force)
    with session.progress() as progress:
        scenes = make_gallery(arguments.output, arguments.seed, progress, force=arguments.force)
    page = str(arguments.output / "README.md")
    session.emit(SceneGallery(page, scenes), f"{page}: {counted(len(scenes), 'scene')}.")
    return ExitStatus.DONE
