"""Cameras, targets and points in space, as a still figure and the 3-D view both show them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.geometry.magnification import round_magnification

MOST_POINTS = 4000
"""Of the 3-D view; more are thinned out evenly."""
_VECTOR_SHARE = 0.06
"""Of the extent of all: length of the vector of a typical large error."""
_LARGE = 90.0
"""Percentile of the errors that counts as such."""
_FRUSTUM_SHARE = 0.25
"""Of the distance to the points: depth of a camera's field of view that is drawn."""
_ALONE_MM = 100.0
"""That depth where there are no points."""


@dataclass(frozen=True)
class Direction:
    """A direction to look from.

    Attributes
    ----------
    label : str
    inside : bool
        True if it is a camera's own place, from which not all has to be seen.
    eye, focus, up : float64 array, (3,)
        In the world, mm; `up` of any length.
    """

    label: str
    inside: bool
    eye: Float64[np.ndarray, "3"]
    focus: Float64[np.ndarray, "3"]
    up: Float64[np.ndarray, "3"]


@dataclass(frozen=True, eq=False)
class Space:
    """Cameras, target and points in one world, mm.

    Attributes
    ----------
    cameras : mapping of str to Camera
    outlines : sequence of arrays, (corners, 3)
        Of the target in each view, closed.
    points : float64 array, (n, 3)
    vectors : float64 array, (n, 3)
        The error of each point; no rows where errors are not known.
    labels : sequence of str
        Of each point.
    """

    cameras: Mapping[str, Camera]
    outlines: Sequence[Float64[np.ndarray, "corners 3"]]
    points: Float64[np.ndarray, "n 3"]
    vectors: Float64[np.ndarray, "errors 3"] = field(default_factory=lambda: np.zeros((0, 3)))
    labels: Sequence[str] = ()

    def thinned(self, most: int = MOST_POINTS) -> "Space":
        """Return the space with at most so many points, spread evenly over the table."""
        n = len(self.points)
        if n <= most:
            return self
        kept = np.unique(np.linspace(0, n - 1, most).astype(int))
        vectors = self.vectors[kept] if len(self.vectors) else self.vectors
        labels = [self.labels[i] for i in kept.tolist()] if self.labels else ()
        return Space(self.cameras, self.outlines, self.points[kept], vectors, labels)

    @cached_property
    def magnification(self) -> float:
        """By how much error vectors are drawn longer than they are: 1, 2, 5, 10 ..."""
        if len(self.vectors) == 0:
            return 1.0
        large = float(np.percentile(np.linalg.norm(self.vectors, axis=1), _LARGE))
        low, high = self.bounds
        return round_magnification(_VECTOR_SHARE * float((high - low).max()) / max(large, 1e-9))

    @cached_property
    def error_mm(self) -> Float64[np.ndarray, " n"]:
        """Length of each error, mm; none where errors are not known."""
        return np.asarray(np.linalg.norm(self.vectors, axis=1))

    @cached_property
    def tips(self) -> Vectors3:
        """The ends of the error vectors, magnified, mm."""
        return np.asarray(self.points + self.magnification * self.vectors)

    @cached_property
    def frusta(self) -> dict[str, list[np.ndarray]]:
        """Lines (corners, 3) that show the field of view of each camera, mm, by its name."""
        focus = self._middle
        found = {}
        for name, camera in self.cameras.items():
            away = float(np.linalg.norm(focus - camera.centre))
            deep = _FRUSTUM_SHARE * away if away > 0.0 and len(self._solid) else _ALONE_MM
            found[name] = _frustum(camera, deep)
        return found

    @cached_property
    def bounds(self) -> tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]]:
        """Least and greatest coordinates of all that is drawn, mm."""
        centres = [camera.centre for camera in self.cameras.values()]
        lines = [corner for line in self.frusta.values() for part in line for corner in part]
        drawn = np.array([*centres, *lines, *self._solid]).reshape(-1, 3)
        drawn = drawn[np.isfinite(drawn).all(axis=1)]
        if len(drawn) == 0:
            return np.full(3, -_ALONE_MM), np.full(3, _ALONE_MM)
        low, high = drawn.min(axis=0), drawn.max(axis=0)
        least = 0.05 * float((high - low).max()) + 1e-6
        return low - least, high + least

    @cached_property
    def directions(self) -> list[Direction]:
        """Directions to look from: an overview, along the three axes of the rig, and from each camera."""
        right, up, forward = self._axes
        low, high = self.bounds
        focus, away = 0.5 * (low + high), 1.45 * float((high - low).max())
        views = {
            "Overview": (0.75 * right + 0.55 * up - forward, up),
            "Front": (-forward, up),
            "Top": (up, forward),
            "Side": (right, up),
        }
        found = [
            Direction(label, inside=False, eye=focus + away * _unit(towards, up), focus=focus, up=upward)
            for label, (towards, upward) in views.items()
        ]
        for name, camera in self.cameras.items():
            axis = camera.T_cam_world[2, :3]
            ahead = max(float((self._middle - camera.centre) @ axis), 0.1 * away)
            eye = camera.centre
            up = -camera.T_cam_world[1, :3]
            found.append(Direction(f"Camera {name}", inside=True, eye=eye, focus=eye + ahead * axis, up=up))
        return found

    @property
    def _solid(self) -> Vectors3:
        """Points and outlines, mm."""
        return np.concatenate([self.points, *self.outlines]).reshape(-1, 3)

    @cached_property
    def _middle(self) -> Float64[np.ndarray, "3"]:
        """The middle of points and outlines, or of the world."""
        solid = self._solid
        solid = solid[np.isfinite(solid).all(axis=1)]
        return np.asarray(np.median(solid, axis=0)) if len(solid) else np.zeros(3)

    @cached_property
    def _axes(self) -> Float64[np.ndarray, "3 3"]:
        """The directions that are right, up and forward for the cameras together; else those of a stage."""
        axes = [camera.T_cam_world[:3, :3] for camera in self.cameras.values()]
        right, down, forward = (
            np.mean(axes, axis=0) if axes else np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
        )
        forward = _unit(forward, np.array([0.0, 0.0, 1.0]))
        up = -_unit(down - (down @ forward) * forward, np.cross(forward, right))
        return np.array([np.cross(forward, up), up, forward])


def _unit(v: np.ndarray, instead: np.ndarray) -> np.ndarray:
    """Return a vector of length 1; another one in place of none."""
    length = float(np.linalg.norm(v))
    return v / length if length > 1e-9 else _unit(instead, np.array([0.0, 1.0, 0.0]))  # noqa: PLR2004 -- of units


def _frustum(camera: Camera, deep: float) -> list[np.ndarray]:
    """Return lines (corners, 3) from a camera's centre to its picture's corners, and around these, mm."""
    right, bottom = camera.size[0] - 0.5, camera.size[1] - 0.5
    q = [[-0.5, -0.5], [right, -0.5], [right, bottom], [-0.5, bottom]]
    rays = camera.rays(q)
    corners = rays.origin + deep * rays.direction
    spokes = [np.array([start, corner]) for start, corner in zip(rays.origin, corners, strict=True)]
    lines = [*spokes, np.concatenate([corners, corners[:1]])]
    return [line for line in lines if np.isfinite(line).all()]
