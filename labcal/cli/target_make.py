"""``labcal target make``: a target designed for cameras, distance and paper."""

import re
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.numbers import numbers
from labcal.cli.options import add_seed
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import InputError

if TYPE_CHECKING:
    from labcal.guide.target_design.cameras import KnownCameras
    from labcal.guide.target_design.question import TargetQuestion

USUAL_SENSOR = "webcam-2000"
"""Preset of a sensor where none is named: the noisiest one."""


def add_make(target: CommandGroup) -> None:
    """Describe ``target make`` and its arguments."""
    make = target.add(
        "make",
        run_make,
        "Design a target for cameras, distance and paper: the smallest dots that are found safely, and as "
        "many as there is room for. It is tried in drawn pictures; shipped targets that would do are named. "
        "Then take 12 to 25 views over the whole depth, tilted by 25 to 45 degrees to all sides: fewer or "
        "flatter ones cost accuracy (measured: docs/how-to/choose-a-target.md).",
        example="labcal target make --size 1280x960 --fov 60 --distance 400,800 "
        "-o board.yaml --print board.pdf\n"
        "  labcal target make --rig rig.json --distance 500,700 --paper a3 -o board.yaml",
    )
    make.add_argument(
        "-o", "--output", type=Path, metavar="FILE.yaml",
        help="the description to write, which every command takes as --target; left out: only told",
    )  # fmt: skip
    make.add_argument("--force", action="store_true", help="replace what labcal made there")
    make.add_argument(
        "--print", dest="print_file", type=Path, metavar="FILE.pdf",
        help="the sheet to print, too, at exact scale on pages of the paper",
    )  # fmt: skip
    _add_cameras(make)
    _add_paper(make)
    add_seed(make)


def _add_cameras(make: ArgumentParser) -> None:
    make.add_argument("--size", metavar="WxH", help="width and height of the pictures, px: 1280x960")
    make.add_argument("--fov", metavar="DEG", help="the lens: its field of view along the width, degrees")
    make.add_argument("--focal-px", metavar="PX", help="or its focal length in pixels")
    make.add_argument("--focal-mm", metavar="MM", help="or in mm, together with --pixel-um")
    make.add_argument("--pixel-um", metavar="UM", help="pitch of the sensor's pixels, micrometres")
    make.add_argument(
        "--lens", default="brown5", metavar="MODEL", help="lens model: fisheye-kb4 for a fisheye (brown5)"
    )
    make.add_argument(
        "--rig", metavar="RIG",
        help="in place of these: cameras of a rig.json, a plan of 'labcal rehearse' or a scene; a plan "
        "brings distances, working volume and sensor, too",
    )  # fmt: skip
    make.add_argument(
        "--distance", metavar="MM[,MM]",
        help="working distance, or the least and the greatest one: 400,800",
    )  # fmt: skip
    make.add_argument(
        "--volume", metavar="W,H",
        help="width and height of the working volume, mm: the board is not larger",
    )  # fmt: skip
    make.add_argument(
        "--tilt", default="50", metavar="DEG",
        help="greatest tilt at which all of it is to be found (50): more tilt takes larger dots",
    )  # fmt: skip
    make.add_argument(
        "--sensor", metavar="PRESET",
        help=f"preset of a sensor, whose noise and blur are assumed ({USUAL_SENSOR})",
    )  # fmt: skip


def _add_paper(make: ArgumentParser) -> None:
    make.add_argument(
        "--paper", default="a4", metavar="NAME",
        help="a5, a4, letter, a3, a2, a1, a0, or sides in mm as 300x200 (a4); it is held either way",
    )  # fmt: skip
    make.add_argument(
        "--tiles", default="1x1", metavar="CxR",
        help="sheets side by side and one above the other, to be joined: 2x2",
    )  # fmt: skip
    make.add_argument(
        "--printer-margin", default="5", metavar="MM", help="rim that the printer leaves bare (5)"
    )
    make.add_argument("--kind", default="dots", metavar="KIND", help="dots, charuco or coded-dots (dots)")
    make.add_argument("--name", metavar="NAME", help="name of the target; by paper and counts where left out")


def run_make(arguments: Namespace, session: Session) -> ExitStatus:
    """Design a target."""
    from labcal.pipeline import make_target
    from labcal.report.target_design_result import design_result, design_table

    question = _question(arguments)
    with session.progress() as progress:
        found = make_target(
            question,
            arguments.output,
            arguments.print_file,
            seed=arguments.seed,
            force=arguments.force,
            progress=progress,
        )
    result = design_result(found, arguments.output, arguments.print_file)
    session.emit(result, design_table(result))
    return ExitStatus.DONE


def counts_of(text: str, name: str) -> tuple[int, int]:
    """Return two whole numbers with an x between them.

    Raises
    ------
    InputError
        It is anything else.
    """
    found = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text.strip().lower())
    if found is None:
        raise InputError(
            f"{name} takes two whole numbers with an x between them, as 1280x960, but '{text}' was given."
        )
    return int(found[1]), int(found[2])


def _question(arguments: Namespace) -> "TargetQuestion":
    from labcal.guide.target_design.cameras import sensor_of
    from labcal.guide.target_design.question import TargetQuestion
    from labcal.targets.paper import paper_of

    known = _known(arguments)
    distances = numbers(arguments.distance, "--distance") or known.distances_mm
    if distances is None or len(distances) > 2:  # noqa: PLR2004 -- a near and a far one
        raise InputError(
            "The working distance is not known. Give --distance in mm: one number, or least and greatest."
        )
    room = numbers(arguments.volume, "--volume") or known.room_mm
    if room is not None and len(room) != 2:  # noqa: PLR2004 -- width and height
        raise InputError("--volume takes a width and a height in mm, as 300,200.")
    photometry = known.photometry
    if arguments.sensor is not None or photometry is None:
        photometry = sensor_of(arguments.sensor or USUAL_SENSOR)
    return TargetQuestion(
        cameras=known.cameras,
        near_mm=min(distances),
        far_mm=max(distances),
        paper=paper_of(arguments.paper),
        tiles=counts_of(arguments.tiles, "--tiles"),
        tilt_max_deg=_number(arguments.tilt, "--tilt") or 0.0,
        kind=arguments.kind,
        photometry=photometry,
        printer_margin_mm=_number(arguments.printer_margin, "--printer-margin") or 0.0,
        room_mm=None if room is None else (room[0], room[1]),
        name=arguments.name,
    )


def _known(arguments: Namespace) -> "KnownCameras":
    """Return the cameras that are given, by a file or by size and lens."""
    from labcal.guide.target_design.cameras import KnownCameras, described_camera, known_cameras

    described = {
        "size": None if arguments.size is None else counts_of(arguments.size, "--size"),
        "fov_deg": _number(arguments.fov, "--fov"),
        "focal_px": _number(arguments.focal_px, "--focal-px"),
        "focal_mm": _number(arguments.focal_mm, "--focal-mm"),
        "pixel_um": _number(arguments.pixel_um, "--pixel-um"),
    }
    given = {name: value for name, value in described.items() if value is not None}
    if arguments.rig is not None:
        if given:
            raise InputError("The cameras are given by --rig, and by size and lens, too: keep one of them.")
        return known_cameras(arguments.rig)
    if "size" not in given or len(given) == 1:
        raise InputError(
            "The cameras are not known. Give --rig, or --size with --fov, --focal-px, or --focal-mm and "
            "--pixel-um."
        )
    return KnownCameras({"camera": described_camera({**given, "lens": arguments.lens})})


def _number(text: str | None, name: str) -> float | None:
    """Return the number of an option; None where it is not given."""
    found = numbers(text, name)
    if len(found) > 1:
        raise InputError(f"{name} takes one number, but '{text}' was given.")
    return found[0] if found else None
