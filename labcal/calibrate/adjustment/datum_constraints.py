"""Datum constraints on what no picture determines: the freedoms of cameras with parallel rays.

Such a camera sees neither how far away it is nor, without distortion, its principal point, which Brown's
decentring stands in for otherwise. So these are fixed for each. Where the first camera is one, the whole of
the rig may slide along its axis: the shift that this changes most in another camera is fixed, too. A view
that no two directions see is fixed along the one that does. What is fixed has a standard deviation of 0.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from labcal.calibrate.adjustment.blocks import Blocks, Slopes
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.state import POSE, Layout
from labcal.cameras.optics import INTRINSICS

_SAME_AXIS = 1e-6
"""Sine of the angle between two directions from which on they determine depth."""


@dataclass(frozen=True)
class DatumConstraints:
    """Constrained parameters and directions of an adjustment."""

    shared: Bool[np.ndarray, " shared"]
    """True for the shared parameters that are constrained."""
    along: Float64[np.ndarray, "views 3"]
    """By view the direction in the world along which it is fixed; zeros where it is not."""

    @classmethod
    def of(cls, layout: Layout, observations: Observations) -> "DatumConstraints":
        """Return the constraints on what the observations of a state do not determine."""
        cameras = layout.state.cameras
        shared = np.zeros(layout.count, dtype=bool)
        along = np.zeros((len(layout.state.T_world_target), 3))
        parallel = [camera.model.parallel for camera in cameras]
        if not any(parallel):
            return cls(shared, along)
        for number in np.flatnonzero(parallel):
            lens, pose = layout.lens[number], layout.pose[number]
            if lens.stop > lens.start:
                shared[lens.start + 2 : lens.start + INTRINSICS] = True
            if pose.stop > pose.start:
                shared[pose.stop - 1] = True
        if parallel[0]:
            _fix_slide(shared, layout)
        for view in range(len(along)):
            seen = {picture.camera for picture in observations.pictures if picture.view == view}
            axes = [cameras[number].T_cam_world[2, :3] for number in sorted(seen)]
            alike = all(np.linalg.norm(np.cross(axes[0], axis)) < _SAME_AXIS for axis in axes)
            if seen and alike and all(parallel[number] for number in seen):
                along[view] = axes[0]
        return cls(shared, along)

    @property
    def count(self) -> int:
        """Number of constraints."""
        return int(self.shared.sum() + self.along.any(axis=1).sum())

    def applied(self, blocks: Blocks) -> Blocks:
        """Return normal equations whose steps leave alone what is constrained."""
        if self.count == 0:
            return blocks
        free = ~self.shared
        shared = blocks.shared * np.outer(free, free) + np.diag(self.shared.astype(np.float64))
        view = blocks.view.copy()
        weight = np.trace(view[:, 3:, 3:], axis1=1, axis2=2)
        view[:, 3:, 3:] += weight[:, None, None] * self.along[:, :, None] * self.along[:, None, :]
        gradient = Slopes(blocks.gradient.shared * free, blocks.gradient.view)
        return Blocks(shared, blocks.cross * free[:, None], view, gradient)


def _fix_slide(shared: Bool[np.ndarray, " shared"], layout: Layout) -> None:
    """Fix what a slide of all but the first camera along its axis changes most in another camera."""
    axis = layout.state.cameras[0].T_cam_world[2, :3]
    slide = np.zeros(layout.count)
    for camera, pose in zip(layout.state.cameras, layout.pose, strict=True):
        if pose.stop > pose.start:
            slide[pose.start + POSE - 3 : pose.stop] = camera.T_cam_world[:3, :3] @ axis
    slide[shared] = 0.0
    if np.abs(slide).max(initial=0.0) > _SAME_AXIS:
        shared[int(np.argmax(np.abs(slide)))] = True
