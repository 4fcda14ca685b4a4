"""Check that a whole grid lies on one smooth surface of the picture, the last one before ids are given."""

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.lattice.fisheye_plane import fitted_fisheye_plane
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.stage_settings.grid import GridSettings
from labcal.errors import InputError
from labcal.geometry.projective_map import projective_map


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
    nodes = np.array(list(lattice.spots), dtype=np.float64)
    seen = positions[list(lattice.spots.values())]
    scaled = (nodes - nodes.mean(axis=0)) / np.ptp(nodes, axis=0).max()
    try:
        back = projective_map("smoothness", seen, scaled)
    except InputError:  # they do not determine one
        return False
    straight = np.concatenate([seen, np.ones((len(seen), 1))], axis=1) @ back.T
    if (straight[:, 2] * straight[0, 2] <= 0).any():
        return False  # the horizon would run through the board
    return _leaves_no_step(scaled, straight[:, :2] / straight[:, 2:], np.ptp(nodes, axis=0).max(), settings)


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
    nodes = np.array(list(lattice.spots), dtype=np.float64)
    extent = float(np.ptp(nodes, axis=0).max())
    scaled, pixels = (nodes - nodes.mean(axis=0)) / extent, seen[list(lattice.spots.values())]
    plane = fitted_fisheye_plane(scaled, pixels, size)
    if plane is None:
        return False
    off = plane.residuals(scaled, pixels)
    return bool(np.isfinite(off).all()) and _leaves_no_step(scaled, off, extent, settings)


def _leaves_no_step(scaled: np.ndarray, off: np.ndarray, extent: float, settings: GridSettings) -> bool:
    """Tell whether a polynomial of the nodes (n, 2) follows what a map leaves of them (n, 2) everywhere."""
    degrees, spare = range(settings.smooth_max_degree, 1, -1), settings.smooth_dots_factor
    degree = next((d for d in degrees if len(scaled) >= spare * (d + 1) * (d + 2) / 2), 1)
    i, j = np.array([(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]).T
    of_a, of_b = (np.vander(nodes, degree + 1, increasing=True) for nodes in scaled.T)
    design = of_a[:, i] * of_b[:, j]
    left = off - design @ np.linalg.lstsq(design, off, rcond=None)[0]
    return bool(np.linalg.norm(left, axis=1).max() * extent < settings.smooth_residual_steps)
