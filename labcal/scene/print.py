"""The true print of a target: one formula for truth and picture."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.cameras.dot_image import flat_outlines
from labcal.errors import InputError
from labcal.rng import generator
from labcal.scene.board import Board
from labcal.scene.surface import Surface
from labcal.targets.grid import DotGrid, Layout
from labcal.targets.registry import kind_of
from labcal.targets.scaled_print import ScaledPrint
from labcal.targets.target import PrintableTarget

WAVES = 8
"""Plane waves that make up the unevenness of the paper."""
WAVELENGTHS = (0.08, 0.6)
"""Shortest and longest of them, as shares of the board's width."""


@dataclass(frozen=True)
class TruePrint:
    """A target as printed.

    What is printed at (x, y) by design, from the board's middle, comes to lie at ``A (x, y)``; each dot is
    then off by its own displacement; and the paper is bent as a whole.
    """

    target: PrintableTarget
    surface: Surface
    A: np.ndarray
    """(2, 2), what the printer makes of lengths."""
    displacement: np.ndarray
    """(dots, 2), how far each dot is off its place on the paper, mm."""
    waves: np.ndarray
    """(WAVES, 3), wave numbers along x and y (rad/mm) and phase of the paper's unevenness; empty for none."""
    amplitude: float
    """Of each wave, as a share of the reflectance."""
    number: int | None = None
    """Of the print, where all of its sheet is rendered; None for the bare target."""

    @classmethod
    def of(cls, target: PrintableTarget, board: Board, seed: int) -> "TruePrint":
        """Return the print for a seed, the same in all views.

        Raises
        ------
        InputError
            A dot would touch its neighbour's place or leave the board, dots are displaced of a target that is
            no grid, or the board lists shifts of another number of dots.
        """
        listed = np.array(board.dot_shifts_mm, dtype=np.float64).reshape(-1, 2)
        if len(listed) not in {0, target.count}:
            raise InputError(
                f"board.dot_shifts_mm lists {len(listed)} dots, but the target '{target.name}' has "
                f"{target.count}. List them all, row by row, or leave it out."
            )
        draws = generator(seed, "misplaced dots").standard_normal((target.count, 2))
        made = cls(
            target=target,
            surface=Surface.of_board(target, board),
            A=np.array([[board.print_scale[0], board.print_shear], [0.0, board.print_scale[1]]]),
            displacement=board.misplacement_mm * draws + (listed if len(listed) else 0.0),
            waves=_waves(target, board, seed),
            amplitude=board.unevenness * float(np.sqrt(2.0 / WAVES)),
            number=board.print_number,
        )
        made._require_room()
        return made

    @property
    def is_displaced(self) -> bool:
        """True if any dot is displaced."""
        return bool((self.displacement != 0.0).any())

    @cached_property
    def centres(self) -> Vectors3:
        """The dots' centres in the target's frame, mm, shape (dots, 3)."""
        return self.surface.points(self._on_paper(self.target.points())[:, 0])

    @cached_property
    def outlines(self) -> Float64[np.ndarray, "dots samples 3"]:
        """The dots' outer outlines in the target's frame, mm, from +x towards +y."""
        return self.surface.points(self.flat_outlines(1.0))

    @cached_property
    def reach_mm(self) -> float:
        """An upper bound of the distance of a point of a dot from its centre."""
        return 1.01 * float(np.linalg.norm(self.outlines - self.centres[:, None, :], axis=-1).max())

    def flat_outlines(self, share: float) -> Float64[np.ndarray, "dots samples 2"]:
        """Return closed curves inside the dots on the flat paper, mm; at a share of 1 their outlines."""
        radii = 0.5 * share * self.target.outer_diameters_mm()
        return self._on_paper(flat_outlines(self.target.points(), radii))

    def dot_offsets(self) -> Float64[np.ndarray, "dots 2"]:
        """Return the displacements of dots, before scale and shear of the print by the board."""
        return np.asarray(self.displacement @ np.linalg.inv(self.A).T)

    @property
    def scale_x_y(self) -> Float64[np.ndarray, "2"]:
        """Scale along x and y that the target itself states of this print; 1 where it states none."""
        return self.target.scale_x_y if isinstance(self.target, ScaledPrint) else np.ones(2)

    def _on_paper(self, p: Vectors3) -> np.ndarray:
        """Return positions on the paper of positions p in the design, one row per dot, (dots, n, 2)."""
        by_dot = p.reshape(self.target.count, -1, 3)[..., :2]
        middle = self.surface.middle
        return np.asarray((by_dot - middle) @ self.A.T + middle + self.displacement[:, None, :])

    def _require_room(self) -> None:
        """Raise unless every dot is inside its cell of the grid and on the board."""
        self._require_apart()
        off = np.abs(self.flat_outlines(1.0) - self.surface.middle) - self.surface.half
        allowed = np.maximum(0.0, np.abs(self._nominal_outlines() - self.surface.middle) - self.surface.half)
        if (off > allowed.max(axis=(0, 1)) + 1e-9).any():
            raise InputError(
                f"The print of the target '{self.target.name}' does not fit on its board any more. Lessen "
                "board.print_scale, print_shear or misplacement_mm, or widen the target's margin_mm."
            )

    def _require_apart(self) -> None:
        """Raise unless every dot is inside its cell of the grid."""
        target = self.target
        if not isinstance(target, DotGrid):
            if self.is_displaced:
                raise InputError(
                    f"Single dots can be misplaced on a grid of dots only, and the target '{target.name}' is "
                    f"of the kind '{kind_of(target).name}'. Leave out board.misplacement_mm "
                    "and board.dot_shifts_mm."
                )
            return
        room = 0.5 * np.array(target.cell_mm)
        offsets = self.dot_offsets()
        if target.layout is Layout.ASYMMETRIC:  # cells stand on their corners
            offsets = offsets @ np.array([[1.0, -1.0], [1.0, 1.0]]) / np.sqrt(2.0)
        reach = np.abs(offsets) + 0.5 * target.outer_diameters_mm()[:, None]
        if (reach >= room).any():
            dot = target.indices()[np.argmax((reach / room).max(axis=1))]
            raise InputError(
                f"With a misplacement of this size the dot ({dot[0]}, {dot[1]}) of the target "
                f"'{target.name}' comes to lie half a pitch off, and dots may touch. Lessen "
                "board.misplacement_mm."
            )

    def _nominal_outlines(self) -> np.ndarray:
        """Return the outlines of the design; without margin, dots may be cut by the edge of the board."""
        return flat_outlines(self.target.points(), 0.5 * self.target.outer_diameters_mm())[..., :2]


def _waves(target: PrintableTarget, board: Board, seed: int) -> np.ndarray:
    """Draw the waves of the unevenness of the paper."""
    if board.unevenness == 0.0:
        return np.zeros((0, 3))
    random = generator(seed, "uneven paper")
    x_min, _, x_max, _ = target.extent_mm
    shortest, longest = (share * (x_max - x_min) for share in WAVELENGTHS)
    length = shortest * (longest / shortest) ** random.uniform(size=WAVES)
    angle, phase = random.uniform(0.0, 2.0 * np.pi, (2, WAVES))
    number = 2.0 * np.pi / length
    return np.stack([number * np.cos(angle), number * np.sin(angle), phase], axis=-1)
