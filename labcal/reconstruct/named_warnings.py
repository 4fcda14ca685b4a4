"""Warnings of a reconstruction of named points."""

import numpy as np

from labcal.calibrate.systematic_residual import SystematicResidual
from labcal.cameras.rig import Rig
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import PointFlag
from labcal.estimators.model import Model
from labcal.reconstruct.frames.fitted_frame import FittedFrame, FrameKind
from labcal.reconstruct.named_reconstruction import NamedReconstruction
from labcal.wording import counted, listed


def named_warnings(model: Model | Rig, found: NamedReconstruction) -> tuple[str, ...]:
    """Return the warnings in words.

    Parameters
    ----------
    model : Model or Rig
    found : NamedReconstruction
    """
    warnings = [*_about_the_model(model), *_about_residuals(found), *_about_places(model, found.points)]
    if found.frame is not None:
        warnings += [*found.frame.warnings, *_about_frame(found.frame, found.points)]
    if found.scale is not None:
        warnings += found.scale.warnings
    if found.marks is not None:
        warnings += found.marks.warnings
    if not found.points.ok.any():
        warnings.append("none of the points is flagged 'ok': see their flags before you use them")
    return tuple(warnings)


def _about_the_model(model: Model | Rig) -> list[str]:
    """Return the warnings about a method or a calibration that is not to be relied on."""
    warnings = []
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
    return warnings


def _about_residuals(found: NamedReconstruction) -> list[str]:
    """Return the warnings about triangulation residuals."""
    check = found.check
    if check is None:
        return []
    if not (check.inconsistent or check.views):
        return _about_what_is_alike(found.systematic)
    causes = (
        "the pixels are not those of the pictures as they were taken, count from another corner, are noisier "
        "than stated, or a camera has changed since it was calibrated"
    )
    if check.inconsistent:
        warning = (
            f"the triangulation residual is {check.rms_px:.3g} px RMS, but {check.expected_px:.3g} px is "
            f"expected from the calibration and the noise of the pixels: {causes}. All points are flagged "
            "'model-misfit'."
        )
        return [warning]
    warning = (
        "in some views the triangulation residual is far larger than expected from the calibration and the "
        f"noise of the pixels: {causes}. Their points are flagged 'model-misfit'. Views: "
        f"{listed(check.views)}."
    )
    return [warning]


def _about_what_is_alike(part: SystematicResidual | None) -> list[str]:
    """Return the warning about what residuals have in common."""
    if part is None or not part.beyond_chance:
        return []
    warning = (
        f"{part.rms_px:.3g} px of the triangulation residuals are alike all over the pictures, but "
        f"{part.expected_px:.3g} px are expected from the noise of the pixels and the calibration's own "
        f"errors (probability {part.p_value:.0e}): a camera has moved or was refocused, its pictures are "
        "shifted, or the pixels are noisier than stated. All points are flagged 'model-misfit'."
    )
    return [warning]


def _about_places(model: Model | Rig, points: NamedPoints) -> list[str]:
    """Return the warnings about points that have no place, or whose pixels were left out."""
    warnings = []
    few = np.flatnonzero(points.flag == PointFlag.TOO_FEW_CAMERAS.value)
    if len(few):
        needed = (
            "fewer than two cameras measured them, and one gives their direction alone, not their place"
            if isinstance(model, Rig)
            else "the method takes the pixels of all of its cameras"
        )
        warnings.append(
            f"{counted(len(few), 'point')} without a place, flagged 'too-few-cameras', since {needed}: "
            f"{_names(points, few)}"
        )
    outside = np.flatnonzero(points.flag == PointFlag.OUTSIDE_PICTURE.value)
    if len(outside):
        sizes = ", ".join(f"'{name}' {width} x {height}" for name, (width, height) in _sizes(model).items())
        warnings.append(
            f"{counted(len(outside), 'point')} with a pixel outside of its picture (of {sizes} px), which "
            f"was not used: {_names(points, outside)}. Are these pictures of another size?"
        )
    return warnings


def _about_frame(frame: FittedFrame, points: NamedPoints) -> list[str]:
    """Return a warning where a frame rests on points that are not to be relied on."""
    own = (points.view == frame.view) & np.isin(points.name, frame.names) & ~points.ok
    if frame.kind is FrameKind.BOARD or not own.any():
        return []
    return [f"the frame rests on points that are not flagged 'ok': {_names(points, np.flatnonzero(own))}"]


def _names(points: NamedPoints, rows: np.ndarray) -> str:
    return listed(list(dict.fromkeys(points.name[rows].tolist())))


def _sizes(model: Model | Rig) -> dict[str, tuple[int, int]]:
    """Return the pictures' sizes by camera, px."""
    if isinstance(model, Rig):
        return {name: record.size for name, record in model.cameras.items()}
    return dict(zip(model.cameras, model.image_sizes, strict=True))
