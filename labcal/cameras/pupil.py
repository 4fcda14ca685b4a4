"""Rays of an open lens: not only the chief ray of a pixel, but all that pass the aperture."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from labcal.cameras.field import SceneRay
from labcal.cameras.mathematics import NUMPY, Mathematics, Number
from labcal.cameras.prescribed import PrescribedLens
from labcal.cameras.spherical import SURFACE, AxialRay, through
from labcal.errors import InputError

_RADII = 9
_GRID = 61
_WIDEST = 3.0
"""Search for the pupil's rim, in units of its paraxial radius."""
_SPARE = 1.03
"""The disc that rays are aimed at is larger than what the search found by this factor."""


@dataclass(frozen=True)
class PupilRay:
    """A ray through the aperture, and its share of the light, 1 on the axis of a lens that blocks nothing."""

    ray: SceneRay
    weight: Number


@runtime_checkable  # so that tests can check annotations
class Pupil(Protocol):
    """An aperture; disc samples are points of the unit disc."""

    @property
    def parameters(self) -> tuple[float, ...]:
        """All its parameters."""

    def ray(
        self, m: Mathematics, parameters: tuple[Number, ...], chief: SceneRay, at: tuple[Number, ...]
    ) -> PupilRay:
        """Return the ray of a chief ray's pixel; `at` is its ideal x and y, then the disc sample's."""


@dataclass(frozen=True)
class ThinPupil:
    """The aperture of an ideal thin lens at the camera's origin, focused at a distance along the axis."""

    radius_mm: float
    focus_mm: float

    @property
    def parameters(self) -> tuple[float, ...]:
        """Radius and focus."""
        return (self.radius_mm, self.focus_mm)

    def ray(
        self, m: Mathematics, parameters: tuple[Number, ...], chief: SceneRay, at: tuple[Number, ...]
    ) -> PupilRay:
        """Return the ray from a point of the disc to where the chief ray is in focus."""
        radius, focus = parameters
        X, Y, Z = chief.direction
        front = Z > 0.0
        along = focus / m.where(front, Z, 1.0)
        x, y = radius * at[2], radius * at[3]
        dx, dy, dz = along * X - x, along * Y - y, along * Z
        length = m.sqrt(dx * dx + dy * dy + dz * dz)
        direction = (dx / length, dy / length, dz / length)
        return PupilRay(SceneRay((x, y, 0.0 * x), direction, chief.ok & front), 1.0 + 0.0 * x)


@dataclass(frozen=True)
class ParallelPupil:
    """The aperture of a lens with parallel chief rays: the same cone of light around each of them."""

    radius_mm: float
    """Of the cone on the plane at depth 0."""
    focus_mm: float

    @property
    def parameters(self) -> tuple[float, ...]:
        """Radius and focus."""
        return (self.radius_mm, self.focus_mm)

    def ray(
        self, m: Mathematics, parameters: tuple[Number, ...], chief: SceneRay, at: tuple[Number, ...]
    ) -> PupilRay:
        """Return the ray from a point of the disc around the chief ray to where that is in focus."""
        radius, focus = parameters
        dx, dy = -radius * at[2], -radius * at[3]
        length = m.sqrt(dx * dx + dy * dy + focus * focus)
        X, Y, Z = chief.origin
        direction = (dx / length, dy / length, focus / length)
        return PupilRay(SceneRay((X - dx, Y - dy, Z), direction, chief.ok), 1.0 + 0.0 * dx)


class TracedPupil:
    """The aperture of a prescription: rays start on the film and are traced out surface by surface.

    Parameters
    ----------
    lens : PrescribedLens
    diameter_mm : float
        Diameter of the entrance pupil.
    reach : float
        Largest radius of the picture, at unit focal length.

    Raises
    ------
    InputError
        The stop does not open so far.
    """

    def __init__(self, lens: PrescribedLens, diameter_mm: float, reach: float) -> None:
        near_axis, described = lens.paraxial, lens.prescription
        stop_radius = 0.5 * diameter_mm * near_axis.pupil_slope
        widest = described.surfaces[described.stop].diameter_mm / near_axis.pupil_slope
        if diameter_mm > widest * (1.0 + 1e-9):
            raise InputError(
                f"The lens '{described.name}' opens to {widest:.3g} mm, not to {diameter_mm:g} mm. "
                "Lessen aperture.diameter_mm."
            )
        surfaces = list(described.towards_scene(len(described.surfaces) - 1))
        surfaces[0] = near_axis.film_mm
        at_stop = SURFACE * (len(described.surfaces) - 1 - described.stop)
        surfaces[at_stop + SURFACE - 1] = stop_radius**2
        to_pupil, magnification = lens.exit_pupil
        self._surfaces = tuple(surfaces)
        self._head = (near_axis.focal_mm, near_axis.entrance_pupil_mm, near_axis.film_mm - to_pupil)
        self._reach = reach
        self._search(stop_radius * magnification)

    @property
    def parameters(self) -> tuple[float, ...]:
        """Focal length, front vertex, film to exit pupil, disc radius, weight; then the surfaces."""
        return (*self._head, self._disc, self._weight, *self._surfaces)

    def ray(
        self, m: Mathematics, parameters: tuple[Number, ...], _chief: SceneRay, at: tuple[Number, ...]
    ) -> PupilRay:
        """Return the ray from the film through a point of the disc; without weight where it is blocked."""
        focal, front, to_pupil, disc, weight = parameters[:5]
        x, y = -at[0] * focal, -at[1] * focal
        dx, dy = disc * at[2] - x, disc * at[3] - y
        ds = 1.0 / m.sqrt(dx * dx + dy * dy + to_pupil * to_pupil)
        zero = 0.0 * ds
        start = AxialRay((x, y), zero, (dx * ds, dy * ds), to_pupil * ds)
        passage = through(m, parameters[5:], start)
        passes = passage.ray.ds > 0.0
        for spare in passage.spare:
            passes = passes & (spare >= 0.0)
        cosine2 = start.ds * start.ds
        ray = passage.ray
        scene = SceneRay((*ray.across, front + ray.s), (*ray.slant, ray.ds), passes)
        return PupilRay(scene, m.where(passes, weight * cosine2 * cosine2, 0.0))

    def relative_light(self, radius: np.ndarray) -> np.ndarray:
        """Return the light at image radii (unit focal length) over that on the axis."""
        grid = (np.arange(_GRID) + 0.5) / _GRID * 2.0 - 1.0
        px, py = (g.ravel() for g in np.meshgrid(grid, grid))
        inside = px * px + py * py <= 1.0
        light = [
            self._passing(np.full(inside.sum(), r), (px[inside], py[inside])).mean() for r in radius.ravel()
        ]
        return np.reshape(light, radius.shape)

    def _passing(self, x: np.ndarray, disc: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """Return the weight of rays from film points on the x axis."""
        zero = np.zeros_like(x)
        chief = SceneRay((zero, zero, zero), (zero, zero, zero + 1.0), zero == 0.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(self.ray(NUMPY, self.parameters, chief, (x, zero, *disc)).weight)

    def _search(self, paraxial_radius: float) -> None:
        """Find the disc that holds the pupil as seen from everywhere on the film, and scale the weight."""
        self._disc, self._weight = _WIDEST * paraxial_radius, 1.0
        grid = np.linspace(-1.0, 1.0, 4 * _GRID)
        px, py = (g.ravel() for g in np.meshgrid(grid, grid))
        rim = 0.0
        for r in np.linspace(0.0, self._reach, _RADII):
            passes = self._passing(np.full(px.shape, r), (px, py)) > 0.0
            rim = max(rim, float(np.hypot(px, py)[passes].max(initial=0.0)))
        if rim == 0.0:
            raise InputError("No light passes the lens prescription: its stop or a surface is closed.")
        self._disc *= min(1.0, _SPARE * rim)
        self._weight = 1.0 / float(self.relative_light(np.zeros(1))[0])
