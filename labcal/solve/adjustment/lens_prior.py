"""What is known of lens coefficients beforehand: that none of them bends the picture by its own width.

In models with many coefficients some stand in for each other (k1 and k4 of the rational model do at first
order), and steps along such a direction end at a pole of the formula. This holds them, and weighs nothing
beside what dots tell: a dot's noise is a ten-thousandth of a picture's width or less. The coefficients beyond
Brown's five are held tighter: else noise in the training views sets them, and the pole may come to lie
just outside the dots.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.cameras.derivatives import projection_derivatives
from labcal.cameras.optics import INTRINSICS
from labcal.solve.adjustment.blocks import Blocks, Slopes
from labcal.solve.adjustment.observations import Observations
from labcal.solve.adjustment.state import Layout, Lenses, RigState

_SHARE = 1.0
"""One standard deviation of a coefficient's effect on the outermost dot, over the picture's width."""
_SHARE_BEYOND = 0.01
"""The same for those beyond Brown's five, which stand in for these where dots do not tell them apart."""
_BROWN = 5


@dataclass(frozen=True)
class LensPrior:
    """Inverse variances of the coefficients about 0, by camera; none where lenses are fixed."""

    weight: tuple[Float64[np.ndarray, " coefficients"], ...] = ()

    @classmethod
    def of(cls, state: RigState, observations: Observations, lenses: Lenses) -> "LensPrior":
        """Return the prior of the lenses of a state, for the dots that they image."""
        if lenses is Lenses.FIXED:
            return cls()
        effect = [np.zeros(camera.model.coefficients) for camera in state.cameras]
        for run in observations.runs:
            _, p = state.seen_by(observations, run)
            by_camera = projection_derivatives(state.cameras[run.camera], p.T).by_camera
            here = np.abs(by_camera[:, :, INTRINSICS:]).max(axis=(0, 1))
            effect[run.camera] = np.maximum(effect[run.camera], here)
        pairs = zip(effect, state.cameras, strict=True)
        return cls(
            tuple((largest / (_shares(len(largest)) * camera.size[0])) ** 2 for largest, camera in pairs)
        )

    def cost(self, state: RigState) -> float:
        """Return what the coefficients of a state cost."""
        pairs = zip(self.weight, state.cameras, strict=False)
        return float(sum(weight @ camera.dist[: len(weight)] ** 2 for weight, camera in pairs))

    def added(self, blocks: Blocks, layout: Layout) -> Blocks:
        """Return normal equations with the prior's share."""
        if not self.weight:
            return blocks
        shared, gradient = blocks.shared.copy(), blocks.gradient.shared.copy()
        for number, weight in enumerate(self.weight):
            at = np.arange(layout.lens[number].start + INTRINSICS, layout.lens[number].stop)
            shared[at, at] += weight
            gradient[at] += weight * layout.state.cameras[number].dist[: len(weight)]
        return Blocks(shared, blocks.cross, blocks.view, Slopes(gradient, blocks.gradient.view))


def _shares(coefficients: int) -> Float64[np.ndarray, " coefficients"]:
    """Return one standard deviation of each coefficient's effect, as a share of the picture's width."""
    return np.where(np.arange(coefficients) < _BROWN, _SHARE, _SHARE_BEYOND)


NO_PRIOR = LensPrior()
