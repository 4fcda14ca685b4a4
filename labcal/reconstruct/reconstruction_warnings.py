"""Warnings of a reconstruction."""

from labcal.calibrate.systematic_residual import SystematicResidual
from labcal.calibrate.triangulation_check import TriangulationCheck
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.points import PointFlag
from labcal.estimators.model import Model
from labcal.reconstruct.reconstruction import Reconstruction
from labcal.reconstruct.target_scale import TargetScale
from labcal.targets.kept_target import other_target_note
from labcal.targets.target import Target
from labcal.wording import counted, listed


def reconstruction_warnings(
    model: Model | Rig, detections: Detections, found: Reconstruction, shown: Target | None
) -> tuple[str, ...]:
    """Return the warnings in words.

    Parameters
    ----------
    model : Model or Rig
    detections : Detections
        Pixels of the reconstructed dots.
    found : Reconstruction
    shown : Target or None
        Target of the dots; None where it is not known.
    """
    warnings = []
    if (
        found.eccentricity is None
        and shown is None
        and (isinstance(model, Rig) or model.resected is not None)
    ):
        warnings.append(
            "the points are those of centroids, not of centres: the dots' target is not known. Name it: "
            "`target='NAME'`"
        )
    other = other_target_note(model, shown) if isinstance(model, Rig) and shown is not None else None
    warnings += [] if other is None else [other]
    if isinstance(model, Model) and model.misfit:
        warnings.append(
            f"surrogate validation of '{model.estimator.method}' found errors far above the noise limit "
            "or its stated covariance: its points are flagged 'model-misfit'. Fit another method, 'hybrid' "
            "first."
        )
    if model.calibration is not None and model.calibration.inconsistent:
        warnings.append(
            "the views that these cameras were calibrated from contradict each other, likely cause: "
            f"{', or '.join(model.calibration.inconsistent)}. All points are flagged 'model-misfit'. "
            "Calibrate again."
        )
    if found.check is not None:
        warnings += _residual_warnings(found.check) or _systematic_warnings(found.systematic)
        warnings += _size_warnings(found.scale)
    measured = set(found.points.view.tolist())
    without = [view for view in detections.views if view not in measured]
    if without:
        views = counted(len(without), "view")
        warnings.append(f"no dot was measured by all cameras in {views}: {listed(without)}")
    if not (found.points.flag == PointFlag.OK.value).any():
        warnings.append("none of the points is flagged 'ok': see their flags before you use them")
    return tuple(warnings)


def _systematic_warnings(part: SystematicResidual | None) -> list[str]:
    """Return the warning about what residuals have in common, in words."""
    if part is not None and part.beyond_chance:
        warning = (
            f"{part.rms_px:.3g} px of the triangulation residuals are alike all over the pictures, but "
            f"{part.expected_px:.3g} px are expected from the noise of the dots and the calibration's own "
            f"errors (probability {part.p_value:.0e}): a camera has moved or was refocused, its pictures are "
            "shifted, or the lens model of the calibration does not suit. All points are flagged "
            "'model-misfit'. Calibrate again."
        )
        return [warning]
    return []


def _size_warnings(scale: TargetScale | None) -> list[str]:
    """Return the warning about the size of the reconstructed target, in words."""
    if scale is not None and scale.beyond_chance:
        size = "large" if scale.ppm > 0.0 else "small"
        warning = (
            f"the target is {abs(scale.ppm):.0f} ppm too {size}, but {scale.sigma_ppm:.0f} ppm (1 sigma) are "
            "explained by noise, print and calibration: a camera has moved or was refocused, pictures are "
            "shifted along the line between the cameras, or this is another print than that of the "
            "calibration"
        )
        return [warning]
    return []


def _residual_warnings(check: TriangulationCheck) -> list[str]:
    """Return the warnings about triangulation residuals, in words."""
    if check.inconsistent:
        warning = (
            f"the triangulation residual is {check.rms_px:.3g} px RMS, but {check.expected_px:.3g} px is "
            "expected from the calibration: a camera has changed since it was calibrated, or is another "
            "one. All points are flagged 'model-misfit'. Calibrate again."
        )
        return [warning]
    if check.views:
        warning = (
            "in some views the triangulation residual is far larger than expected from the calibration: a "
            f"camera or the target moved there. Their points are flagged 'model-misfit'. Views: "
            f"{listed(check.views)}."
        )
        return [warning]
    return []
