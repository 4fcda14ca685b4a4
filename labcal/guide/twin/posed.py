"""The views of a shoot with the poses of the target that suit the calibrated rig best."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.adjustment.observations import Observations, observations_of
from labcal.calibrate.adjustment.rounds import predicted_eccentricities
from labcal.calibrate.adjustment.state import RigState
from labcal.calibrate.usable_dots import in_full_pictures, unmeasured_pictures, usable_dots
from labcal.calibrate.validity.evidence import NewViews
from labcal.calibrate.validity.first_pose import first_pose
from labcal.calibrate.validity.prepared import require_cameras
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.targets.grid import DotGrid

_GROSS, _GROSS_PX = 8.0, 2.0
"""A dot that is this many times as far off as the median one, and farther than this, is left out, with a
warning: it is another dot. What is less far off is what a twin is to explain."""


@dataclass(frozen=True)
class PosedViews:
    """Views of a target before a rig that is taken as it is.

    Attributes
    ----------
    names : tuple of str
        Of the views.
    cameras : tuple of str
        Of the rig.
    state : RigState
        Cameras, the poses of the target, and its dots.
    observations : Observations
        Measured centroids, px.
    eccentricity : float64 array, (n, 2)
        Predicted centroid minus image of the centre of each, px.
    outliers : tuple of str
        Dots that were left out, for people.
    skipped : tuple of str
        Pictures that do not enter, for people.
    """

    names: tuple[str, ...]
    cameras: tuple[str, ...]
    state: RigState
    observations: Observations
    eccentricity: Pixels
    outliers: tuple[str, ...]
    skipped: tuple[str, ...]

    def residual(self) -> Float64[np.ndarray, "n 2"]:
        """Return measured minus predicted centroids, px."""
        return np.asarray(-self.eccentricity - self.state.residuals(self.observations))


def posed_views(rig: Rig, detections: Detections, target: DotGrid, dots: Vectors3) -> PosedViews:
    """Return the pose of the target in each view, all cameras together, lenses and relative poses held.

    Parameters
    ----------
    rig : Rig
    detections : Detections
        Centroids; only dots flagged ``ok`` enter.
    target : DotGrid
    dots : ndarray, shape (dots, 3)
        Places of its dots, mm.

    Raises
    ------
    InputError
        The rig has not the cameras of the dots, their pictures have another size, too few dots were
        measured, or the dots are no pictures of the target through this rig.
    """
    require_cameras(rig, detections.cameras)
    for name in detections.cameras:
        size, known = detections.picture_size(name), tuple(rig.camera(name).size)
        if size != known:
            raise InputError(
                f"The pictures of camera '{name}' are {size[0]} x {size[1]} px, but the rig's are {known[0]} "
                f"x {known[1]}. Give the rig that was calibrated from these pictures, or from such as these."
            )
    entering, few = in_full_pictures(usable_dots(detections, target))
    skipped = (*unmeasured_pictures(detections), *few)
    if len(entering) == 0:
        raise InputError("No picture shows enough dots to render it again: " + "; ".join(skipped[:3]) + ".")
    names, cameras = entering.views, tuple(rig.cameras)
    seen = observations_of(entering, target, cameras, names)
    first = np.stack([first_pose(rig, entering, view, target) for view in names])
    state = RigState(tuple(rig.camera(name) for name in cameras), first, dots)
    radii = 0.5 * target.outer_diameters_mm()
    state, seen, off = _settled(state, seen, radii)
    words = tuple(
        f"dot {tuple(target.indices()[dot].tolist())} in view '{names[view]}' of camera '{cameras[camera]}'"
        for camera, view, dot in off
    )
    return PosedViews(
        names, cameras, state, seen, predicted_eccentricities(state, seen, radii), words, skipped
    )


def _settled(
    state: RigState, seen: Observations, radii: Float64[np.ndarray, " dots"]
) -> tuple[RigState, Observations, list[tuple[int, int, int]]]:
    """Return the state with poses adjusted to dots without gross errors, these dots, and the others."""
    imaged = np.isfinite(state.residuals(seen)).all(axis=1)
    seen, off = seen.where(imaged), _keys(seen, ~imaged)
    for _ in range(3):
        moved = seen.moved(-predicted_eccentricities(state, seen, radii))
        settled = NewViews(moved, 0.0).settled(state)
        if settled is None:
            raise InputError(
                "The dots are no pictures of the target through this rig. Check that the target is the one "
                "in the pictures, and that the rig is theirs."
            )
        state = settled
        length = np.linalg.norm(state.residuals(moved), axis=1)
        gross = length > max(_GROSS * float(np.median(length)), _GROSS_PX)
        if not gross.any():
            break
        off += _keys(seen, gross)
        seen = seen.where(~gross)
    return state, seen, off


def _keys(seen: Observations, mask: np.ndarray) -> list[tuple[int, int, int]]:
    chosen = np.column_stack([seen.camera, seen.view, seen.dot])[mask].tolist()
    return [(camera, view, dot) for camera, view, dot in chosen]
