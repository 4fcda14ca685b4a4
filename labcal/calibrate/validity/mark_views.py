"""New pictures of marks that stay where they are, as evidence about a rig in its room."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.blocks import assemble
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.calibrate.validity.change import Change, changes_in_room
from labcal.calibrate.validity.evidence import Evidence
from labcal.calibrate.validity.room import out_of_room, rig_columns
from labcal.cameras.camera import Camera
from labcal.optim.robust import SQUARES


@dataclass(frozen=True)
class MarkViews:
    """Pixels of fixed marks in new pictures.

    Attributes
    ----------
    observations : Observations
        Pixels with their covariances; cameras count from the room, which is the first, dots are marks.
    """

    observations: Observations

    def noisier(self, factor: float) -> "MarkViews":
        """Return the same marks with so many times the variance."""
        seen = replace(self.observations, covariance=factor * self.observations.covariance)
        return MarkViews(seen)

    def freedom(self, state: RigState) -> Freedom:
        """Return what the calibration and the places of the marks leave open: lenses, poses and marks."""
        return Freedom(Lenses.FREE, np.eye(state.dots.size))

    def changes(self, cameras: tuple[int, ...]) -> tuple[Change, ...]:
        """Return the kinds of changes that are looked for."""
        return changes_in_room(cameras)

    def rig_cameras(self, state: RigState) -> tuple[Camera, ...]:
        """Return the rig's cameras, the first one as the world."""
        return out_of_room(state.cameras)

    def rig_columns(self, state: RigState) -> Float64[np.ndarray, "rig shared"]:
        """Return the derivatives of the rig's parameters by all, those of marks included."""
        of_rig = rig_columns(state)
        return np.concatenate([of_rig, np.zeros((len(of_rig), state.dots.size))], axis=1)

    def evidence(self, state: RigState) -> Evidence | None:
        """Return the evidence at a state; None if its cameras image not all marks.

        The places of the marks are parameters, whose errors and those of the rig have one covariance: a rig
        that measured the marks is wrong about them as it is about itself.
        """
        residuals = state.residuals(self.observations)
        if not np.isfinite(residuals).all():
            return None
        blocks = assemble(Layout(state, self.freedom(state)), self.observations, SQUARES)
        cost = float((self.observations.whitener.whiten(residuals.T) ** 2).sum())
        information, gradient = blocks.shared, blocks.gradient.shared
        if not (np.isfinite(cost) and np.isfinite(information).all() and np.isfinite(gradient).all()):
            return None
        return Evidence(state, cost, gradient, 0.5 * (information + information.T), state.dots)
