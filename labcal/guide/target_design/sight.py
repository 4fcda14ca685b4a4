"""Sizes of a target in pictures: pixels a millimetre by distance and tilt."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from labcal.cameras.camera import Camera
from labcal.errors import InputError

_CELLS = 17
_STEP_PX = 0.5
_FIELD = 0.85
"""Share of the picture's width and height within which dots should be large enough."""


@dataclass(frozen=True)
class Sight:
    """A camera's picture in angles.

    Parameters
    ----------
    least_px_per_rad : float
        Least local scale in the picture, in any direction; that of the middle for lenses without distortion.
    axis_px_per_rad : float
        Scale in the middle.
    field_rad : (float, float)
        Angles that the picture shows along its width and height.
    """

    least_px_per_rad: float
    axis_px_per_rad: float
    field_rad: tuple[float, float]

    @classmethod
    def of(cls, camera: Camera) -> "Sight":
        """Return the sight of a camera.

        Raises
        ------
        InputError
            Its rays are parallel, or no pixel has a ray.
        """
        if camera.model.parallel:
            raise InputError(
                f"The lens '{camera.lens}' has parallel rays: its scale does not depend on the distance, and "
                "a target for it cannot be designed from one. Choose the pitch by hand."
            )
        width, height = camera.size
        u, v = np.meshgrid(
            *((0.5 + _FIELD * np.linspace(-0.5, 0.5, _CELLS)) * (side - 1) for side in (width, height))
        )
        q = np.stack([u.ravel(), v.ravel()], axis=-1)
        bend = np.stack(
            [_turn(camera, q, step) for step in (np.array([_STEP_PX, 0]), np.array([0, _STEP_PX]))]
        )
        most = np.linalg.svd(np.moveaxis(bend, 0, -1), compute_uv=False)[:, 0]
        if not np.isfinite(most).any():
            raise InputError("No pixel of a camera has a ray: its description is damaged.")
        middle = most[len(most) // 2] if np.isfinite(most[len(most) // 2]) else np.nanmin(most)
        ends = [
            _angle(camera, np.array([[0.0, 0.5 * (height - 1)], [width - 1.0, 0.5 * (height - 1)]])),
            _angle(camera, np.array([[0.5 * (width - 1), 0.0], [0.5 * (width - 1), height - 1.0]])),
        ]
        scale = float(1.0 / middle)
        field = [
            angle if np.isfinite(angle) else side / scale
            for angle, side in zip(ends, (width, height), strict=True)
        ]
        return cls(float(1.0 / np.nanmax(most)), scale, (field[0], field[1]))

    def width_mm(self, distance_mm: float) -> tuple[float, float]:
        """Return width and height of what the picture shows of a plane at a distance, mm."""
        half = (min(0.5 * angle, 1.2) for angle in self.field_rad)  # at most 69 degrees to either side
        width, height = (2.0 * distance_mm * float(np.tan(one)) for one in half)
        return width, height

    def px_per_mm(self, distance_mm: float, tilt_deg: float) -> float:
        """Return the least scale of a board at a distance, along the direction that the tilt shortens."""
        return self.least_px_per_rad / distance_mm * float(np.cos(np.radians(tilt_deg)))


def least_scale(sights: Iterable[Sight], distance_mm: float, tilt_deg: float) -> float:
    """Return the least scale over cameras, px/mm."""
    return min(sight.px_per_mm(distance_mm, tilt_deg) for sight in sights)


def _turn(camera: Camera, q: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Return the change of the rays' directions a pixel along a step, (n, 3); NaN where there is no ray."""
    after, before = camera.rays(q + step), camera.rays(q - step)
    turn = (after.direction - before.direction) / (2.0 * float(np.linalg.norm(step)))
    return np.where((after.ok & before.ok)[:, None], turn, np.nan)


def _angle(camera: Camera, ends: np.ndarray) -> float:
    """Return the angle between the rays of two pixels, counted over the middle."""
    middle = ends.mean(axis=0)
    rays = camera.rays(np.vstack([ends, middle]))
    if not rays.ok.all():
        return float("nan")
    first, last, axis = rays.direction
    parts = (np.arccos(np.clip(one @ axis, -1.0, 1.0)) for one in (first, last))
    return float(sum(parts))
