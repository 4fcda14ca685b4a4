"""What a reconstruction is told to be careful of."""

from labcal.calibrate.triangulation_check import TriangulationCheck
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.points import PointFlag
from labcal.estimators.model import Model
from labcal.reconstruct.reconstruction import Reconstruction
from labcal.wording import counted, listed


def reconstruction_warnings(
    model: Model | Rig, detections: Detections, found: Reconstruction, target_known: str | None
) -> tuple[str, ...]:
    """Return what is not as it should be, for people.

    Parameters
    ----------
    model : Model or Rig
    detections : Detections
        What was reconstructed from.
    found : Reconstruction
    target_known : str or None
        Name of the target; None where it is not known.
    """
    warnings = []
    if found.bias is None and target_known is None and (isinstance(model, Rig) or model.resected is not None):
        warnings.append(
            "the points are those of centroids, not of centres: the dots' target is not known. Name it: "
            "`target='NAME'`"
        )
    if isinstance(model, Model) and model.misfit:
        warnings.append(
            f"when it was fitted, '{model.estimator.method}' was found to err by far more than the noise "
            "leaves, or than it says: its points are flagged 'model-misfit'. Fit another method; 'hybrid' is "
            "the one to begin with."
        )
    if model.calibration is not None and model.calibration.inconsistent:
        warnings.append(
            "the views that these cameras were calibrated from contradict each other, likely cause: "
            f"{', or '.join(model.calibration.inconsistent)}. All points are flagged 'model-misfit'. "
            "Calibrate again."
        )
    if found.check is not None:
        warnings += _residual_warnings(found.check)
    measured = set(found.points.view.tolist())
    without = [view for view in detections.views if view not in measured]
    if without:
        views = counted(len(without), "view")
        warnings.append(f"no dot was measured by all cameras in {views}: {listed(without)}")
    if not (found.points.flag == PointFlag.OK.value).any():
        warnings.append("not one of the points is 'ok': see their flags before they are used")
    return tuple(warnings)


def _residual_warnings(check: TriangulationCheck) -> list[str]:
    """Return what speaks against points whose rays miss each other, for people."""
    if check.inconsistent:
        told = (
            f"rays miss each other by {check.rms_px:.3g} px RMS, but the calibration lets expect "
            f"{check.expected_px:.3g} px: the cameras are not as they were when they were calibrated, or not "
            "the same. All points are flagged 'model-misfit'. Calibrate again."
        )
        return [told]
    if check.views:
        told = (
            "in some views rays miss each other by far more than the calibration lets expect: a camera or "
            f"the target moved there. Their points are flagged 'model-misfit'. Views: "
            f"{listed(check.views)}."
        )
        return [told]
    return []
