"""What a reconstruction is told to be careful of."""

from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.points import PointFlag
from labcal.solve.fitted_model import FittedModel
from labcal.solve.ray_misses import MOST_PX
from labcal.solve.reconstruction import Reconstruction


def reconstruction_warnings(
    model: FittedModel | Rig, detections: Detections, found: Reconstruction, target_known: str | None
) -> tuple[str, ...]:
    """Return what is not as it should be, for people.

    Parameters
    ----------
    model : FittedModel or Rig
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
            "--target NAME"
        )
    if isinstance(model, FittedModel) and model.misfit:
        warnings.append(
            f"when it was fitted, '{model.estimator.method}' was found to err by far more than the noise "
            "leaves, or than it says: its points are flagged 'model-misfit'. Fit another method; 'hybrid' is "
            "the one to begin with."
        )
    if isinstance(model, Rig) and found.miss_px is not None and found.miss_px > MOST_PX:
        warnings.append(
            f"the rays of a dot miss each other by {found.miss_px:.3g} px: the cameras are not as they were "
            "when this rig was calibrated, or not the same. Calibrate again."
        )
    without = [view for view in detections.views if view not in set(found.points.view.tolist())]
    if without:
        warnings.append(f"no dot was measured by all cameras in {len(without)} views: {', '.join(without)}")
    if not (found.points.flag == PointFlag.OK.value).any():
        warnings.append("not one of the points is 'ok': see their flags before they are used")
    return tuple(warnings)
