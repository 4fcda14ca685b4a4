"""Maps from the picture to the board around each corner, by the corners next to it."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.node_grid import NodeGrid, around
from labcal.detect.lattice.lattice import Node
from labcal.geometry.projective_map import homogeneous, projective_map

_REACH, _ENOUGH = 2, 4
"""Nodes to either side that tell a map, and the fewest corners that do."""
_TERMS, _KEPT = 10, 6
"""Of a polynomial of third order in two variables, and those of second order."""
_BEND, _TURN = 1.0, 2.0
"""Expected curvature of straight lines by a lens, and its change along them: as of a fisheye. Their units are
the reciprocal of the picture's side, and its square."""
_FOURTH = 1.0 / 24.0
"""Expected departure beyond the third order, in fourth powers of the distance over cubes of that side."""
_HOMOGRAPHY = 8
"""Parameters."""
_LEAST_SHARE = 1e-3


@dataclass(frozen=True)
class LocalMaps:
    """Maps from offsets (px) to squares, around every corner.

    A homography of all corners, a plane's image, is bent by a lens: what is left is of second order near by.

    Attributes
    ----------
    linear : ndarray, shape (n, 2, 2)
        1/px; NaN where the corners around do not tell the map.
    square : ndarray, shape (n, 2, 3)
        Of ``x^2 / 2``, ``x y`` and ``y^2 / 2``, 1/px^2.
    perspective : ndarray, shape (n, 2)
        1/px.
    cube : ndarray, shape (n, 2, 4)
        Of third order, 1/px^3.
    information : ndarray, shape (n, 10, 10)
        On the coefficients, along x and then y: the inverse of their covariance.
    """

    linear: np.ndarray
    square: np.ndarray
    perspective: np.ndarray
    cube: np.ndarray
    information: np.ndarray

    @property
    def known(self) -> np.ndarray:
        """Mask of the corners that have a map, shape (n,)."""
        return np.asarray(np.isfinite(self.linear[:, 0, 0]))


def local_maps(nodes: list[Node], places: np.ndarray, sigma: np.ndarray, side: float) -> LocalMaps:
    """Return the maps around corners by least squares, from up to 24 around each.

    Parameters
    ----------
    nodes : list of (col, row)
        At least four, not all on one line.
    places : ndarray, shape (n, 2)
        Px.
    sigma : ndarray, shape (n,)
        Errors of the places, px; infinite for those that are not to count.
    side : float
        Of the picture, px.
    """
    grid, count = NodeGrid.of(nodes), len(nodes)
    counted = np.isfinite(sigma) if np.isfinite(sigma).sum() > _ENOUGH else np.ones(count, dtype=bool)
    to_picture = projective_map("corners", grid.nodes[counted].astype(np.float64), places[counted])
    share = _bend_share(to_picture, grid.nodes, places, (sigma, side))
    H = np.linalg.inv(to_picture)
    perspective = H[2, :2] / (places @ H[2, :2] + H[2, 2])[:, None]
    spread = grid.spread(
        np.concatenate([places, grid.nodes.astype(np.float64), (1.0 / sigma)[:, None]], axis=1)
    )
    coefficients, information = np.full((count, 2, _TERMS), np.nan), np.zeros((count, 10, 10))
    near = around(spread, _REACH)[:, *grid.at].copy()
    near[len(near) // 2, :, 4] = 0.0  # its own noise must not return by its map
    enough = (np.nan_to_num(near[..., 4]) > 0.0).sum(axis=0) >= _ENOUGH
    enough &= _in_front(near, places, perspective)
    if enough.any():
        coefficients[enough], information[enough] = _fitted(
            near[:, enough], places[enough], grid.nodes[enough], perspective[enough], (side, share)
        )
    linear, square, cube = np.split(coefficients[..., 1:], [2, 5], axis=-1)
    return LocalMaps(linear, square, perspective, cube, information)


def _bend_share(
    to_picture: np.ndarray, nodes: np.ndarray, places: np.ndarray, scale: tuple[np.ndarray, float]
) -> float:
    """Return how much a picture may be bent, over what a fisheye bends: what corners leave of a homography.

    `scale` holds the errors of the places (n,) and the picture's side, px. The residuals beyond the errors,
    and three deviations more, are the size that a change of curvature has over the board.
    """
    sigma, side = scale
    counted = np.isfinite(sigma)
    spare = 2 * int(counted.sum()) - _HOMOGRAPHY
    if spare <= 0:
        return 1.0
    nodes, places, sigma = nodes[counted], places[counted], sigma[counted]
    xyw = homogeneous(nodes.astype(np.float64)) @ to_picture.T
    residual = places - xyw[:, :2] / xyw[:, 2:]
    excess = float((residual**2 / sigma[:, None] ** 2).sum()) / spare - 1.0
    beyond = np.sqrt((max(excess, 0.0) + 3.0 * np.sqrt(2.0 / spare)) * float(np.median(sigma)) ** 2)
    reach = float(np.sqrt(((places - places.mean(axis=0)) ** 2).sum(axis=1).mean()))
    return float(np.clip(beyond / (_TURN * reach**3 / (6.0 * side**2)), _LEAST_SHARE, 1.0))


def _in_front(near: np.ndarray, places: np.ndarray, perspective: np.ndarray) -> np.ndarray:
    """Return for which places (n, 2) all that are near (k, n, 5) lie on the same side of the horizon."""
    away = np.nan_to_num(near[..., :2] - places)
    return np.asarray((1.0 + (away * perspective).sum(axis=-1) > 0.0).all(axis=0))


def _fitted(
    near: np.ndarray,
    places: np.ndarray,
    nodes: np.ndarray,
    perspective: np.ndarray,
    lens: tuple[float, float],
) -> tuple[np.ndarray, np.ndarray]:
    """Return coefficients (n, 2, 10) and information (n, 10, 10) from places, nodes and weights (k, n, 5)."""
    side, share = lens
    weight = np.nan_to_num(near[..., 4]).T
    known = weight > 0.0
    away = np.where(known[..., None], np.moveaxis(near[..., :2] - places, 0, 1), 0.0)
    steps = np.where(known[..., None], np.moveaxis(near[..., 2:4] - nodes, 0, 1), 0.0)
    x, y = np.moveaxis(away, 2, 0)
    over = 1.0 / (1.0 + np.einsum("nka,na->nk", away, perspective))
    second = [0.5 * x * x, x * y, 0.5 * y * y]
    third = [x**3 / 6.0, 0.5 * x * x * y, 0.5 * x * y * y, y**3 / 6.0]
    design = np.stack([np.ones_like(x), x * over, y * over, *second, *third], axis=-1)
    beyond = share * _FOURTH * (x * x + y * y) ** 2 / side**3
    weighted = design * (known / (np.where(known, weight, 1.0) ** -2 + beyond**2))[..., None]
    normal = np.einsum("nki,nkj->nij", weighted, design)
    # Bends in px are expected to be 0, with standard deviations.
    normal[:, range(3, _KEPT), range(3, _KEPT)] += (side / (share * _BEND)) ** 2
    normal[:, range(_KEPT, _TERMS), range(_KEPT, _TERMS)] += (side**2 / (share * _TURN)) ** 2
    right = np.einsum("nki,nka->nia", weighted, steps)
    size = np.sqrt(np.einsum("nii->ni", normal))
    scaled = normal / (size[:, None] * size[..., None])
    inverse = np.linalg.inv(scaled) / (size[:, None] * size[..., None])
    coefficients = np.einsum("nij,nja->nai", inverse, right)
    # Errors in px are, along the board's axes, as the linear part has it.
    M = coefficients[..., 1:3]
    to_px = np.linalg.inv(M @ M.transpose(0, 2, 1))
    information = np.einsum("nab,nij->naibj", to_px, np.linalg.inv(inverse[:, 1:_KEPT, 1:_KEPT]))
    return coefficients, information.reshape(-1, 10, 10)
