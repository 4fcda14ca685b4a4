"""One guided capture of a planned rig by drawn pictures, and random views of the same rig.

Somebody with the errors of a hand follows the advice; the detector measures drawn pictures, and a calibration
follows each view. The error that is stated at the end is compared with that of points over the volume.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict

from labcal.arrays import Pose, Vectors3
from labcal.cameras.triangulation import triangulate
from labcal.capture.guide_settings import GuideSettings
from labcal.capture.source import CameraInfo
from labcal.correspond.detections import Detections
from labcal.correspond.gathering import gather
from labcal.correspond.sources import Source
from labcal.detect.detector import detect_dots
from labcal.geometry.poses import rigid_alignment, transform
from labcal.guide.next_pose.candidates import HandReach, drawn_poses
from labcal.guide.next_pose.findable import Findable
from labcal.guide.next_pose.guided_capture import GuidedCapture
from labcal.guide.next_pose.hand import HandError
from labcal.guide.next_pose.information import view_information
from labcal.guide.next_pose.simulated_hand import SimulatedHand
from labcal.guide.next_pose.standing import DotVariance, Standing
from labcal.guide.next_pose.volume import MeasuredVolume
from labcal.guide.rehearsal.catalogue import load_rig_plan
from labcal.guide.rehearsal.confirmation import squares
from labcal.guide.rehearsal.dot_noise import DotNoise
from labcal.guide.rehearsal.drawn_view import drawn_view
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.render.sensor_response import Shot
from labcal.report.values import Measured
from labcal.rng import generator

RANDOM_VIEWS = 20
"""The error that so many random views reach, in the median, is asked for."""
MOST_RANDOM, MOST_GUIDED = 60, 40
_DRAWS = 10


@dataclass(frozen=True)
class GuidedSet:
    """A case: name of a plan, the noise of its dots, the calibration's error to reach (mm), and a seed."""

    plan: str
    noise: DotNoise
    wanted_mm: float
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.plan}-{self.seed}"


class GuidedFigures(BaseModel):
    """Figures of one capture."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    views: int
    """Views until the capture stated that the error is reached."""
    reached: bool
    random_views: int
    """Random views until their calibration has the error that was asked for."""
    asked: int
    """Poses that were asked for, by camera."""
    found: int
    """Of these, pictures that were indexed."""
    stated_mm: Measured
    """RMS 3-D error that is stated at the end."""
    actual_mm: Measured
    """RMS 3-D error of points over the volume in the frame of the first camera."""
    stated_shape_mm: Measured
    actual_shape_mm: Measured
    """The same after a rigid alignment."""
    expected_mm: Measured
    """Error of the calibration's share by the true rig's derivatives, for the views that were taken."""
    stated_calibration_mm: Measured


def random_errors(planned: PlannedRig, noise: DotNoise, seed: int) -> Float64[np.ndarray, " views"]:
    """Return the RMS error over the volume, mm, by the calibration from the first n random views, n from 1.

    Views are drawn as the advisor draws its candidates, anywhere in the pictures and tilted every way, and
    those are taken at which all cameras find the target; NaN where they do not determine the rig.
    """
    random = generator(seed, "bench solve", "guided", "random views")
    target = Findable.of(planned.plan.target)
    taken, reach = np.zeros((0, 4, 4)), HandReach(_centre(planned), 4)
    while len(taken) < MOST_RANDOM:
        drawn = drawn_poses(planned.cameras, reach, target.middle, 200, random)
        found = np.all([target.seen(camera, drawn)[0] for camera in planned.cameras], axis=0)
        taken = np.concatenate([taken, drawn[found]])
    return expected_errors(planned, noise, taken[:MOST_RANDOM])


def expected_errors(
    planned: PlannedRig, noise: DotNoise, T_first_target: Float64[np.ndarray, "n 4 4"]
) -> Float64[np.ndarray, " n"]:
    """Return the RMS error over the volume by the calibration from the first 1, 2, ... n views, mm."""
    cameras, target = planned.cameras, Findable.of(planned.plan.target)
    square = _volume(planned).square_by_parameters
    parts = [target.seen(camera, T_first_target) for camera in cameras]
    seen = np.array([dots & found[:, None] for found, dots in parts])
    variance = DotVariance(noise.size_px, noise.variance, 0.0)
    total = np.cumsum(view_information(cameras, T_first_target, target, seen, variance), axis=0)
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(total, axis1=1, axis2=2), 1e-300))
    scaled = total * scale[:, :, None] * scale[:, None, :]
    errors = np.full(len(total), np.nan)
    for number, (one, by) in enumerate(zip(scaled, scale, strict=True)):
        if np.linalg.eigvalsh(one)[0] > 1e-11:  # noqa: PLR2004 -- rounding
            errors[number] = np.sqrt(np.trace(square @ (np.linalg.inv(one) * np.outer(by, by))))
    return errors


def measured_guided(case: GuidedSet) -> GuidedFigures:
    """Capture with advice until the error is reached, and measure points over the volume."""
    planned = PlannedRig.of(load_rig_plan(case.plan))
    plan, names = planned.plan, tuple(planned.rig.cameras)
    cameras = dict(zip(names, planned.cameras, strict=True))
    v = plan.volume
    settings = GuideSettings(
        volume_mm=(v.width_mm, v.height_mm, v.far_mm - v.near_mm), lens=planned.cameras[0].lens
    )
    guide = GuidedCapture(plan.target, settings, case.seed)
    guide.begin(tuple(CameraInfo(name, "drawn", one.size) for name, one in cameras.items()))
    hand = SimulatedHand(cameras, plan.target, _centre(planned), HandError(), case.seed)
    taken, asked, found = list[Pose](), 0, 0
    while len(taken) < MOST_GUIDED:
        advice = guide.advise()
        if advice.calibration_mm is not None and advice.calibration_mm <= case.wanted_mm:
            break
        T = hand.pose_for(advice)
        dots, indexed = _drawn(planned, T, f"view-{len(taken):02d}", case.seed)
        if advice.views:
            asked += len(advice.outlines)
            found += sum(indexed[name] for name in advice.outlines)
        taken.append(T)
        guide.enter(dots, f"view-{len(taken) - 1:02d}")
    end = guide.standing
    random_mm = random_errors(planned, case.noise, case.seed)
    with np.errstate(invalid="ignore"):
        enough = np.flatnonzero(random_mm <= case.wanted_mm)
    return GuidedFigures(
        views=len(taken),
        reached=len(taken) < MOST_GUIDED,
        random_views=int(enough[0]) + 1 if len(enough) else MOST_RANDOM,
        asked=asked,
        found=found,
        expected_mm=float(expected_errors(planned, case.noise, np.array(taken))[-1]),
        stated_calibration_mm=float("nan") if end is None else end.calibration_mm,
        **_errors(planned, end, case),
    )


def _errors(planned: PlannedRig, end: Standing | None, case: GuidedSet) -> dict[str, float]:
    names = ("stated_mm", "actual_mm", "stated_shape_mm", "actual_shape_mm")
    if end is None:
        return dict.fromkeys(names, float("nan"))
    random = generator(case.seed, "bench solve", "guided", case.plan)
    p = _volume(planned).points
    clean = np.stack([camera.project(p).q for camera in planned.cameras], axis=1)
    variance = float(case.noise.at(np.array([end.variance.size_px]))[0])  # the true one, not the stated
    pixels = np.tile(variance * np.eye(2), (len(p), len(planned.cameras), 1, 1))
    square, shape = 0.0, 0.0
    for _ in range(_DRAWS):
        q = clean + np.sqrt(variance) * random.standard_normal(clean.shape)
        found = triangulate(list(end.cameras), q, pixels).point
        square += float(squares(found - p).mean()) / _DRAWS
        shape += float(squares(transform(rigid_alignment(p, found), found) - p).mean()) / _DRAWS
    stated = replace(end, volume=MeasuredVolume(end.cameras, p))
    figures = (stated.reached_mm, np.sqrt(square), stated.shape_mm, np.sqrt(shape))
    return dict(zip(names, map(float, figures), strict=True))


def _drawn(planned: PlannedRig, T: Pose, view: str, seed: int) -> tuple[Detections, dict[str, bool]]:
    """Return what the detector measures in drawn pictures of a pose, and in which it gives ids."""
    sources, found, indexed = [], [], {}
    target = planned.plan.target
    for name, camera in zip(planned.rig.cameras, planned.cameras, strict=True):
        picture = drawn_view(camera, T, target, planned.plan.photometry, Shot(seed, view, name))
        dots = detect_dots(picture.picture, target)
        indexed[name] = dots.indexed
        found.append(
            replace(
                dots, size=camera.size, position=dots.position + picture.corner,
                seen_at=dots.seen_at + picture.corner,
            )
        )  # fmt: skip
        sources.append(Source(view, name, f"{view}_{name}.png", camera.size))
    return gather(sources, found), indexed


def _centre(planned: PlannedRig) -> Vectors3:
    v = planned.plan.volume
    middle = np.array([[*v.centre_mm, 0.5 * (v.near_mm + v.far_mm)]])
    return np.asarray(transform(planned.T_first_plan, middle)[0])


def _volume(planned: PlannedRig) -> MeasuredVolume:
    return MeasuredVolume(planned.cameras, transform(planned.T_first_plan, planned.grid)).seen()
