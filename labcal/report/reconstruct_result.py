"""What ``labcal reconstruct`` tells: the JSON document, and the same for people."""

from collections import Counter
from dataclasses import dataclass
from math import isfinite

from labcal.calibrate.centre_bias import CentreBias
from labcal.calibrate.triangulation_check import TriangulationCheck
from labcal.cameras.rig import Rig
from labcal.estimators.model import Model
from labcal.paths import AnyPath
from labcal.reconstruct.reconstruction import Reconstruction


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
    centre_bias_px: CentreBias | None
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


def reconstruct_result(file: AnyPath, model: Model | Rig, found: Reconstruction) -> ReconstructResult:
    """Return the JSON document; `file` is where the points are."""
    check = found.check
    return ReconstructResult(
        file=str(file),
        n=len(found.points),
        flags=dict(sorted(Counter(found.points.flag.tolist()).items())),
        centre_bias_px=found.bias,
        miss_px=found.miss_px if found.miss_px is None or isfinite(found.miss_px) else None,  # no ray meets
        triangulation_rms_px=None if check is None else check.rms_px,
        expected_px=None if check is None else check.expected_px,
        expected_assumed=None if check is None else check.assumed,
        inconsistent=_inconsistent(model, check),
        warnings=list(found.warnings),
    )


def reconstruct_words(result: ReconstructResult) -> str:
    """Return the document for people."""
    told = ", ".join(f"{count} {flag}" for flag, count in result.flags.items())
    if result.triangulation_rms_px is not None:
        told += f"; triangulation residual: RMS {result.triangulation_rms_px:.4f} px, "
        told += "at most some" if result.expected_assumed else "expected"
        told += f" {result.expected_px:.4f} px"
        if result.expected_assumed:
            told += " by assumption, since these cameras do not say what their calibration left"
    if result.centre_bias_px is not None:
        told += f"; taken off: centroid minus centre, RMS {result.centre_bias_px.rms:.4f} px"
    return f"{result.file}: {told}."


def _inconsistent(model: Model | Rig, check: TriangulationCheck | None) -> InconsistentPoints | None:
    """Return what speaks against the points; None where nothing does."""
    causes = [] if model.calibration is None else list(model.calibration.inconsistent)
    views = [] if check is None else list(check.views)
    return InconsistentPoints(causes, views) if causes or views else None
