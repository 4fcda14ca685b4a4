"""The surface of a print: a plane, or a paraboloid with a twist."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Vectors3
from labcal.scene.board import Bend, Board
from labcal.scene.solids import Met, Starts
from labcal.targets.printed_sheet import cut_sheet
from labcal.targets.target import PrintableTarget

FACET_ERROR_MM = 5e-4
"""Largest deviation of the facets of a mesh from the surface."""


@dataclass(frozen=True)
class Surface:
    """A board's surface in the target's frame, as a height over each (x, y) of the board, mm."""

    middle: np.ndarray
    """(2,), the board's middle."""
    half: np.ndarray
    """(2,), its half width and half height."""
    bend: Bend

    @classmethod
    def of(cls, target: PrintableTarget, bend: Bend) -> "Surface":
        """Return the surface of a target's board."""
        x_min, y_min, x_max, y_max = target.extent_mm
        return cls(
            middle=np.array([0.5 * (x_min + x_max), 0.5 * (y_min + y_max)]),
            half=np.array([0.5 * (x_max - x_min), 0.5 * (y_max - y_min)]),
            bend=bend,
        )

    @classmethod
    def of_board(cls, target: PrintableTarget, board: Board) -> "Surface":
        """Return the surface of the board of a scene: of a numbered print, the whole sheet as it is cut."""
        if board.print_number is None:
            return cls.of(target, board.bend)
        cut = cut_sheet(target, board.print_number)
        return cls(
            middle=np.array([0.5 * (cut.x_min + cut.x_max), 0.5 * (cut.y_min + cut.y_max)]),
            half=0.5 * np.array([cut.width, cut.height]),
            bend=board.bend,
        )

    @property
    def form(self) -> np.ndarray:
        """The symmetric matrix Q (2, 2) of the height ``w Q w`` at w from the middle, 1/mm."""
        (a, b), bend = self.half, self.bend
        mixed = 0.5 * bend.twist_mm / (a * b)
        return np.array([[bend.along_x_mm / a**2, mixed], [mixed, bend.along_y_mm / b**2]])

    def points(self, xy: np.ndarray) -> Vectors3:
        """Return the points of the surface at positions on the board, shape (..., 2) to (..., 3)."""
        w = xy - self.middle
        height = ((w @ self.form) * w).sum(axis=-1)
        return np.concatenate([xy, height[..., None]], axis=-1)

    def normals(self, xy: np.ndarray) -> Vectors3:
        """Return unit normals at positions, on the side of the viewer, shape (..., 2) to (..., 3)."""
        slope = 2.0 * (xy - self.middle) @ self.form
        normal = np.concatenate([-slope, np.ones((*slope.shape[:-1], 1))], axis=-1)
        return np.asarray(normal / np.linalg.norm(normal, axis=-1, keepdims=True))

    def lowest_mm(self) -> float:
        """Return the lowest height of the board: in its middle, on an edge or at a corner."""
        a, b, twist = self.bend.along_x_mm, self.bend.along_y_mm, self.bend.twist_mm
        heights = [0.0, a + b - abs(twist)]
        for along, across in ((a, b), (b, a)):
            if along > 0.0 and abs(twist) <= 2.0 * along:  # an edge with a lowest point between its corners
                heights.append(across - twist**2 / (4.0 * along))
        return min(heights)

    def cells(self) -> int:
        """Return the numbers of cells along x and y for which two facets per cell are accurate enough.

        A facet's largest distance from a paraboloid is that along its sides: with n cells the rises of the
        bend are at most 1 / n^2 of their sum away.
        """
        bend = self.bend
        rise = abs(bend.along_x_mm) + abs(bend.along_y_mm) + abs(bend.twist_mm)
        return max(1, int(np.ceil(np.sqrt(rise / FACET_ERROR_MM))))

    def hides(self, start: Starts, xy: np.ndarray) -> Met:
        """Return a mask of points that the board itself hides, or whose back faces the viewer.

        Parameters
        ----------
        start : ndarray, shape (..., 3)
            Where the paths begin, in the target's frame, mm.
        xy : ndarray, shape (..., 2)
            Places on the board where they end.

        Notes
        -----
        Along a path the height over the surface is a quadratic with one root at its end; the other root is
        where it goes through the board.
        """
        end = self.points(xy)
        w, way = xy - self.middle, start - end
        bending = ((way[..., :2] @ self.form) * way[..., :2]).sum(axis=-1)
        rising = way[..., 2] - 2.0 * ((w @ self.form) * way[..., :2]).sum(axis=-1)
        with np.errstate(divide="ignore", invalid="ignore"):
            other = rising / bending  # height over the surface: s (rising - s bending), s from 0 to 1
        inside = (other > 0.0) & (other < 1.0)
        crossing = w + np.where(inside, other, 0.0)[..., None] * way[..., :2]
        on_board = (np.abs(crossing) <= self.half).all(axis=-1)
        return np.asarray((rising <= 0.0) | (inside & on_board))
