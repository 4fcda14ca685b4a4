"""The calibration from the views so far, and the error over the volume that it leaves."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pose, Vectors3
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.guide.next_pose.findable import Findable, images
from labcal.guide.next_pose.volume import MeasuredVolume
from labcal.targets.catalogue import AnyTarget

_POWER = -1.5
"""Of a dot's variance by its size, between that of the bound (-1) and what small dots show (-3)."""
_OPEN = 0.2
"""Relative standard deviation of a focal length from which on a calibration does not guide."""


@dataclass(frozen=True)
class DotVariance:
    """The variance of a coordinate of a dot by the size of its image, px squared.

    Attributes
    ----------
    size_px : float
        Usual minor semi-axis.
    variance : float
        Of dots of that size, as the detector states it.
    extra : float
        What residuals show beyond it.
    """

    size_px: float
    variance: float
    extra: float

    def __call__(self, size_px: Float64[np.ndarray, "*n"]) -> Float64[np.ndarray, "*n"]:
        """Return the variance of dots of these sizes."""
        return np.asarray(self.variance * (size_px / self.size_px) ** _POWER + self.extra)

    @property
    def usual(self) -> float:
        """The variance of a dot of usual size."""
        return self.variance + self.extra


@dataclass(frozen=True)
class Standing:
    """A calibration on the way.

    Attributes
    ----------
    calibration : HandheldCalibration
    cameras : tuple of Camera
        The first one is the world.
    covariance : float64 array, (parameters, parameters)
        Of the rig, with the share of the print.
    centre : float64 array, (3,)
        Where the middle of the target was in the first view, mm.
    volume : MeasuredVolume
    variance : DotVariance
    distance_share : float
        Relative standard deviation of distances: the largest of a focal length.
    """

    calibration: HandheldCalibration
    cameras: tuple[Camera, ...]
    covariance: Float64[np.ndarray, "parameters parameters"]
    centre: Vectors3
    volume: MeasuredVolume
    variance: DotVariance
    distance_share: float

    @classmethod
    def of(
        cls,
        dots: Detections,
        target: AnyTarget,
        lens: str,
        sides_mm: tuple[float, ...] | None,
        before: "Standing | None",
    ) -> "Standing | None":
        """Calibrate; None where the views do not suffice yet.

        Parameters
        ----------
        dots : Detections
        target : AnyTarget
        lens : str
        sides_mm : tuple of three floats, or None
            Of the volume.
        before : Standing or None
            From the views but the last one, to start from.
        """
        settings = HandheldSettings(
            start=None if before is None else before.calibration.rig, dot_places=DotTreatment.DECLARED
        )
        try:
            found = calibrate_handheld(dots, target, lens, settings)
        except InputError:
            if before is None:
                return None
            try:
                found = calibrate_handheld(dots, target, lens, replace(settings, start=None))
            except InputError:
                return None
        covariance = found.rig.covariance
        cameras = tuple(found.rig.camera(name) for name in found.rig.cameras)
        if covariance is None or not np.isfinite(covariance.matrix).all():
            return None
        of_focal = [
            fit.sigma.intrinsics[0] / camera.K[0, 0]
            for fit, camera in zip(found.fits.values(), cameras, strict=True)
        ]
        if not max(of_focal) <= _OPEN:
            return None
        findable = Findable.of(target)
        centre = transform(found.T_world_target[0], findable.middle[None])[0]
        volume = MeasuredVolume.of(cameras, centre, sides_mm)
        variance = _variance(found, dots, findable, cameras)
        return cls(found, cameras, covariance.matrix, centre, volume, variance, max(of_focal))

    @property
    def names(self) -> tuple[str, ...]:
        """Of the cameras."""
        return tuple(self.calibration.rig.cameras)

    @property
    def calibration_mm(self) -> float:
        """The share of the calibration in the RMS error over the volume."""
        return float(np.sqrt(max(0.0, np.trace(self.volume.square_by_parameters @ self.covariance))))

    @property
    def noise_mm(self) -> float:
        """The share of the noise of the points' own pixels."""
        return self.volume.noise_mm(self.variance.usual)

    @property
    def reached_mm(self) -> float:
        """Expected RMS 3-D error over the volume."""
        return float(np.hypot(self.calibration_mm, self.noise_mm))

    @property
    def shape_mm(self) -> float:
        """The same after a rigid alignment of the points: the error of their shape and size."""
        square = self.volume.shape_by_parameters
        return float(np.hypot(np.sqrt(max(0.0, np.trace(square @ self.covariance))), self.noise_mm))

    @property
    def poses(self) -> Mapping[str, Pose]:
        """Pose of the target by view, ``T_world_target``, mm."""
        return dict(zip(self.calibration.views, self.calibration.T_world_target, strict=True))


def _variance(
    found: HandheldCalibration, dots: Detections, target: Findable, cameras: tuple[Camera, ...]
) -> DotVariance:
    """Return the variance of dots: the median of those stated, at the usual size, and the scatter beyond."""
    stated = np.trace(dots.covariance[dots.has_id], axis1=1, axis2=2)
    sizes = [images(one, found.T_world_target, target.dots, target.radius_mm)[1].minor_px for one in cameras]
    seen = np.concatenate([size[size > 0.0] for size in sizes])
    scatter = 0.0 if found.rig.calibration is None else found.rig.calibration.scatter_px or 0.0
    return DotVariance(float(np.median(seen)), float(np.nanmedian(stated)) / 2.0, scatter**2)
