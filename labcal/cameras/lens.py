"""What a lens model is, and the models by name.

A lens maps a direction in the camera frame to the ideal image plane at unit focal length and back. Its
formulas are written on separate x and y with plain operators.
"""

from typing import Protocol, runtime_checkable

import numpy as np

from labcal.cameras.brown import Brown
from labcal.cameras.mathematics import Mathematics, Number
from labcal.errors import UnknownNameError


@runtime_checkable  # so that tests can check annotations
class Lens(Protocol):
    """A central lens model with numeric coefficients.

    Every method takes the coefficients as `numbers`, because the renderer passes its own kind of number.
    """

    @property
    def name(self) -> str:
        """The name in files and on the command line."""

    @property
    def coefficients(self) -> int:
        """How many coefficients are free."""

    def numbers(self, dist: np.ndarray) -> tuple[float, ...]:
        """Return what the formulas take, from OpenCV's coefficient vector."""

    def image(
        self, m: Mathematics, numbers: tuple[Number, ...], X: Number, Y: Number, Z: Number
    ) -> tuple[Number, Number, Number]:
        """Return ``x, y, ok`` of the direction (X, Y, Z), at unit focal length."""

    def direction(
        self, m: Mathematics, numbers: tuple[Number, ...], x: Number, y: Number
    ) -> tuple[Number, Number, Number, Number]:
        """Return ``X, Y, Z, ok`` of the direction, of unit length, that is imaged at (x, y)."""

    def image_jacobian(
        self, numbers: tuple[float, ...], X: np.ndarray, Y: np.ndarray, Z: np.ndarray
    ) -> np.ndarray:
        """Return d(x, y) / d(X, Y, Z), shape (..., 2, 3)."""

    def coefficient_jacobian(self, X: np.ndarray, Y: np.ndarray, Z: np.ndarray) -> np.ndarray:
        """Return d(x, y) / d(free coefficients, in OpenCV's order), shape (..., 2, coefficients)."""


LENSES: dict[str, Lens] = {
    lens.name: lens for lens in (Brown("pinhole", 0), Brown("brown-k1k2", 2), Brown("brown5", 5))
}


def lens_by_name(name: str) -> Lens:
    """Return the lens model of that name.

    Raises
    ------
    UnknownNameError
        There is none; the nearest name is offered.
    """
    if name not in LENSES:
        raise UnknownNameError("lens model", name, LENSES)
    return LENSES[name]
