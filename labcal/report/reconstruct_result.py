"""Result of ``labcal reconstruct``: the JSON document, and the same for people."""

from collections import Counter
from dataclasses import dataclass
from math import isfinite
from typing import Protocol, runtime_checkable

import numpy as np

from labcal.calibrate.eccentricity import CorrectedEccentricity
from labcal.calibrate.systematic_residual import SystematicResidual
from labcal.calibrate.triangulation_check import TriangulationCheck
from labcal.cameras.rig import Rig
from labcal.estimators.model import Model
from labcal.paths import AnyPath
from labcal.reconstruct.named_reconstruction import NamedReconstruction
from labcal.reconstruct.reconstruction import Reconstruction
from labcal.reconstruct.target_scale import TargetScale
from labcal.report.budget_shares import BudgetShares, budget_shares, budget_words


@dataclass(frozen=True)
class InconsistentPoints:
    """The key ``inconsistent`` in the JSON document."""

    causes: list[str]
    """Causes of an inconsistent calibration, the likeliest first; empty if it is consistent."""
    views: list[str]
    """Views whose triangulation residuals are far larger than expected."""


@dataclass(frozen=True)
class ReconstructResult:
    """The JSON document of ``labcal reconstruct``."""

    file: str
    n: int
    flags: dict[str, int]
    centre_bias_px: CorrectedEccentricity | None
    """Eccentricity that was corrected; null if none was."""
    miss_px: float | None
    """Median triangulation residual of a dot; null if the model has no cameras."""
    triangulation_rms_px: float | None
    """RMS triangulation residual over all dots."""
    expected_px: float | None
    """Expected RMS triangulation residual: noise of the pixels and variance component of the calibration."""
    expected_assumed: bool | None
    """True if that component is assumed, since the cameras do not state their calibration's residuals."""
    inconsistent: InconsistentPoints | None
    """Contradictions that make points unreliable, beside a method's own errors; null if none are found."""
    warnings: list[str]
    """Warnings, for people."""
    budget: BudgetShares | None
    """Sources of errors in the covariances; null of a fitted method, which states its own."""
    residual_ratio: float | None
    """RMS triangulation residual over its expectation; null if the model has no cameras."""
    systematic: SystematicResidual | None
    """The part of the residuals that shifts, rotations and changes of scale of whole pictures explain, with
    its test; null where the target or the rig's covariance is not known."""
    target_scale: TargetScale | None
    """Size of the reconstructed target over the declared one, with its test; null likewise."""


def reconstruct_result(file: AnyPath, model: Model | Rig, found: Reconstruction) -> ReconstructResult:
    """Return the JSON document; `file` is where the points are."""
    check = found.check
    return ReconstructResult(
        file=str(file),
        n=len(found.points),
        flags=dict(sorted(Counter(found.points.flag.tolist()).items())),
        centre_bias_px=found.eccentricity,
        miss_px=found.miss_px if found.miss_px is None or isfinite(found.miss_px) else None,  # no ray meets
        triangulation_rms_px=None if check is None else check.rms_px,
        expected_px=None if check is None else check.expected_px,
        expected_assumed=None if check is None else check.assumed,
        inconsistent=inconsistency(model, found),
        warnings=list(found.warnings),
        budget=None if found.budget is None else budget_shares(found.budget),
        residual_ratio=None if check is None else check.rms_px / check.expected_px,
        systematic=found.systematic,
        target_scale=found.scale,
    )


def reconstruct_words(result: ReconstructResult) -> str:
    """Return the document for people, a line for each statement."""
    words = counted_flags(result.flags) + residual_words(result)
    if result.systematic is not None:
        words += (
            f", of which {result.systematic.rms_px:.4f} px alike all over the pictures (expected "
            f"{result.systematic.expected_px:.4f} px)"
        )
    if result.target_scale is not None:
        scale = result.target_scale
        words += f"\nscale of the target {scale.ppm:+.0f} ± {scale.sigma_ppm:.0f} ppm"
    if result.centre_bias_px is not None:
        words += f"\ncorrected eccentricity: RMS {result.centre_bias_px.rms:.4f} px"
    words += budget_words(result.budget)
    return f"{result.file}: {words}"


def counted_flags(flags: dict[str, int]) -> str:
    """Return how many points have each flag, for people."""
    return ", ".join(f"{count} {flag}" for flag, count in flags.items())


@runtime_checkable  # so that tests can check annotations
class ResidualFigures(Protocol):
    """The triangulation residual of a result, and what is expected of it; None without cameras."""

    @property
    def triangulation_rms_px(self) -> float | None:
        """RMS triangulation residual, px."""

    @property
    def expected_px(self) -> float | None:
        """Its expected value, px."""

    @property
    def expected_assumed(self) -> bool | None:
        """True if the calibration's part of that is assumed."""


def residual_words(result: ResidualFigures) -> str:
    """Return a line on the triangulation residual beside what is expected; nothing without cameras."""
    if result.triangulation_rms_px is None:
        return ""
    words = f"\ntriangulation residual: RMS {result.triangulation_rms_px:.4f} px, "
    words += "at most some" if result.expected_assumed else "expected"
    words += f" {result.expected_px:.4f} px"
    if result.expected_px:
        words += f" ({result.triangulation_rms_px / result.expected_px:.2f} times)"
    if result.expected_assumed:
        words += " by assumption, since these cameras do not state their calibration's residuals"
    return words


def inconsistency(
    model: Model | Rig, found: Reconstruction | NamedReconstruction
) -> InconsistentPoints | None:
    """Return what speaks against points; of a camera that has changed, all views do."""
    known = _inconsistent_points(model, found.check)
    if found.systematic is None or not found.systematic.beyond_chance:
        return known
    return InconsistentPoints([] if known is None else known.causes, np.unique(found.points.view).tolist())


def _inconsistent_points(model: Model | Rig, check: TriangulationCheck | None) -> InconsistentPoints | None:
    """Return what speaks against the points; None where nothing does."""
    causes = [] if model.calibration is None else list(model.calibration.inconsistent)
    views = [] if check is None else list(check.views)
    return InconsistentPoints(causes, views) if causes or views else None
