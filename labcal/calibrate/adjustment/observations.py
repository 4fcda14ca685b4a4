"""Observations of a bundle adjustment: measured dots as arrays of numbers."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from jaxtyping import Float64, Int64

from labcal.cameras.derivatives import RUN
from labcal.correspond.detections import Detections
from labcal.geometry.covariances import positive_definite
from labcal.optim.whitening import Whitener
from labcal.targets.target import Target

UNKNOWN_PX = 1e-3
"""Deviation of dots whose covariance is not known; what they scatter beyond it is estimated."""


@dataclass(frozen=True)
class Picture:
    """The observations of one picture."""

    camera: int
    view: int
    rows: slice


@dataclass(frozen=True)
class Run:
    """Pictures of one camera that are computed together."""

    pictures: tuple[Picture, ...]

    @property
    def camera(self) -> int:
        """Index of the camera."""
        return self.pictures[0].camera

    @property
    def rows(self) -> slice:
        """The observations of all of them."""
        return slice(self.pictures[0].rows.start, self.pictures[-1].rows.stop)

    @cached_property
    def views(self) -> Int64[np.ndarray, " pictures"]:
        """Of its pictures."""
        return np.array([picture.view for picture in self.pictures], dtype=np.int64)

    @cached_property
    def counts(self) -> Int64[np.ndarray, " pictures"]:
        """Number of rows of each picture."""
        return np.array([p.rows.stop - p.rows.start for p in self.pictures], dtype=np.int64)

    def within(self) -> Iterator[tuple[Picture, slice]]:
        """Return every picture and its rows, counted from the first of the run."""
        first = self.rows.start
        for picture in self.pictures:
            yield picture, slice(picture.rows.start - first, picture.rows.stop - first)


@dataclass(frozen=True)
class Observations:
    """n measured dots, sorted by camera and view, each by its numbers in the adjustment."""

    camera: Int64[np.ndarray, " n"]
    view: Int64[np.ndarray, " n"]
    dot: Int64[np.ndarray, " n"]
    """In the order of the target's indices, row by row."""
    q: Float64[np.ndarray, "n 2"]
    """Pixels of the centres of dots, px."""
    covariance: Float64[np.ndarray, "n 2 2"]
    """Of `q`, px squared; positive definite."""

    def __len__(self) -> int:
        return len(self.camera)

    @cached_property
    def whitener(self) -> Whitener:
        """The whitener of residuals in px."""
        return Whitener.of(self.covariance)

    @cached_property
    def pictures(self) -> tuple[Picture, ...]:
        """The rows of every picture."""
        changes = np.flatnonzero((np.diff(self.camera) != 0) | (np.diff(self.view) != 0)) + 1
        edges = [0, *changes.tolist(), len(self)] if len(self) else []
        return tuple(
            Picture(int(self.camera[first]), int(self.view[first]), slice(first, end))
            for first, end in pairwise(edges)
        )

    @cached_property
    def runs(self) -> tuple[Run, ...]:
        """All pictures, in runs of up to some :data:`RUN` rows."""
        runs: list[list[Picture]] = []
        for picture in self.pictures:
            fits = runs and runs[-1][0].camera == picture.camera
            if fits and picture.rows.stop - runs[-1][0].rows.start <= RUN:
                runs[-1].append(picture)
            else:
                runs.append([picture])
        return tuple(Run(tuple(pictures)) for pictures in runs)

    def of_camera(self, camera: int) -> slice:
        """Return the rows of a camera."""
        first, end = np.searchsorted(self.camera, [camera, camera + 1])
        return slice(int(first), int(end))

    def where(self, mask: np.ndarray) -> "Observations":
        """Return the rows where the mask holds."""
        return Observations(
            self.camera[mask], self.view[mask], self.dot[mask], self.q[mask], self.covariance[mask]
        )

    def moved(self, shift: Float64[np.ndarray, "n 2"]) -> "Observations":
        """Return the same dots with pixels shifted."""
        return replace(self, q=self.q + shift)

    def scattered(self, extra: float) -> "Observations":
        """Return the same dots with a variance (px squared) added to their own."""
        return replace(self, covariance=self.covariance + extra * np.eye(2))


def observations_of(
    dots: Detections, target: Target, cameras: tuple[str, ...], views: tuple[str, ...]
) -> Observations:
    """Return usable detections as numbers.

    Parameters
    ----------
    dots : Detections
        All of them enter; where a covariance is not known, it becomes :data:`UNKNOWN_PX` squared.
    target : Target
        Has all of the dots.
    cameras, views : tuple of str
        The names that become 0, 1, 2 ...; all names in `dots` are among them.
    """
    camera_numbers = {name: number for number, name in enumerate(cameras)}
    view_numbers = {name: number for number, name in enumerate(views)}
    camera = np.array([camera_numbers[name] for name in dots.camera.tolist()], dtype=np.int64)
    view = np.array([view_numbers[name] for name in dots.view.tolist()], dtype=np.int64)
    dot = dots.index[:, 1] * target.cols + dots.index[:, 0]
    known = positive_definite(dots.covariance)
    covariance = np.where(known[:, None, None], dots.covariance, UNKNOWN_PX**2 * np.eye(2))
    order = np.lexsort((dot, view, camera))
    return Observations(camera[order], view[order], dot[order], dots.position[order], covariance[order])
