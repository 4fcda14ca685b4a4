"""The result of a calibration: rig, standard deviations and residuals."""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.calibrate.adjustment.rounds import Adjusted
from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.agreement.finding import Disagreement
from labcal.calibrate.budget.error_sources import ErrorSources
from labcal.calibrate.camera_covariance import CameraCovariance
from labcal.calibrate.dot_treatment import DotDecision
from labcal.calibrate.eccentricity import CorrectedEccentricity
from labcal.calibrate.freed_dots import FreedDots
from labcal.calibrate.lens_misfit import LensMisfit
from labcal.calibrate.one_lens import TwoLenses
from labcal.calibrate.outlying_dots import OutlyingDots
from labcal.calibrate.rig_residuals import RigResiduals
from labcal.cameras.camera_pair import CameraPair
from labcal.cameras.expected_errors import ExpectedErrors, expected_errors
from labcal.cameras.optics import INTRINSICS
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.geometry.poses import transform
from labcal.optim.stopping import StopReason
from labcal.targets.board_set import BoardSet

UNEVEN, UNEVEN_PX = 5.0, 0.1
"""Scatter from which on it is worth a word: so many times the dots' own noise, and so many px."""


@dataclass(frozen=True)
class CameraSigma:
    """Standard deviations of the parameters of a camera in the rig; NaN if the views do not determine one."""

    intrinsics: Float64[np.ndarray, "4"]
    """fx fy cx cy, px; 0 where fixed."""
    dist: Float64[np.ndarray, " coefficients"]
    rotation_rad: Float64[np.ndarray, "3"]
    """About the camera's axes; 0 for the first camera, which is the world."""
    translation_mm: Float64[np.ndarray, "3"]

    @classmethod
    def of(cls, adjusted: Adjusted, covariance: CameraCovariance, number: int) -> "CameraSigma":
        """Return those of one camera of an adjustment, by its number."""
        sigma = np.sqrt(np.diagonal(covariance.covariance))
        lens = np.zeros(INTRINSICS + adjusted.state.cameras[number].model.coefficients)
        place = np.zeros(POSE)
        own, pose = adjusted.layout.lens[number], adjusted.layout.pose[number]
        lens[: own.stop - own.start] = sigma[own]
        place[: pose.stop - pose.start] = sigma[pose]
        return cls(lens[:INTRINSICS], lens[INTRINSICS:], place[:3], place[3:])


@dataclass(frozen=True)
class CameraFit:
    """The residuals of one camera."""

    rms_px: float
    """Calibrated alone; OpenCV's: root mean square of the 2-D distance, without outliers."""
    rms_in_rig_px: float
    """The same in the rig."""
    views: tuple[str, ...]
    dots: int
    sigma: CameraSigma
    scatter_px: float
    """Calibrated alone: what dots scatter, along each axis, beyond their covariances."""
    freed: FreedDots | None
    """The dots as this camera alone finds them."""
    undetermined: tuple[str, ...]
    """Names of lens coefficients that its views leave open."""
    open_lens: bool
    """True if the dots do not determine the lens towards the border of the picture; the prior does."""
    noise_px: float
    """Of the dots, along each axis, by their covariances; the median."""
    two_lenses: TwoLenses | None = None
    """Groups of its views that were taken through different lenses; None where one lens explains all."""
    misfit: LensMisfit | None = None
    """A larger lens model that its views ask for; None where the lens suits."""

    @property
    def uneven(self) -> bool:
        """True if dots scatter far more than their noise: the print or the lens differs from the model."""
        return self.scatter_px > max(UNEVEN_PX, UNEVEN * self.noise_px)


@dataclass(frozen=True)
class HandheldCalibration:
    """A rig whose world is the first camera, and the poses of the target."""

    rig: Rig
    fits: dict[str, CameraFit]
    """By camera."""
    rms_px: float
    """Over all cameras, in the rig."""
    skipped: tuple[str, ...]
    """Pictures that did not enter, each with its reason, for people."""
    outliers: OutlyingDots
    """Dots that did not."""
    views: tuple[str, ...]
    T_world_target: Float64[np.ndarray, "views 4 4"]
    """Of every view, mm."""
    eccentricity: CorrectedEccentricity
    freed: FreedDots | None
    """The dots as all cameras together find them."""
    reason: StopReason
    residuals: RigResiduals
    """Of all dots that entered, in the rig."""
    covariance: CameraCovariance
    """Of all cameras together."""
    sources: ErrorSources
    """Sources of the errors that the covariance holds."""
    dots: Float64[np.ndarray, "dots 3"]
    """Places of the dots on the print, in the target's frame, mm: as declared, as given, or as estimated."""
    dot_decision: DotDecision
    """The treatment of the dots on the print, and the reason."""
    measured_print: bool = False
    """True if the dots were kept where an earlier calibration had found them."""
    disagreement: Disagreement | None = None
    """The disagreement of the cameras on the poses of the target; None if they agree."""
    boards: BoardSet | None = None
    """The boards where they were found on their plate; None of one board."""

    @property
    def rms_alone_px(self) -> float:
        """OpenCV's RMS over all cameras, each calibrated alone."""
        fits = self.fits.values()
        return float(np.sqrt(sum(f.dots * f.rms_px**2 for f in fits) / sum(f.dots for f in fits)))

    @property
    def places(self) -> Vectors3:
        """Places of all dots of the target in all views, in the world, (n, 3), mm."""
        return np.concatenate([transform(T, self.dots) for T in self.T_world_target])

    def scatter_px(self, name: str) -> float:
        """Return what dots of a camera scatter beyond their covariances, in the rig if known; px per axis."""
        record = self.rig.calibration
        return (
            self.fits[name].scatter_px if record is None or record.scatter_px is None else record.scatter_px
        )

    @property
    def pixel_sigma_px(self) -> list[float]:
        """Standard deviation of a typical dot along each axis by camera: its own noise, and the scatter."""
        return [float(np.hypot(fit.noise_px, self.scatter_px(name))) for name, fit in self.fits.items()]

    def expected_errors(self) -> ExpectedErrors:
        """Return the errors to expect of points where the target was, of dots like these, mm."""
        known = None if self.rig.covariance is None else self.rig.covariance.matrix
        cameras = [self.rig.camera(name) for name in self.rig.cameras]
        found = expected_errors(cameras, known, self.places, self.pixel_sigma_px)
        share = self.sources.print_share
        if known is None or share is None:
            return found
        by_print = expected_errors(cameras, share.covariance, self.places, self.pixel_sigma_px)
        return replace(
            found,
            depth=replace(found.depth, print_mm=by_print.depth.calibration_mm),
            sideways=replace(found.sideways, print_mm=by_print.sideways.calibration_mm),
        )

    def pairs(self) -> tuple[CameraPair, ...]:
        """Return baseline and angle of every two cameras, with their standard deviations."""
        return tuple(self.rig.pair(*names) for names in combinations(self.rig.cameras, 2))

    def entering(self, detections: Detections) -> Detections:
        """Return the detections of the pictures and dots that entered."""
        seen = {(view, name) for name, fit in self.fits.items() for view in fit.views}
        pictures = zip(detections.view.tolist(), detections.camera.tolist(), strict=True)
        entered = np.array([picture in seen for picture in pictures], dtype=bool)
        return self.outliers.left_out(detections.where(entered))
