"""Evidence that the checks of a diagnosis look at, each part computed once, when first asked for."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.arrays import Pose
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_candidates import DEFAULT_LENS
from labcal.calibrate.prepared_cameras import PreparedCameras, prepared_cameras, prepared_dots
from labcal.calibrate.single_calibration import HandheldSettings
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.measure import Measurement
from labcal.errors import InputError
from labcal.guide.diagnosis.forms.explaining import Explained, explained
from labcal.guide.diagnosis.forms.rig_error import with_rig_errors
from labcal.guide.diagnosis.forms.shoot_model import ShootModel
from labcal.guide.diagnosis.labelling import Labelling, labelling
from labcal.guide.diagnosis.shown_target import shown_instead
from labcal.guide.diagnosis.support.remedies import Remedies
from labcal.guide.picture_look import PictureLook, look_at
from labcal.guide.volume_cost import Volume
from labcal.shoot.dataset import Shoot
from labcal.targets.catalogue import AnyTarget


@dataclass(frozen=True)
class Evidence:
    """A shoot, or pictures, or dots alone, and what is computed from them.

    Attributes
    ----------
    target : AnyTarget
        As it is said to be.
    detections : Detections
        Of all pictures.
    shoot : Shoot or None
    measurements : tuple of Measurement
        The detection of each picture, refused ones among them; empty where dots are given without pictures.
    rig : Rig or None
        A calibration of these cameras that is known beforehand.
    """

    target: AnyTarget
    detections: Detections
    shoot: Shoot | None = None
    measurements: tuple[Measurement, ...] = ()
    rig: Rig | None = None

    @property
    def has_pictures(self) -> bool:
        """True if the pictures themselves can be looked at."""
        return bool(self.measurements)

    @property
    def is_usable(self) -> bool:
        """True if at least one dot has an id and is measured."""
        return bool((self.detections.ok & self.detections.has_id).any())

    @property
    def cameras(self) -> tuple[str, ...]:
        """All cameras, in order; those of which no picture shows a dot come last."""
        of_pictures = [one.source.camera for one in self.measurements]
        return tuple(dict.fromkeys([*self.detections.cameras, *of_pictures]))

    @cached_property
    def nominal_poses(self) -> dict[str, Pose]:
        """``T_world_target`` by view as a stage says; empty for a target in the hand."""
        return {} if self.shoot is None else self.shoot.nominal_poses()

    @cached_property
    def _attempt(self) -> HandheldCalibration | InputError:
        try:
            return calibrate_handheld(self.detections, self.target, self.lens)
        except InputError as error:
            return error

    @property
    def lens(self) -> str:
        """The lens model that shoots are judged with."""
        if self.rig is not None:
            lenses = {record.lens for record in self.rig.cameras.values()}
            if len(lenses) == 1:
                return lenses.pop()
        return DEFAULT_LENS

    @property
    def calibration(self) -> HandheldCalibration | None:
        """The calibration from all views; None where it fails."""
        return None if isinstance(self._attempt, InputError) else self._attempt

    @property
    def failure(self) -> InputError | None:
        """The reason that there is no calibration; None where there is one."""
        return self._attempt if isinstance(self._attempt, InputError) else None

    @cached_property
    def _alone(self) -> PreparedCameras | InputError:
        settings = HandheldSettings(dot_places=DotTreatment.DECLARED)
        try:
            dots = prepared_dots(self.detections, self.target, settings)
            return prepared_cameras(dots, self.target, self.lens, settings)
        except InputError as error:
            return error

    @property
    def alone(self) -> PreparedCameras | None:
        """Each camera calibrated alone from all its pictures, dots as declared; None where that fails."""
        return None if isinstance(self._alone, InputError) else self._alone

    @property
    def why_not_alone(self) -> str:
        """The reason that cameras cannot be calibrated alone; empty where they can."""
        return str(self._alone) if isinstance(self._alone, InputError) else ""

    @cached_property
    def labels(self) -> tuple[Labelling, ...]:
        """Wrong labels of pictures and dots of every camera beside the first that it shares views with."""
        if self.alone is None:
            return ()
        others = range(1, len(self.alone.alone))
        found = [labelling(self.alone, camera, self.target) for camera in others]
        return tuple(one for one in found if one is not None)

    @cached_property
    def model(self) -> ShootModel | None:
        """The linear model of the shoot, wrong labels corrected; None where cameras do not share views."""
        prepared = self.alone
        try:
            if self.labels:
                settings = HandheldSettings(dot_places=DotTreatment.DECLARED)
                dots = self.detections
                for one in self.labels:
                    dots = one.corrected(dots, self.target)
                prepared = prepared_cameras(
                    prepared_dots(dots, self.target, settings), self.target, self.lens, settings
                )
            return None if prepared is None else ShootModel.of(prepared)
        except InputError:
            return None

    @cached_property
    def explained(self) -> Explained | None:
        """The mistakes that explain the residuals of the dots best, together; None without a model."""
        if self.model is None:
            return None
        found, calibration = explained(self.model), self.calibration if not self.labels else None
        return found if calibration is None else with_rig_errors(found, self.model, calibration)

    @cached_property
    def volume(self) -> Volume | None:
        """The volume of the target's dots, over which errors are computed; None without a rig of two."""
        found = self.calibration
        if found is None or found.rig.covariance is None:
            return None
        noise = float(np.mean(np.square(found.pixel_sigma_px)))
        return Volume.at(found.rig, found.places, noise * np.eye(2))

    @cached_property
    def shown_instead(self) -> str | None:
        """The shipped target that refused pictures show instead of the named one; None where none fits."""
        return shown_instead(self.measurements, self.target.name)

    @cached_property
    def looks(self) -> tuple[PictureLook | None, ...]:
        """Exposure and sharpness of the picture of every measurement; None where it could not be read."""
        return tuple(
            None if one.dots is None else look_at(one.source.read(), one.dots) for one in self.measurements
        )

    @cached_property
    def remedies(self) -> Remedies | None:
        """Errors to expect after views that the shoot could have had; None without a calibrated pair."""
        found = self.calibration
        return None if found is None or len(self.cameras) < 2 else Remedies.of(found)  # noqa: PLR2004 -- a pair

    @cached_property
    def budget_mm(self) -> float | None:
        """Expected RMS 3-D error over that volume by noise and calibration, as this shoot states it."""
        return None if self.volume is None else self.volume.budget_mm()

    def images(self, views: Sequence[str], cameras: Sequence[str] = ()) -> tuple[str, ...]:
        """Return the paths of pictures of views, in their order; of all cameras where none is named."""
        wanted = cameras or self.cameras
        table = {
            (view, camera): str(image)
            for view, camera, image in zip(
                self.detections.view.tolist(),
                self.detections.camera.tolist(),
                self.detections.image.tolist(),
                strict=True,
            )
        }
        paths = [table[view, camera] for view in views for camera in wanted if (view, camera) in table]
        return tuple(dict.fromkeys(paths))

    @cached_property
    def expected_mm(self) -> float | None:
        """Expected RMS 3-D error of a rig from this shoot, were there no mistake; None of one camera."""
        model, found = self.model, self.explained
        return self.budget_mm if model is None or found is None else model.budget_mm(found.noise)

    def harm_percent_of(self, harm_mm: float) -> float | None:
        """Return the relative increase of the expected error, %, by an error that is added in quadrature."""
        budget = self.expected_mm
        if budget is None or not budget > 0.0:
            return None
        return 100.0 * float(np.hypot(1.0, harm_mm / budget) - 1.0)
