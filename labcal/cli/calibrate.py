"""``labcal calibrate``: cameras from a hand-held target."""

from argparse import Namespace
from dataclasses import dataclass
from typing import TYPE_CHECKING

from labcal.cli.options import add_output, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.solve.calibration import HandheldCalibration


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
    parser.add_argument("--lens", default="brown5", metavar="MODEL", help="lens model (default %(default)s)")
    add_output(parser, "rig.json", "cameras to write")
    add_workers(parser)


@dataclass(frozen=True)
class CameraResult:
    """One camera in the JSON document of ``labcal calibrate``."""

    rms_px: float
    """Of this camera calibrated alone."""
    rms_in_rig_px: float
    K: list[list[float]]
    lens: str
    dist: list[float]
    views: int
    dots: int


@dataclass(frozen=True)
class CalibrateResult:
    """The JSON document of ``labcal calibrate``."""

    cameras: dict[str, CameraResult]
    rms_px: float
    epipolar_rms_px: float
    skipped: list[str]


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Calibrate and write the rig."""
    from labcal.cameras.rig import write_rig
    from labcal.cli.detect import choose_target
    from labcal.cli.inputs import read_or_detect
    from labcal.run.outputs import refuse_existing
    from labcal.solve.handheld import calibrate_handheld, require_handheld_lens
    from labcal.workflow import epipolar_rms

    refuse_existing(arguments.output, force=arguments.force)
    require_handheld_lens(arguments.lens)
    target = choose_target(arguments.target, [arguments.source])
    detections = read_or_detect(arguments.source, target, arguments.workers, session)
    found = calibrate_handheld(detections, target, arguments.lens)
    write_rig(arguments.output, found.rig, force=arguments.force)
    for reason in found.skipped:
        session.warn(f"left out {reason}")
    result = _result(found, epipolar_rms(found.rig, detections))
    session.emit(result, _table(result))
    return ExitStatus.PARTIAL if found.skipped else ExitStatus.DONE


def _result(found: "HandheldCalibration", epipolar_rms_px: float) -> CalibrateResult:
    cameras = {
        name: CameraResult(
            rms_px=found.fits[name].rms_px,
            rms_in_rig_px=found.fits[name].rms_in_rig_px,
            K=[list(row) for row in record.K],
            lens=record.lens,
            dist=list(record.dist),
            views=len(found.fits[name].views),
            dots=found.fits[name].dots,
        )
        for name, record in found.rig.cameras.items()
    }
    return CalibrateResult(cameras, found.rms_px, epipolar_rms_px, list(found.skipped))


def _table(result: CalibrateResult) -> object:
    from rich.table import Table

    caption = f"rig: RMS {result.rms_px:.4f} px"
    if len(result.cameras) > 1:
        caption += f", epipolar RMS {result.epipolar_rms_px:.4f} px"
    table = Table("camera", "RMS alone, in rig [px]", "fx, fy [px]", "cx, cy [px]", "lens", "views", "dots")
    table.caption = caption
    for name, camera in result.cameras.items():
        (fx, _, cx), (_, fy, cy), _ = camera.K
        lens = f"{camera.lens} " + " ".join(f"{k:.5g}" for k in camera.dist)
        rms = f"{camera.rms_px:.4f}, {camera.rms_in_rig_px:.4f}"
        counts = (str(camera.views), str(camera.dots))
        table.add_row(name, rms, f"{fx:.2f}, {fy:.2f}", f"{cx:.2f}, {cy:.2f}", lens, *counts)
    return table
