"""Check that a whole grid lies on one smooth surface of the picture, the last one before ids are given."""

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.lattice.fisheye_plane import fitted_fisheye_plane
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.surface import off_smooth_surface
from labcal.detect.stage_settings.grid import GridSettings
from labcal.errors import InputError
from labcal.geometry.projective_map import projective_map

_PLAINLY = 0.9
"""Of the most that is left of a smooth grid: normal equations are far more exact than this."""


def is_smooth(lattice: Lattice, positions: Pixels, settings: GridSettings) -> bool:
    """Tell whether one map takes the grid's nodes to their spots everywhere.

    A homography takes up the perspective; what is left, lens distortion, is a polynomial of the nodes. A
    grid with a row linked one step off leaves half a step or more.

    Parameters
    ----------
    lattice : Lattice
        At least a cross and its corners.
    positions : ndarray, shape (n, 2)
        Of all spots, px.
    settings : GridSettings
    """
    nodes = lattice.nodes.astype(np.float64)
    seen = positions[lattice.numbers]
    extent = float(np.ptp(nodes, axis=0).max())
    scaled = (nodes - nodes.mean(axis=0)) / extent
    off = off_smooth_surface(scaled, seen, _degree(len(scaled), settings)) * extent
    if off < _PLAINLY * settings.smooth_residual_steps:
        return True
    try:
        back = projective_map("smoothness", seen, scaled)
    except InputError:  # they do not determine one
        return False
    straight = np.concatenate([seen, np.ones((len(seen), 1))], axis=1) @ back.T
    if (straight[:, 2] * straight[0, 2] <= 0).any():
        return False  # the horizon would run through the board
    return _leaves_no_step(scaled, straight[:, :2] / straight[:, 2:], extent, settings)


def is_smooth_through_fisheye(
    lattice: Lattice, seen: Pixels, size: tuple[int, int], settings: GridSettings
) -> bool:
    """Tell whether one map takes the grid's nodes to their spots, as :func:`is_smooth` does, for wide lenses.

    A plane through an equidistant fisheye takes up the perspective. Beyond some 150 degrees no homography
    does, wherever the rough undistortion that the lattice grew in ends.

    Parameters
    ----------
    lattice : Lattice
    seen : ndarray, shape (n, 2)
        Pixels of all spots, in the picture as it is.
    size : tuple of int
        Width and height of the picture, px.
    settings : GridSettings
    """
    nodes = lattice.nodes.astype(np.float64)
    extent = float(np.ptp(nodes, axis=0).max())
    scaled, pixels = (nodes - nodes.mean(axis=0)) / extent, seen[lattice.numbers]
    plane = fitted_fisheye_plane(scaled, pixels, size)
    if plane is None:
        return False
    off = plane.residuals(scaled, pixels)
    return bool(np.isfinite(off).all()) and _leaves_no_step(scaled, off, extent, settings)


def _leaves_no_step(scaled: np.ndarray, off: np.ndarray, extent: float, settings: GridSettings) -> bool:
    """Tell whether a polynomial of the nodes (n, 2) follows what a map leaves of them (n, 2) everywhere."""
    degree = _degree(len(scaled), settings)
    i, j = np.array([(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]).T
    of_a, of_b = (np.vander(nodes, degree + 1, increasing=True) for nodes in scaled.T)
    design = of_a[:, i] * of_b[:, j]
    left = off - design @ np.linalg.lstsq(design, off, rcond=None)[0]
    return bool(np.linalg.norm(left, axis=1).max() * extent < settings.smooth_residual_steps)


def _degree(count: int, settings: GridSettings) -> int:
    """Return the degree of a polynomial that so many dots determine well."""
    degrees, spare = range(settings.smooth_max_degree, 1, -1), settings.smooth_dots_factor
    return next((d for d in degrees if count >= spare * (d + 1) * (d + 2) / 2), 1)
