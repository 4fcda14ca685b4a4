"""Visibility of every dot in a picture of the suite: position, size and hidden share."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Mask, Pixels, Vectors3
from labcal.cameras.dot_image import outlined_images
from labcal.geometry.poses import transform
from labcal.scene.furniture import obstacles
from labcal.scene.model import Scene
from labcal.scene.print import TruePrint
from labcal.scene.solids import Solid
from labcal.scene.take import Take
from labcal.scene.visibility import SHARES, viewpoints

LEAST_MINOR_PX = 3.0
"""Of a dot that can be measured, the minor semi-axis."""


@dataclass(frozen=True)
class DotVisibility:
    """True values of the dots of one picture; NaN where they cannot be projected."""

    index: np.ndarray
    """(n, 2) integer, (col, row)."""
    centroid: Pixels
    """(n, 2), px."""
    minor_px: np.ndarray
    """(n,), the least distance from the centroid to the outline, px."""
    pitch_px: np.ndarray
    """(n,), the distance to the nearest neighbour, px."""
    hidden: np.ndarray
    """(n,), share of the dot's area that something is in front of."""
    in_frame: Mask
    """(n,), the whole outline is in the picture."""
    measurable: Mask
    """(n,), large enough, in the frame, and nothing so near that its blur reaches the dot's edge."""
    ring: Mask
    """(n,), one of the three rings."""

    @property
    def hidden_share(self) -> float:
        """Share of the dots in the frame of which something hides any part."""
        return float((self.hidden[self.in_frame] > 0.0).mean()) if self.in_frame.any() else 0.0

    @property
    def rings_in_sight(self) -> bool:
        """True if all three rings can be measured."""
        return bool(self.measurable[self.ring].all())


def dot_visibility(scene: Scene, take: Take, clear_px: float) -> DotVisibility:
    """Return the visibility of the dots.

    Parameters
    ----------
    scene : Scene
        With a flat and faultless board.
    take : Take
    clear_px : float
        Distance of a measurable dot from the frame and from any occluder.
    """
    made = TruePrint.of(scene.target, scene.board, 0)
    images = outlined_images(take.project, made.centres, made.outlines)
    away = np.linalg.norm(images.outline - images.centroid[:, None], axis=-1)
    minor = away.min(axis=1)
    T_world_target = take.track.T_world_target
    eyes = viewpoints(take.device, images)
    hidden, near = np.zeros(len(minor)), np.zeros(len(minor), dtype=bool)
    # The scale that the dots have along their minor axes: what is clear by it is clear along the others too.
    margin_mm = clear_px * 0.5 * scene.grid.dot_diameter_mm / np.nanmedian(minor)
    for body in obstacles(scene, T_world_target):
        hidden = np.maximum(hidden, _covered(body, made, T_world_target, eyes))
        near |= _covered(body.grown(margin_mm), made, T_world_target, eyes) > 0.0
    within = (images.outline >= clear_px) & (images.outline <= np.array(take.device.size) - 1 - clear_px)
    in_frame = images.ok & take.device.in_picture(images.outline).all(axis=-1)
    index = scene.target.indices()
    return DotVisibility(
        index=index,
        centroid=images.centroid,
        minor_px=minor,
        pitch_px=_pitches(images.centroid, scene.target.cols),
        hidden=hidden,
        in_frame=in_frame,
        measurable=in_frame & within.all(axis=(1, 2)) & ~near & (minor >= LEAST_MINOR_PX),
        ring=np.array([(col, row) in scene.grid.ring_indices for col, row in index.tolist()]),
    )


def _covered(body: Solid, made: TruePrint, T_world_target: np.ndarray, eyes: Vectors3) -> np.ndarray:
    """Return the share of the area of each dot that a body covers, shape (dots,)."""
    share, total = np.zeros(len(eyes)), 0.0
    for radius in SHARES:
        weight = max(radius, 0.25 * (SHARES[0] - SHARES[1]))  # the ring's area; the centre stands for a disc
        outlines = transform(T_world_target, made.surface.points(made.flat_outlines(radius)))
        share += weight * body.meets(eyes[:, None, :], outlines).mean(axis=-1)
        total += weight
    return share / total


def _pitches(centroid: Pixels, cols: int) -> np.ndarray:
    """Return the distance from every dot to its nearest neighbour in its row or column, px."""
    grid = centroid.reshape(-1, cols, 2)
    nearest = np.full(grid.shape[:2], np.inf)
    for axis in (0, 1):
        step = np.linalg.norm(np.diff(grid, axis=axis), axis=-1)
        before = [slice(None), slice(None)]
        after = [slice(None), slice(None)]
        before[axis], after[axis] = slice(None, -1), slice(1, None)
        for part in (tuple(before), tuple(after)):
            nearest[part] = np.fmin(nearest[part], step)
    return nearest.ravel()
