"""The dots of all views of a rehearsal: their places, and the errors foretold of them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, PointCovariances, Vectors3
from labcal.cameras.dot_image import dot_images
from labcal.cameras.rig import Rig
from labcal.geometry.poses import transform
from labcal.geometry.rigid_part import without_rigid_part
from labcal.guide.rehearsal.dot_noise import DotNoise, minor_semi_axes
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.reconstruct.point_budget import Budget, PointBudget


@dataclass(frozen=True)
class HeldPoints:
    """The dots of the recommended views, then those of the test views, view by view.

    Attributes
    ----------
    tested : bool array, (n,)
        Mask of the dots of test views.
    p : float64 array, (n, 3)
        In the frame of the first camera, mm.
    pixels : float64 array, (n, cameras, 2, 2)
        Foretold covariances of their pixels, px squared.
    variance : dict
        Foretold variances of all dots of a picture, by view and camera, px squared.
    cols : int
        Of the target.
    """

    tested: Mask
    p: Vectors3
    pixels: Float64[np.ndarray, "n cameras 2 2"]
    variance: dict[tuple[str, str], np.ndarray]
    cols: int

    @classmethod
    def of(cls, found: Rehearsal, noise: DotNoise) -> "HeldPoints":
        """Return the points of a rehearsal, whose dots have this noise."""
        planned, target = PlannedRig.of(found.plan), found.plan.target
        radii = 0.5 * target.outer_diameters_mm()
        variance: dict[tuple[str, str], np.ndarray] = {}
        points, pixels = [], []
        for number, T in enumerate([*found.views, *found.test_views], start=1):
            covariances = []
            for name, camera in zip(planned.rig.cameras, planned.cameras, strict=True):
                size = minor_semi_axes(dot_images(camera, T, target.points(), radii).outline)
                variance[f"pose-{number:02d}", name] = noise.at(size)
                covariances.append(noise.covariances(size))
            points.append(transform(T, target.points()))
            pixels.append(np.stack(covariances, axis=1))
        tested = np.arange(len(points) * target.count) >= len(found.views) * target.count
        return cls(tested, np.concatenate(points), np.concatenate(pixels), variance, target.cols)

    def budget(self, rig: Rig, chosen: Mask) -> PointBudget:
        """Return the foretold budget of some of the points, by a rig with its expected covariance."""
        return PointBudget.of(rig, self.p[chosen], self.pixels[chosen], Budget.FULL)

    @staticmethod
    def shape_covariances(budget: PointBudget) -> PointCovariances:
        """Return the foretold covariances of single points after a rigid alignment, mm squared."""
        left = without_rigid_part(budget.derivatives(np.arange(len(budget))), budget.point)
        return np.asarray(budget.noise + left @ budget.parameters @ left.transpose(0, 2, 1))
