"""``labcal reconstruct``: points in space from dots."""

from argparse import Namespace
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.methods import own_method
from labcal.cli.options import add_output, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.calibrate.centre_bias import CentreBias
    from labcal.calibrate.triangulation_check import TriangulationCheck
    from labcal.cameras.rig import Rig
    from labcal.estimators.model import Model
    from labcal.targets.target import Target


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
    parser.add_argument(
        "--target", metavar="NAME", help="what the dots are of, so that centroids give centres; a shoot tells"
    )
    parser.add_argument(
        "--method",
        metavar="MODULE:CLASS",
        help="the method of your own that the model was fitted with, as it was named to 'labcal fit'",
    )
    add_output(parser, "points.csv", "table of points to write")
    add_workers(parser)


@dataclass(frozen=True)
class InconsistentPoints:
    """The key ``inconsistent`` in the JSON document."""

    causes: list[str]
    """Why the calibration itself is inconsistent, the likeliest first; empty where it is not."""
    views: list[str]
    """Those in which rays miss each other by far more than expected."""


@dataclass(frozen=True)
class ReconstructResult:
    """The JSON document of ``labcal reconstruct``."""

    file: str
    n: int
    flags: dict[str, int]
    centre_bias_px: "CentreBias | None"
    """Centroid minus centre, which was taken off; null where it was not."""
    miss_px: float | None
    """By how much the rays of a dot miss each other, the median; null where the model has no cameras."""
    triangulation_rms_px: float | None
    """The same as a root mean square: the triangulation residual."""
    expected_px: float | None
    """What that would be with the pixels' noise and the scatter that the calibration found."""
    expected_assumed: bool | None
    """Whether that scatter is assumed, since the cameras do not say what their calibration left."""
    inconsistent: InconsistentPoints | None
    """Why points are not to be relied on, beside a method's own errors; null where nothing is found."""
    warnings: list[str]
    """What is not as it should be."""


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Reconstruct and write the points."""
    from collections import Counter

    from labcal.cli.inputs import paths_read, read_or_detect, refuse_idle_workers
    from labcal.correspond.points import KIND, PointFlag, points_csv
    from labcal.pipeline import reconstruct
    from labcal.reconstruct.reconstruction import load_reconstructor
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.run.outputs import write_file

    refuse_idle_workers(arguments)
    read = paths_read([arguments.model, arguments.source, arguments.target])
    claim_outputs([FileOutput(arguments.output, KIND)], read, force=arguments.force)
    model = load_reconstructor(arguments.model, own_method(arguments.method))
    detections = read_or_detect(arguments.source, None, arguments.workers, session)
    target = _target(arguments)
    found = reconstruct(model, detections, target)
    points = found.points
    write_file(arguments.output, points_csv(points), kind=KIND, force=arguments.force)
    flags = dict(sorted(Counter(points.flag.tolist()).items()))
    told = ", ".join(f"{count} {flag}" for flag, count in flags.items())
    check, inconsistent = found.check, _inconsistent(model, found.check)
    miss_px = found.miss_px if found.miss_px is None or isfinite(found.miss_px) else None  # no ray meets
    result = ReconstructResult(
        str(arguments.output),
        len(points),
        flags,
        found.bias,
        miss_px,
        None if check is None else check.rms_px,
        None if check is None else check.expected_px,
        None if check is None else check.assumed,
        inconsistent,
        list(found.warnings),
    )
    if check is not None:
        told += f"; triangulation residual: RMS {check.rms_px:.4f} px, "
        told += "at most some" if check.assumed else "expected"
        told += f" {check.expected_px:.4f} px"
        if check.assumed:
            told += " by assumption, since these cameras do not say what their calibration left"
    if found.bias is not None:
        told += f"; taken off: centroid minus centre, RMS {found.bias.rms:.4f} px"
    for warning in found.warnings:
        session.warn(warning)
    session.emit(result, f"{arguments.output}: {told}.")
    return ExitStatus.PARTIAL if inconsistent or PointFlag.OK.value not in flags else ExitStatus.DONE


def _inconsistent(
    model: "Model | Rig", check: "TriangulationCheck | None"
) -> InconsistentPoints | None:
    """Return what speaks against the points; None where nothing does."""
    causes = [] if model.calibration is None else list(model.calibration.inconsistent)
    views = [] if check is None else list(check.views)
    return InconsistentPoints(causes, views) if causes or views else None


def _target(arguments: Namespace) -> "Target | None":
    """Return the target that is named, or the shoot's, or None."""
    from labcal.shoot.dataset import is_shoot, open_shoot
    from labcal.targets.catalogue import load_target

    if arguments.target is not None:
        return load_target(arguments.target)
    source = Path(arguments.source)
    return open_shoot(source).target if is_shoot(source) else None
