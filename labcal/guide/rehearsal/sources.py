"""Sizes of what makes errors: the noise of dots and of points, and the print."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.cameras.derivatives import point_derivatives
from labcal.geometry.poses import transform
from labcal.guide.rehearsal.dot_noise import DotNoise, facing_sizes
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rig_plan import RigPlan


@dataclass(frozen=True)
class PointNoise:
    """The noise of the points to be measured: stated, or that of dots of some size that face the cameras.

    Attributes
    ----------
    dots : DotNoise
    radius_mm : float
    sigma_px : float or None
        Standard deviation of each coordinate, where it is stated.
    """

    dots: DotNoise
    radius_mm: float
    sigma_px: float | None

    @classmethod
    def of(cls, plan: RigPlan, dots: DotNoise) -> "PointNoise":
        """Return the noise of points of a plan: as it states, or as of its target's dots."""
        return cls(dots, 0.5 * plan.target.dot_diameter_mm, plan.point_sigma_px)

    def times(self, factor: float) -> "PointNoise":
        """Return noise with a standard deviation that is so many times as large."""
        sigma = None if self.sigma_px is None else factor * self.sigma_px
        return PointNoise(self.dots.times(factor), self.radius_mm, sigma)

    def covariances(self, planned: PlannedRig, p: Vectors3) -> Float64[np.ndarray, "n cameras 2 2"]:
        """Return covariances of the pixels of points, px squared; `p` in the frame of the first camera."""
        if self.sigma_px is not None:
            return np.tile(self.sigma_px**2 * np.eye(2), (len(p), len(planned.cameras), 1, 1))
        found = []
        for camera in planned.cameras:
            by_point = point_derivatives(camera, transform(camera.T_cam_world, p)).by_point
            found.append(self.dots.covariances(facing_sizes(by_point, self.radius_mm)))
        return np.stack(found, axis=1)


@dataclass(frozen=True)
class Sources:
    """Sizes of what makes errors.

    Attributes
    ----------
    dots : DotNoise
        Of the target's dots in the views that calibrate.
    points : PointNoise
        Of the points that are measured then.
    print_sigma_mm : float
    lens_share : float
        Factor of the standard deviations of all lens parameters, 1 as the views determine them.
    """

    dots: DotNoise
    points: PointNoise
    print_sigma_mm: float
    lens_share: float = 1.0

    @classmethod
    def of(cls, plan: RigPlan, dots: DotNoise) -> "Sources":
        """Return the sources of a plan, whose dots have some noise."""
        return cls(dots, PointNoise.of(plan, dots), plan.print_sigma_mm)
