"""The prior of lens coefficients (:mod:`labcal.calibrate.lens_prior`) as a part of an adjustment."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.blocks import Blocks, Slopes
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.state import Layout, Lenses, RigState
from labcal.calibrate.lens_prior import PriorWidth, coefficient_weights
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import projection_derivatives
from labcal.cameras.optics import INTRINSICS


@dataclass(frozen=True)
class LensPrior:
    """Inverse variances of the coefficients about no distortion, by camera; none where lenses are fixed."""

    weight: tuple[Float64[np.ndarray, " coefficients"], ...] = ()

    @classmethod
    def of(
        cls, state: RigState, observations: Observations, lenses: Lenses, width: PriorWidth
    ) -> "LensPrior":
        """Return the prior of the lenses of a state, for the dots that they image."""
        if lenses is Lenses.FIXED:
            return cls()
        effect = [np.zeros(camera.model.coefficients) for camera in state.cameras]
        for run in observations.runs:
            _, p = state.seen_by(observations, run)
            by_camera = projection_derivatives(state.cameras[run.camera], p.T).by_camera
            here = np.abs(by_camera[:, :, INTRINSICS:]).max(axis=(0, 1))
            effect[run.camera] = np.maximum(effect[run.camera], here)
        pairs = zip(state.cameras, effect, strict=True)
        return cls(tuple(coefficient_weights(camera, largest, width) for camera, largest in pairs))

    def cost(self, state: RigState) -> float:
        """Return the cost of the coefficients of a state by the prior."""
        pairs = zip(self.weight, state.cameras, strict=False)
        return float(sum(weight @ _distortion(camera) ** 2 for weight, camera in pairs))

    def added(self, blocks: Blocks, layout: Layout) -> Blocks:
        """Return normal equations with the share of the prior."""
        if not self.weight:
            return blocks
        shared, gradient = blocks.shared.copy(), blocks.gradient.shared.copy()
        for number, weight in enumerate(self.weight):
            at = np.arange(layout.lens[number].start + INTRINSICS, layout.lens[number].stop)
            shared[at, at] += weight
            gradient[at] += weight * _distortion(layout.state.cameras[number])
        return Blocks(shared, blocks.cross, blocks.view, Slopes(gradient, blocks.gradient.view))


def _distortion(camera: Camera) -> Float64[np.ndarray, " coefficients"]:
    """Return the difference of coefficients from those of the lens without distortion."""
    return np.asarray(camera.dist[: camera.model.coefficients] - np.array(camera.model.undistorted))


NO_PRIOR = LensPrior()
