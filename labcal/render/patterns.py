"""Patterns of surfaces on float32 arrays of Dr.Jit; positions in mm."""

from collections.abc import Callable

import drjit as dr

from labcal.render.variant import Jit

Pattern = Callable[[Jit, Jit], Jit]
"""From a place on a surface, in mm, to the factor on its reflectance there."""

GROUT_MM = 5.0
PLANK_MM = 150.0
JOINT_MM = 1.2
SKIRTING_MM = 90.0


def tiles(tile_mm: float) -> Pattern:
    """Return square tiles, alternately darker and slightly different, with joints between them."""

    def factor(x: Jit, y: Jit) -> Jit:
        col, row = dr.floor(x / tile_mm), dr.floor(y / tile_mm)
        other = dr.abs(col + row - 2.0 * dr.floor(0.5 * (col + row)))  # 0 and 1 in turns
        shade = (1.0 - 0.2 * other) * (0.95 + 0.1 * _scatter(col + 57.0 * row))
        across, along = x - col * tile_mm, y - row * tile_mm
        return dr.select(dr.minimum(across, along) < GROUT_MM, 0.6, shade)

    return factor


def planks(x: Jit, y: Jit) -> Jit:
    """Return wooden boards along x, each with its own shade and grain, with dark joints."""
    plank = dr.floor(y / PLANK_MM)
    own = _scatter(plank)
    bent = y + 9.0 * dr.sin(x / (130.0 + 90.0 * own) + 40.0 * own)  # a grain is never straight
    grain = dr.sin(0.55 * bent + 3.0 * dr.sin(0.021 * bent)) + 0.5 * dr.sin(2.1 * bent + 0.01 * x)
    factor = 0.9 + 0.2 * own + 0.05 * grain
    return dr.select(y - plank * PLANK_MM < JOINT_MM, 0.45, factor)


def plaster(x: Jit, y: Jit) -> Jit:
    """Return a painted wall that begins at y = 0 with a light skirting board."""
    cloud = dr.sin(x / 310.0 + 1.3 * dr.sin(y / 270.0)) * dr.sin(y / 230.0 + dr.sin(x / 410.0))
    skirting = dr.select(y > SKIRTING_MM - 4.0, 0.75, 1.45)
    return dr.select(y < SKIRTING_MM, skirting, 1.0 + 0.03 * cloud)


def _scatter(n: Jit) -> Jit:
    """Return a number from 0 to 1 for each integer, different for neighbours (golden ratio)."""
    product = 0.6180339887 * n
    return product - dr.floor(product)
