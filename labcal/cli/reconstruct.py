"""``labcal reconstruct``: points in space from dots."""

from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.options import add_output, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.solve.centre_bias import CentreBias
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
    add_output(parser, "points.csv", "table of points to write")
    add_workers(parser)


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


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Reconstruct and write the points."""
    from collections import Counter

    from labcal.cameras.rig import Rig
    from labcal.cli.inputs import paths_read, read_or_detect
    from labcal.correspond.points import KIND, points_csv
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.run.outputs import write_file
    from labcal.solve.fitted_model import FittedModel
    from labcal.solve.ray_misses import MOST_PX
    from labcal.solve.reconstruction import load_reconstructor, reconstruct_centres

    read = paths_read([arguments.model, arguments.source, arguments.target])
    claim_outputs([FileOutput(arguments.output, KIND)], read, force=arguments.force)
    model = load_reconstructor(arguments.model)
    detections = read_or_detect(arguments.source, None, arguments.workers, session)
    target = _target(arguments)
    found = reconstruct_centres(model, detections, target)
    points = found.points
    write_file(arguments.output, points_csv(points), force=arguments.force)
    flags = dict(sorted(Counter(points.flag.tolist()).items()))
    told = ", ".join(f"{count} {flag}" for flag, count in flags.items())
    result = ReconstructResult(str(arguments.output), len(points), flags, found.bias, found.miss_px)
    if found.bias is not None:
        told += f"; taken off: centroid minus centre, RMS {found.bias.rms:.4f} px"
    elif target is None and (isinstance(model, Rig) or model.resected is not None):
        session.warn(
            "the points are those of centroids, not of centres: the dots' target is not known. Name it: "
            "--target NAME"
        )
    if isinstance(model, FittedModel) and model.misfit:
        session.warn(
            f"when it was fitted, '{model.estimator.method}' was found to err by far more than the noise "
            "leaves, or than it says: its points are flagged 'model-misfit'. Fit another method; 'hybrid' is "
            "the one to begin with."
        )
    if isinstance(model, Rig) and result.miss_px is not None and result.miss_px > MOST_PX:
        session.warn(
            f"the rays of a dot miss each other by {result.miss_px:.3g} px: the cameras are not as they were "
            "when this rig was calibrated, or not the same. Calibrate again."
        )
    session.emit(result, f"{arguments.output}: {told}.")
    return ExitStatus.DONE


def _target(arguments: Namespace) -> "Target | None":
    """Return the target that is named, or the shoot's, or None."""
    from labcal.shoot.dataset import is_shoot, open_shoot
    from labcal.targets.catalogue import load_target

    if arguments.target is not None:
        return load_target(arguments.target)
    source = Path(arguments.source)
    return open_shoot(source).target if is_shoot(source) else None
