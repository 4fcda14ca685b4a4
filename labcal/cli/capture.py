"""``labcal capture``: a shoot from cameras, real, replayed or simulated."""

import os
import sys
from argparse import Namespace
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.guide_options import add_guide, guide_settings
from labcal.cli.options import TogetherAction, add_cameras, add_output, add_seed, positive_number
from labcal.cli.parser import CommandGroup
from labcal.cli.print_scale import add_print_scale
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import InputError
from labcal.run.decimal_words import decimal
from labcal.wording import counted

if TYPE_CHECKING:
    from labcal.capture.settings import CaptureSettings
    from labcal.live.result import CapturedLive


_LIVE = ("uvc:", "genicam:")
"""Beginnings of addresses of cameras before which a person holds a target."""


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    from labcal.capture.addresses import KINDS

    parser = commands.add(
        "capture",
        run,
        "Take pictures with cameras into a shoot, or with what stands in for them. The shoot is whole after "
        "every view.",
        example="labcal capture left=uvc:0 right=uvc:2 --target paper-13x10 --views 20 -o shoot",
    )
    parser.add_argument(
        "sources",
        nargs="+",
        metavar="SOURCE",
        help="address of a source, with the camera's name before, as in left=uvc:0; several are triggered "
        f"together. {'; '.join(f'{kind.name}:{kind.place}: {kind.does}' for kind in KINDS.values())}",
    )
    add_output(parser, "SHOOT", "folder to appear")
    parser.add_argument(
        "--target",
        metavar="NAME",
        action=TogetherAction,
        help="the target; a scene brings its own, and so do a shoot that is replayed and a print with a "
        "code. Given several times: boards side by side, without --guided and --page",
    )
    add_print_scale(parser, "it goes into shoot.json")
    parser.add_argument(
        "--views", type=positive_number, metavar="N", help="number of views (live cameras: 20)"
    )
    parser.add_argument(
        "--interval-s",
        type=decimal,
        default=1.0,
        metavar="S",
        help="seconds between views of live cameras (default 1)",
    )
    parser.add_argument(
        "--on-enter",
        action="store_true",
        help="take each view when the Enter key is pressed, not by the clock",
    )
    parser.add_argument(
        "--stage",
        type=Path,
        metavar="poses.csv",
        help="a stage's readings, one line a view: view,role,X_mm,Y_mm,Z_mm,rx_deg,ry_deg,rz_deg",
    )
    parser.add_argument(
        "--every",
        type=positive_number,
        metavar="N",
        help="of videos: take one frame in N, not the sharpest of each second",
    )
    parser.add_argument(
        "--video-offset",
        type=decimal,
        metavar="FRAMES",
        help="of two videos: how many frames later a moment comes in the second one; estimated from the "
        "target's motion where not given",
    )
    parser.add_argument(
        "--exposure-us", type=decimal, metavar="T", help="exposure time to set and lock, microseconds"
    )
    parser.add_argument(
        "--gain", type=decimal, metavar="G", help="gain to set and lock, in the device's unit"
    )
    parser.add_argument(
        "--timeout-s",
        type=decimal,
        default=5.0,
        metavar="S",
        help="longest wait for a picture, seconds (default 5)",
    )
    parser.add_argument(
        "--max-skew-ms",
        type=decimal,
        default=50.0,
        metavar="MS",
        help="refuse sets whose pictures are further apart in time (default 50)",
    )
    parser.add_argument(
        "--tries",
        type=positive_number,
        default=5,
        metavar="N",
        help="of live cameras: end with an error after N refused sets in a row (default 5)",
    )
    add_cameras(parser, "folder: and watch:")
    parser.add_argument(
        "--page",
        action="store_true",
        help="take the views on a page in a browser on this computer, which shows what the cameras see and "
        "what to do next, and ends in SHOOT-rig.json and SHOOT-rig.html; needs the extra 'page'",
    )
    parser.add_argument(
        "--page-port",
        type=int,
        default=0,
        metavar="N",
        help="port of the page on 127.0.0.1 (default: any that is free)",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="key=value",
        dest="overrides",
        help="of sim: change a value of the scene, such as spp=16",
    )
    add_guide(parser)
    add_seed(parser)


@dataclass(frozen=True)
class RefusedEntry:
    """A set that did not enter the shoot, in the JSON document of ``labcal capture``."""

    number: int
    view: str | None
    reasons: list[str]


@dataclass(frozen=True)
class GuidedEntry:
    """The end of a guided capture, in the JSON document of ``labcal capture``."""

    done: bool
    """True if the error asked for is reached."""
    words: str
    reached_mm: float | None
    """Expected RMS 3-D error over the volume."""
    calibration_mm: float | None
    """The calibration's share of it."""
    wanted_mm: float | None
    usable_views: int
    shape_mm: float | None
    """The expected error after a rigid alignment of the points: of their shape and size; null of one
    camera."""


@dataclass(frozen=True)
class CaptureResult:
    """The JSON document of ``labcal capture``."""

    shoot: str
    cameras: list[str]
    views: int
    images: int
    refused: list[RefusedEntry]
    notes: list[str]
    guided: GuidedEntry | None
    rig: str | None = None
    """With ``--page``: the calibrated rig; else null."""
    page: str | None = None
    """With ``--page``: the page of the calibration; else null."""


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Take the pictures."""
    from labcal.capture.advice_text import summary
    from labcal.cli.compiling import announce_compiling
    from labcal.pipeline import CaptureSettings, SourceSettings, capture
    from labcal.run.begun import COMMAND
    from labcal.run.claims import FolderOutput, claim_outputs

    if not os.path.lexists(arguments.output / COMMAND):  # else it is gone on with
        places = [address.partition(":")[2] for address in arguments.sources]
        read = [*places, *([arguments.stage] if arguments.stage else [])]
        claim_outputs([FolderOutput(arguments.output)], read, force=arguments.force)
    sources = SourceSettings(
        exposure_us=arguments.exposure_us,
        gain=arguments.gain,
        timeout_s=arguments.timeout_s,
        cameras=arguments.cameras,
        raw=arguments.raw,
        seed=arguments.seed,
        every=arguments.every,
        video_offset=arguments.video_offset,
        overrides=tuple(arguments.overrides),
    )
    settings = CaptureSettings(
        views=arguments.views,
        interval_s=arguments.interval_s,
        max_skew_ms=arguments.max_skew_ms,
        stage=arguments.stage,
        source_settings=sources,
        tries=arguments.tries,
        print_scale=arguments.print_scale,
        force=arguments.force,
        guide=guide_settings(arguments),
    )
    if arguments.guided and arguments.page:
        session.warn("the page guides in any case, and --guided adds nothing to --page")
    ask = _asks(arguments, session)
    if arguments.guided or arguments.page:
        announce_compiling(session)
    made: CapturedLive | None = None
    if arguments.page:
        made = _on_page(arguments, settings, session)
        captured = made.captured
    else:
        with nullcontext() if arguments.guided else session.progress() as progress:
            captured = capture(arguments.sources, arguments.output, arguments.target, settings, ask, progress)
    for note in captured.notes:
        session.warn(note)
    shoot = captured.shoot
    refused = [RefusedEntry(one.number, one.view, list(one.reasons)) for one in captured.refused]
    for one in refused:
        session.warn(f"set {one.number} was refused: {'; '.join(one.reasons)}")
    images = sum(len(view.images) for view in shoot.views())
    advice = captured.advice
    guided = None if advice is None else GuidedEntry(
        advice.done, advice.words, advice.reached_mm, advice.calibration_mm, advice.wanted_mm, advice.views,
        advice.shape_mm,
    )  # fmt: skip
    result = CaptureResult(
        str(arguments.output),
        list(shoot.cameras),
        len(shoot.views()),
        images,
        refused,
        list(captured.notes),
        guided,
        None if made is None else str(made.rig),
        None if made is None else str(made.page),
    )
    words = f"{arguments.output}: {counted(result.images, 'picture')} of {counted(result.views, 'view')}."
    words += "" if advice is None else f"\n{summary(advice)}"
    session.emit(result, words if made is None else f"{words}\nThe rig: {made.rig}, its page: {made.page}.")
    if advice is not None and advice.wanted_mm is not None and not advice.done:
        return ExitStatus.PARTIAL
    return ExitStatus.PARTIAL if refused and captured.replayed else ExitStatus.DONE


def _asks(arguments: Namespace, session: Session) -> Callable[[str], None] | None:
    """Return what is called before each set: a wait for a person, or the advice that is shown alone."""
    live = any(address.rpartition("=")[2].startswith(_LIVE) for address in arguments.sources)
    if arguments.on_enter or (arguments.guided and live):
        return _wait_for_enter
    return session.say if arguments.guided else None


def _on_page(arguments: Namespace, settings: "CaptureSettings", session: Session) -> "CapturedLive":
    """Take the pictures on a page."""
    from labcal.cli.option_words import in_options
    from labcal.pipeline import LiveSettings, PageOutput, capture_live

    if arguments.on_enter:
        raise InputError("--on-enter and --page each say when a view is taken. Leave one of them out.")

    def opened(address: str) -> None:
        sys.stderr.write(f"Open this address in a browser on this computer:\n\n    {address}\n\n")
        sys.stderr.write("Only this computer can open it, and only with all its letters. Ctrl-C ends.\n")
        sys.stderr.flush()

    place = arguments.output.with_name(f"{arguments.output.name}-rig.html")
    page = PageOutput(place, arguments.force, session.command, in_options)
    live = LiveSettings(port=arguments.page_port, opened=opened, page=page)
    return capture_live(arguments.sources, arguments.output, arguments.target, settings, live)


def _wait_for_enter(words: str) -> None:
    """Ask a person for the next view."""
    many = "\n" in words
    sys.stderr.write(f"{words}\nTake the pose" if many else words)
    sys.stderr.write(", then press Enter. ")
    sys.stderr.flush()
    if not sys.stdin.readline():
        raise EOFError
