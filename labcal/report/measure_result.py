"""Result of ``labcal measure``: the JSON document, and the same for people."""

from collections import Counter
from dataclasses import dataclass
from math import isfinite, sqrt

import numpy as np
from rich.console import Group

from labcal.cameras.rig import Rig
from labcal.estimators.model import Model
from labcal.paths import AnyPath
from labcal.reconstruct.displacements import Displacements, displacement_warnings
from labcal.reconstruct.frames.fitted_frame import FittedFrame
from labcal.reconstruct.named_reconstruction import NamedReconstruction
from labcal.reconstruct.scale.fitted_scale import FittedScale
from labcal.report.budget_shares import BudgetShares, budget_shares, budget_words
from labcal.report.displacements_result import (
    DisplacementsResult,
    displacements_result,
    displacements_words,
)
from labcal.report.marks_result import MarksResult, marks_result, marks_table
from labcal.report.reconstruct_result import (
    InconsistentPoints,
    counted_flags,
    inconsistency,
    residual_words,
)
from labcal.wording import counted


@dataclass(frozen=True)
class FrameResult:
    """The key ``frame`` in the JSON document."""

    kind: str
    view: str
    """View whose points determine the frame."""
    points: int
    """Number of points that determine it."""
    T_frame_model: list[list[float]]
    """4x4: points of the model's world to points of the frame, mm; its 3x3 part holds the scale."""
    scale: float
    rotation_sigma_deg: list[float]
    """Standard deviations of rotations about the axes of the frame."""
    place_sigma_mm: list[float]
    """Standard deviations of the frame's place in the middle of the points that determine it."""
    scale_sigma_ppm: float | None
    """Of a similarity; null if the scale is not fitted."""
    rms_mm: float | None
    """RMS 3-D residual of the points that determine it; null for three points, which leave none."""
    max_mm: float | None
    """Largest residual."""
    sigma0: float | None
    """Residuals over what their covariances explain; null where nothing is left to compare."""
    residuals: list[tuple[str, list[float]]] | None
    """Residuals by name, mm: measured minus known; null for three points and for a board."""


@dataclass(frozen=True)
class MeasureResult:
    """The JSON document of ``labcal measure``, and of ``labcal reconstruct`` with named pixels."""

    file: str
    n: int
    flags: dict[str, int]
    miss_px: float | None
    """Median triangulation residual of a point; null if the model has no cameras."""
    triangulation_rms_px: float | None
    """RMS triangulation residual over all points."""
    expected_px: float | None
    """Expected RMS triangulation residual: noise of the pixels and variance component of the calibration."""
    expected_assumed: bool | None
    """True if that component is assumed, since the cameras do not state their calibration's residuals."""
    inconsistent: InconsistentPoints | None
    """Contradictions that make points unreliable; null if none are found."""
    budget: BudgetShares | None
    """Sources of errors in the covariances; null of a fitted method, which states its own."""
    frame: FrameResult | None
    """The frame of the points; null if it is that of the model."""
    scale_bars: FittedScale | None
    """The scale that scale bars gave, and their residuals; null without."""
    displacements: DisplacementsResult | None
    """Displacements since a view; null without ``--displacements``."""
    marks: MarksResult | None
    """The marks that the points are of; null if they are of named pixels."""
    warnings: list[str]
    """Warnings, for people."""


def measure_result(
    file: AnyPath,
    model: Model | Rig,
    found: NamedReconstruction,
    moved: tuple[AnyPath, Displacements] | None = None,
) -> MeasureResult:
    """Return the JSON document; `file` is where the points are, `moved` their displacements and where."""
    check = found.check
    return MeasureResult(
        file=str(file),
        n=len(found.points),
        flags=dict(sorted(Counter(found.points.flag.tolist()).items())),
        miss_px=found.miss_px if found.miss_px is None or isfinite(found.miss_px) else None,
        triangulation_rms_px=None if check is None else check.rms_px,
        expected_px=None if check is None else check.expected_px,
        expected_assumed=None if check is None else check.assumed,
        inconsistent=inconsistency(model, found),
        budget=None if found.budget is None else budget_shares(found.budget),
        frame=None if found.frame is None else _frame(found.frame),
        scale_bars=found.scale,
        displacements=None if moved is None else displacements_result(*moved),
        marks=None if found.marks is None else marks_result(found.marks),
        warnings=[*found.warnings, *(() if moved is None else displacement_warnings(moved[1]))],
    )


def measure_report(result: MeasureResult) -> Group | str:
    """Return the document for people: pictures with marks, if there are any, and the points."""
    words = measure_words(result)
    return words if result.marks is None else Group(marks_table(result.marks), words)


def measure_words(result: MeasureResult) -> str:
    """Return the document for people, a line for each statement."""
    words = counted_flags(result.flags) + residual_words(result)
    words += budget_words(result.budget)
    if result.scale_bars is not None:
        scale = result.scale_bars
        words += f"\nerror of the scale by {counted(len(scale.bars), 'measurement')} of scale bars: "
        words += f"{scale.error_ppm:+.4g} ppm, now with sigma {scale.sigma_ppm:.2g} ppm"
        words += "" if scale.sigma0 is None else f", residuals {scale.sigma0:.2g} times as expected"
    if result.frame is not None:
        turn, shift = max(result.frame.rotation_sigma_deg), max(result.frame.place_sigma_mm)
        words += (
            f"\nframe '{result.frame.kind}' of {result.frame.points} points in view '{result.frame.view}': "
        )
        words += f"sigma at most {turn:.2g} degrees and {shift:.2g} mm"
        if result.frame.scale_sigma_ppm is not None:
            words += f", scale {result.frame.scale:.8g} with sigma {result.frame.scale_sigma_ppm:.2g} ppm"
        if result.frame.rms_mm is not None:
            words += f", residuals RMS {result.frame.rms_mm:.3g} mm"
        if result.frame.sigma0 is not None:
            words += f" ({result.frame.sigma0:.2g} times what their covariances explain)"
    if result.displacements is not None:
        words += displacements_words(result.displacements)
    return f"{result.file}: {words}"


def _frame(frame: FittedFrame) -> FrameResult:
    """Return a frame as it stands in the document."""
    T_ba = np.eye(4)
    T_ba[:3, :3], T_ba[:3, 3] = frame.scale * frame.R_ba, frame.t_ba
    sigma = np.sqrt(np.diagonal(frame.parameter_covariance))
    lengths = np.linalg.norm(frame.residual, axis=1)
    fitted = frame.sigma0 is not None
    return FrameResult(
        kind=frame.kind.value,
        view=frame.view,
        points=len(frame.names),
        T_frame_model=T_ba.tolist(),
        scale=frame.scale,
        rotation_sigma_deg=np.degrees(sigma[:3]).tolist(),
        place_sigma_mm=np.sqrt(np.diagonal(frame.place_covariance)).tolist(),
        scale_sigma_ppm=1e6 * float(sigma[6]) if len(sigma) > 6 else None,  # noqa: PLR2004 -- with a scale
        rms_mm=sqrt(float((lengths**2).mean())) if fitted else None,
        max_mm=float(lengths.max()) if fitted else None,
        sigma0=frame.sigma0,
        residuals=list(zip(frame.names, frame.residual.tolist(), strict=True))
        if frame.kind.value in {"rigid", "similarity"}
        else None,
    )
