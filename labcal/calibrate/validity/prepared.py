"""New views of a target made ready for the test of a calibration: usable dots, first poses, noise."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from labcal.calibrate.adjustment.observations import Observations, observations_of
from labcal.calibrate.adjustment.outliers import outliers
from labcal.calibrate.adjustment.rounds import predicted_eccentricities
from labcal.calibrate.adjustment.state import POSE, Lenses, RigState
from labcal.calibrate.budget.view_dispersion import ViewDispersion, view_scores
from labcal.calibrate.usable_dots import in_full_pictures, unmeasured_pictures, usable_dots
from labcal.calibrate.validity.change import Change
from labcal.calibrate.validity.evidence import NewViews
from labcal.calibrate.validity.explanation import Calibrated, Explanation, Views, explained
from labcal.calibrate.validity.first_pose import first_pose
from labcal.cameras.rig import Rig
from labcal.cameras.rig_covariance import RigCovariance
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces
from labcal.wording import listed

_LEAST_NOISE = 1e-4
"""Of a dot's variance; what has none at all would weigh infinitely."""
_DISPERSED = 1.5
"""Factor of a calibration's views from which on they disagree by more than chance lets good ones."""
FEWEST_TO_DISPERSE = 2
"""Views that can disagree."""


@dataclass(frozen=True)
class Prepared:
    """New views, and the rig that they are to be explained by.

    Attributes
    ----------
    calibrated : Calibrated
    views : NewViews or MarkViews
        Without outliers.
    names : tuple of str
        Of the views.
    cameras : tuple of int
        Cameras of the rig with pictures among these.
    outliers : int
        Number of dots that were left out.
    skipped : tuple of str
        Pictures that do not enter, for people.
    noise_freedom : float
        Degrees of freedom that the noise is known with: infinite unless views disagree beyond their dots.
    camera_names : tuple of str
        By the numbers that cameras have in the state.
    poses : int
        Of the target that are free.
    marks : tuple of str
        Names of fixed marks, by number; empty of one that moved itself, and of none where a target is held.
    """

    calibrated: Calibrated
    views: Views
    names: tuple[str, ...]
    cameras: tuple[int, ...]
    outliers: int
    skipped: tuple[str, ...]
    camera_names: tuple[str, ...]
    poses: int
    marks: tuple[str, ...] = ()
    noise_freedom: float = np.inf
    excess: float = 1.0
    """Variance of residuals over what the dots and the calibration state, where anything may have changed."""
    view_factor: float = 1.0
    """Factor of variances by which the views of the calibration disagreed beyond their dots."""
    clusters: int = 1
    """Views of calibration and check together, less one for each of both."""
    with_outliers: Observations | None = None
    """All dots of a target, with the noise that is stated of them; None of marks."""

    @property
    def freedom(self) -> int:
        """Degrees of freedom that the poses of the target leave."""
        return 2 * len(self.views.observations) - POSE * self.poses

    def without_outliers(self, found: Explanation) -> "Prepared":
        """Return the views without dots that are off by themselves where everything else is explained."""
        seen = self.views.observations
        share = max(0.1, self.freedom / (2 * len(seen)))
        residual = found.evidence.state.residuals(seen)
        off = outliers(seen, residual, found.evidence.state.dots, share)
        if not off.any():
            return self
        left = replace(self.views, observations=seen.where(~off))
        return replace(self, views=left, outliers=self.outliers + int(off.sum()))


def prepared(rig: Rig, detections: Detections, shown: AnyTarget | DotPlaces) -> Prepared:
    """Return new views ready for the test.

    Parameters
    ----------
    rig : Rig
        With its covariance.
    detections : Detections
        Centroids; only dots flagged ``ok`` enter.
    shown : AnyTarget or DotPlaces
        The target, or the places of the dots on one print of it.

    Raises
    ------
    InputError
        The rig states no covariance, has not the cameras of the dots, or the dots are no pictures of the
        target through it.

    Notes
    -----
    A dot's variance is its own plus the variance component of the calibration, times the factors by which
    residuals and views exceeded these when the rig was calibrated.
    """
    covariance = covariance_of(rig)
    target = shown.target if isinstance(shown, DotPlaces) else shown
    dots, print_sigma_mm = target.points(), covariance.print_sigma_mm
    if isinstance(shown, DotPlaces):
        dots, print_sigma_mm = shown.points(), _sigma_of(shown)
    require_cameras(rig, detections.cameras)
    entering, few = in_full_pictures(usable_dots(detections, target))
    skipped = (*unmeasured_pictures(detections), *few)
    if len(entering) == 0:
        raise InputError("No picture shows enough dots to check a rig by: " + "; ".join(skipped[:3]) + ".")
    names, cameras = entering.views, tuple(rig.camera(name) for name in rig.cameras)
    _require_sizes(rig, entering)
    observations = observations_of(entering, target, tuple(rig.cameras), names)
    T_world_target = np.stack([first_pose(rig, entering, view, target) for view in names])
    state = RigState(cameras, T_world_target, dots)
    distance = float(np.median(np.linalg.norm(T_world_target[:, :3, 3], axis=1)))
    imaged = np.isfinite(state.residuals(observations)).all(axis=1)
    views = NewViews(observations.where(imaged), 0.0)
    settled = views.settled(state)
    if settled is None:
        raise InputError(
            "The dots are no pictures of the target through these cameras. Check that `target` names the "
            "board in the pictures, and that they are of the rig's cameras."
        )
    eccentricity = predicted_eccentricities(settled, views.observations, 0.5 * target.outer_diameters_mm())
    scatter = 0.0 if rig.calibration is None else (rig.calibration.scatter_px or 0.0)
    seen = views.observations.moved(-eccentricity).scattered(scatter**2)
    return Prepared(
        Calibrated(settled, covariance.matrix, distance),
        NewViews(seen, print_sigma_mm),
        names,
        tuple(np.unique(seen.camera).tolist()),
        int((~imaged).sum()),
        skipped,
        tuple(rig.cameras),
        len(names),
        view_factor=covariance.view_factor,
        clusters=max(1, len(names) - 1 + max(0, len(rig.calibrated_on) - 1)),
        with_outliers=seen,
    )


def cleaned(made: Prepared, anything: Change) -> tuple[Prepared, Explanation]:
    """Return views without outliers, with the noise that they have, and what explains them best.

    Raises
    ------
    InputError
        No rig explains the dots.

    Notes
    -----
    Noise that is larger than stated (blur, motion, another print) is found from the residuals that are left
    where every camera may have changed; the variances of all dots are then as much larger.
    """
    found = explained(made.calibrated, anything, made.views)
    if found is not None:
        clean = made.without_outliers(found)
        if clean is not made:
            made, found = clean, explained(made.calibrated, anything, clean.views)
    if found is None:
        raise unexplained()
    excess = found.evidence.cost / max(1, made.freedom - anything.count)
    made = replace(made, views=made.views.noisier(max(_LEAST_NOISE, excess)), excess=excess)
    return _with_dispersion(made, anything, found)


def _with_dispersion(made: Prepared, anything: Change, found: Explanation) -> tuple[Prepared, Explanation]:
    """Return views whose noise allows for what they disagree by, and their explanation by `anything`.

    What a view's dots have in common (a board that bends in the hand, motion) is an error of that view. With
    a few views its size is hardly known: the noise has as many degrees of freedom as there are views of
    calibration and check, less one for each (of clusters in general: Cameron and Miller 2015, section VI).
    """
    again = explained(made.calibrated, anything, made.views)
    found = found if again is None else again
    if len(made.names) < FEWEST_TO_DISPERSE:
        return made, found
    dispersion = _dispersion(made, anything, found)
    if dispersion is None:
        return made, found
    if dispersion.is_beyond_chance or made.view_factor > _DISPERSED:
        factor, freedom = max(1.0, dispersion.ratio, made.view_factor), float(made.clusters)
    else:
        factor, freedom = max(dispersion.factor, made.view_factor), np.inf
    made = replace(made, views=made.views.noisier(factor), noise_freedom=freedom)
    again = explained(made.calibrated, anything, made.views)
    return made, found if again is None else again


def _dispersion(made: Prepared, anything: Change, found: Explanation) -> ViewDispersion | None:
    """Return what views disagree by, the dots where they are most likely on the print; None where unknown."""
    state = replace(made.calibrated.state, dots=found.evidence.dots)
    views = NewViews(made.views.observations, 0.0)
    there = explained(replace(made.calibrated, state=state), anything, views)
    if there is None:
        return None
    scores = view_scores(there.evidence.state, views.observations, Lenses.FREE)
    return ViewDispersion.of_scores(there.covariance, scores, 1.0)


def unexplained() -> InputError:
    """Return the error for pictures that no rig explains."""
    return InputError(
        "No change of the rig explains what these pictures show. Check that the target or the marks are "
        "those in them, and that they are of the rig's cameras."
    )


def require_cameras(rig: Rig, cameras: Sequence[str]) -> None:
    """Raise where pictures are of cameras that the rig has not.

    Raises
    ------
    InputError
        They are.
    """
    unknown = [name for name in cameras if name not in rig.cameras]
    if unknown:
        raise InputError(
            f"The pictures are of the camera(s) {listed(unknown)}, but the rig has {listed(rig.cameras)}. "
            "Give pictures of the rig's cameras, named as there (`cameras` names those of loose pictures)."
        )


def covariance_of(rig: Rig) -> RigCovariance:
    """Return the covariance of a rig's parameters.

    Raises
    ------
    InputError
        It states none.
    """
    if rig.covariance is None:
        raise InputError(
            "This rig states no covariance of its calibration: no change stands out from its "
            "errors. Calibrate again with this version, with free lenses."
        )
    return rig.covariance


def _sigma_of(places: DotPlaces) -> float:
    """Return the RMS standard deviation of measured places along each direction of the plane, mm."""
    measured = places.covariances()[places.freed()]
    return (
        float(np.sqrt(np.trace(measured[:, :2, :2], axis1=1, axis2=2).mean() / 2.0)) if len(measured) else 0.0
    )


def _require_sizes(rig: Rig, dots: Detections) -> None:
    """Raise where pictures have another size than those of the calibration."""
    for name in dots.cameras:
        size, known = dots.picture_size(name), rig.camera(name).size
        if tuple(size) != tuple(known):
            raise InputError(
                f"The pictures of camera '{name}' are {size[0]} x {size[1]} px, but it was calibrated with "
                f"{known[0]} x {known[1]}. Take pictures of the same size, without cropping or binning."
            )
