"""One simulated calibration of a planned rig, and the errors of points that are measured with it."""

from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.arrays import Pose, Vectors3
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.dot_image import dot_images
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.geometry.poses import rigid_alignment, transform
from labcal.guide.rehearsal.catalogue import load_rig_plan
from labcal.guide.rehearsal.confirmation import squares
from labcal.guide.rehearsal.dot_noise import DotNoise, minor_semi_axes
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.sources import PointNoise
from labcal.rng import generator

DRAWS = 10
"""Times that every point is measured with one calibration."""


@dataclass(frozen=True)
class RehearsalSet:
    """A case: name of the plan, the noise of its dots, their treatment by the calibration, and a seed."""

    plan: str
    noise: DotNoise
    dot_places: DotTreatment
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.plan}-{self.seed}"


class RehearsalErrors(BaseModel):
    """Errors of one set."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    square_mm2: tuple[float, ...]
    """Mean square of the 3-D error of each point that all cameras see, in the frame of the first camera."""
    shape_mm2: tuple[float, ...]
    """The same after a rigid alignment of all points."""


def measured_rehearsal(case: RehearsalSet) -> RehearsalErrors:
    """Simulate the planned views with noise and an uneven print, calibrate, and measure points."""
    planned = PlannedRig.of(load_rig_plan(case.plan))
    plan = planned.plan
    random = generator(case.seed, "bench solve", "rehearsal", case.plan)
    views = planned.views(plan.shoot.views, 0)
    dots = plan.target.points()
    dots[:, :2] += plan.print_sigma_mm * random.standard_normal((len(dots), 2))
    detections = simulated_dots(planned, views, dots, case.noise, random)
    lens = planned.cameras[0].lens
    settings = HandheldSettings(dot_places=case.dot_places)
    rig = calibrate_handheld(detections, plan.target, lens, settings).rig
    p = transform(planned.T_first_plan, planned.grid[planned.seen(planned.grid)])
    pixels = PointNoise.of(plan, case.noise).covariances(planned, p)
    clean = np.stack([camera.project(p).q for camera in planned.cameras], axis=1)
    cameras = [rig.camera(name) for name in rig.cameras]
    square, shape = np.zeros(len(p)), np.zeros(len(p))
    for _ in range(DRAWS):
        q = clean + np.sqrt(pixels[..., 0, 0])[..., None] * random.standard_normal(clean.shape)
        found = triangulate(cameras, q, pixels).point
        square += squares(found - p) / DRAWS
        shape += squares(transform(rigid_alignment(p, found), found) - p) / DRAWS
    return RehearsalErrors(square_mm2=tuple(square.tolist()), shape_mm2=tuple(shape.tolist()))


def simulated_dots(
    planned: PlannedRig, views: list[Pose], dots: Vectors3, noise: DotNoise, random: np.random.Generator
) -> Detections:
    """Return centroids of dots as the detector would measure them, with the noise of their size.

    Parameters
    ----------
    planned : PlannedRig
    views : list of ndarray, shape (4, 4)
        ``T_first_target``, mm.
    dots : ndarray, shape (n, 3)
        True places on the print, mm.
    noise : DotNoise
    random : Generator
    """
    target = planned.plan.target
    radii, index = 0.5 * target.outer_diameters_mm(), target.indices()
    view_of, camera_of, size_of, index_of, q, covariance = [], [], [], [], [], []
    for name, camera in zip(planned.rig.cameras, planned.cameras, strict=True):
        for number, T in enumerate(views):
            images = dot_images(camera, T, dots, radii)
            whole = images.ok & camera.in_picture(images.outline).all(axis=-1)
            variance = noise.at(minor_semi_axes(images.outline[whole]))
            count = int(whole.sum())
            view_of += [f"view-{number:02d}"] * count
            camera_of += [name] * count
            size_of += [camera.size] * count
            index_of.append(index[whole])
            q.append(images.centroid[whole] + np.sqrt(variance)[:, None] * random.standard_normal((count, 2)))
            covariance.append(variance[:, None, None] * np.eye(2))
    count = len(view_of)
    return Detections(
        view=np.array(view_of),
        camera=np.array(camera_of),
        image=np.full(count, "none.png"),
        size=np.array(size_of),
        index=np.concatenate(index_of),
        has_id=np.ones(count, dtype=bool),
        position=np.concatenate(q),
        covariance=np.concatenate(covariance),
        flag=np.full(count, "ok"),
    )
