"""Maps from the picture to the board around each corner, by the corners next to it."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.board_lens import board_lens
from labcal.detect.corners.lens_maps import BEYOND, LensMaps, lens_maps
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
_OF_LENS = 10.0
"""Errors that the corners' noise leaves in a lens, in those that it hides of bends without one: with 1 the
errors of 24 corners were stated a quarter too small."""
_ALIKE = 1e-9
"""Singular values, over the largest, of changes of a homography that change nothing: its scale."""


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
    beyond : ndarray, shape (n, 2, 11)
        What a lens adds in fourth and fifth order, see :class:`~labcal.detect.corners.lens_maps.LensMaps`; 0
        where the corners demand no lens.
    """

    linear: np.ndarray
    square: np.ndarray
    perspective: np.ndarray
    cube: np.ndarray
    information: np.ndarray
    beyond: np.ndarray

    @property
    def known(self) -> np.ndarray:
        """Mask of the corners that have a map, shape (n,)."""
        return np.asarray(np.isfinite(self.linear[:, 0, 0]))


def local_maps(nodes: list[Node], places: np.ndarray, sigma: np.ndarray, size: tuple[int, int]) -> LocalMaps:
    """Return the maps around corners by least squares, from up to 24 around each.

    Parameters
    ----------
    nodes : list of (col, row)
        At least four, not all on one line.
    places : ndarray, shape (n, 2)
        Px.
    sigma : ndarray, shape (n,)
        Errors of the places, px; infinite for those that are not to count.
    size : (int, int)
        Width and height of the picture, px.
    """
    grid, count, side = NodeGrid.of(nodes), len(nodes), float(max(size))
    counted = np.isfinite(sigma) if np.isfinite(sigma).sum() > _ENOUGH else np.ones(count, dtype=bool)
    to_picture = projective_map("corners", grid.nodes[counted].astype(np.float64), places[counted])
    lens = board_lens(grid.nodes[counted], places[counted], size)
    plain = _in_picture(to_picture, grid.nodes) if lens is None else lens.in_picture(grid.nodes, places)
    bend = plain - places
    share = _bend_share(to_picture, bend, (grid.nodes, places), (sigma, side))
    share = share if lens is None else min(_OF_LENS * share, 1.0)
    spread = grid.spread(np.concatenate([places, bend, (1.0 / sigma)[:, None]], axis=1))
    near = around(spread, _REACH)[:, *grid.at].copy()
    near[len(near) // 2, :, 4] = 0.0  # its own noise must not return by its map
    enough = (np.nan_to_num(near[..., 4]) > 0.0).sum(axis=0) >= _ENOUGH
    to_board = np.linalg.inv(to_picture)
    if lens is None:
        enough &= _in_front(near, places, to_board)
    parts = [np.full((count, *shape), np.nan) for shape in ((2, 2), (2, 3), (2,), (2, 4))]
    beyond = np.zeros((count, 2, BEYOND))
    information = np.zeros((count, 10, 10))
    if enough.any():
        bends, certain = _bends(near[:, enough], places[enough], (side, share))
        middle = places[enough] + bends[..., 0]
        base = _of_plane(to_board, middle) if lens is None else lens_maps(lens, middle)
        maps, to_px = _bent(base, bends)
        beyond[enough] = base.beyond
        for part, found in zip(parts, maps, strict=True):
            part[enough] = found
        both = np.einsum("nab,nij->naibj", to_px, certain)
        information[enough] = both.reshape(-1, 10, 10)
    linear, square, perspective, cube = parts
    return LocalMaps(linear, square, perspective, cube, information, beyond)


def _in_picture(to_picture: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Return where a homography has nodes (n, 2), px."""
    xyw = homogeneous(nodes.astype(np.float64)) @ to_picture.T
    return np.asarray(xyw[:, :2] / xyw[:, 2:])


def _bend_share(
    to_picture: np.ndarray,
    bend: np.ndarray,
    corners: tuple[np.ndarray, np.ndarray],
    scale: tuple[np.ndarray, float],
) -> float:
    """Return how much a picture may be bent, over what a fisheye bends: what corners leave of a homography.

    Or of a homography and a lens: `bend` (n, 2), px, at `corners`, their nodes and places.

    `scale` holds the errors of the places (n,) and the picture's side, px. The residuals beyond the errors,
    and three deviations more, are the size that a change of curvature has over the board.
    """
    (nodes, places), (sigma, side) = corners, scale
    counted = np.isfinite(sigma)
    spare = 2 * int(counted.sum()) - _HOMOGRAPHY
    if spare <= 0:
        return 1.0
    nodes, places, sigma = nodes[counted], places[counted], sigma[counted]
    residual = bend[counted]
    excess = float((residual**2 / sigma[:, None] ** 2).sum()) / spare - 1.0
    beyond = np.sqrt((max(excess, 0.0) + 3.0 * np.sqrt(2.0 / spare)) * float(np.median(sigma)) ** 2)
    left = _left_of_a_turn(to_picture, nodes, places) * _TURN / side**2
    return float(np.clip(beyond / left, _LEAST_SHARE, 1.0)) if left > 0.0 else 1.0


def _left_of_a_turn(to_picture: np.ndarray, nodes: np.ndarray, places: np.ndarray) -> float:
    """Return the root mean square residual that a homography of nodes (n, 2) leaves of a lens's bend, px^3.

    The bend is ``r |r|^2 / 6`` from the corners' middle on, whose third derivatives are up to 1. A homography
    takes most of it: over a square of side 2 a, 0.15 a^3 is left of x^3.
    """
    plane = homogeneous(nodes.astype(np.float64))
    xyw = plane @ to_picture.T
    q, plane = xyw[:, :2] / xyw[:, 2:], plane / xyw[:, 2:]
    none = np.zeros_like(plane)
    tangent = np.concatenate(
        [
            np.concatenate([plane, none, -q[:, :1] * plane], axis=1),
            np.concatenate([none, plane, -q[:, 1:] * plane], axis=1),
        ]
    )
    away = places - places.mean(axis=0)
    bend = (away * (away**2).sum(axis=1)[:, None] / 6.0).T.ravel()
    size = np.linalg.norm(tangent, axis=0)
    columns, kept, _ = np.linalg.svd(tangent / np.where(size > 0.0, size, 1.0), full_matrices=False)
    columns = columns[:, kept > _ALIKE * kept[0]]
    left = bend - columns @ (columns.T @ bend)
    return float(np.sqrt((left**2).mean()))


def _in_front(near: np.ndarray, places: np.ndarray, to_board: np.ndarray) -> np.ndarray:
    """Return for which places (n, 2) all that are near (k, n, 5) lie on the same side of the horizon."""
    perspective = to_board[2, :2] / (places @ to_board[2, :2] + to_board[2, 2])[:, None]
    away = np.nan_to_num(near[..., :2] - places)
    return np.asarray((1.0 + (away * perspective).sum(axis=-1) > 0.0).all(axis=0))


def _bends(near: np.ndarray, places: np.ndarray, lens: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return coefficients (n, 2, 10) of what bends the homography's picture, px, by those near (k, n, 5).

    And the information on those of first and second order, (n, 5, 5), the same along x and y. The bend is
    where the homography has a corner less where it is, so that a lens alone, whatever the tilt of the board,
    is what it tells; it is smooth in the picture, and not on the board.
    """
    side, share = lens
    weight = np.nan_to_num(near[..., 4]).T
    known = weight > 0.0
    away = np.where(known[..., None], np.moveaxis(near[..., :2] - places, 0, 1), 0.0)
    bend = np.where(known[..., None], np.moveaxis(near[..., 2:4], 0, 1), 0.0)
    x, y = np.moveaxis(away, 2, 0)
    second = [0.5 * x * x, x * y, 0.5 * y * y]
    design = np.stack([np.ones_like(x), x, y, *second, *_third_order(x, y)], axis=-1)
    beyond = share * _FOURTH * (x * x + y * y) ** 2 / side**3
    weighted = design * (known / (np.where(known, weight, 1.0) ** -2 + beyond**2))[..., None]
    normal = np.einsum("nki,nkj->nij", weighted, design)
    # Bends are expected to be 0, with standard deviations.
    normal[:, range(3, _KEPT), range(3, _KEPT)] += (side / (share * _BEND)) ** 2
    normal[:, range(_KEPT, _TERMS), range(_KEPT, _TERMS)] += (side**2 / (share * _TURN)) ** 2
    right = np.einsum("nki,nka->nia", weighted, bend)
    size = np.sqrt(np.einsum("nii->ni", normal))
    scaled = normal / (size[:, None] * size[..., None])
    inverse = np.linalg.inv(scaled) / (size[:, None] * size[..., None])
    coefficients = np.einsum("nij,nja->nai", inverse, right)
    return coefficients, np.linalg.inv(inverse[:, 1:_KEPT, 1:_KEPT])


def _third_order(x: np.ndarray, y: np.ndarray) -> list[np.ndarray]:
    return [x**3 / 6.0, 0.5 * x * x * y, 0.5 * x * y * y, y**3 / 6.0]


def _of_plane(to_board: np.ndarray, q: np.ndarray) -> LensMaps:
    """Return the maps of a homography, without a lens, around places in the picture (n, 2), px."""
    middle = homogeneous(q) @ to_board.T
    depth, to = middle[:, 2:], middle[:, :2] / middle[:, 2:]
    slope = (to_board[:2, :2] - to[..., None] * to_board[2, :2]) / depth[..., None]
    parts = (np.zeros((len(q), 2, terms)) for terms in (3, 4, BEYOND))
    return LensMaps(slope, to_board[2, :2] / depth, *parts)


def _bent(
    base: LensMaps, bends: np.ndarray
) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Return linear, square, perspective and cube of :class:`LocalMaps` of a map after further bends.

    And the information on a place on the board over that on one in the picture, (n, 2, 2).
    """
    slope, horizon = base.linear, base.perspective
    turned = np.eye(2) + bends[..., 1:3]
    linear = slope @ turned
    perspective = np.einsum("na,nai->ni", horizon, turned)
    square = slope @ bends[..., 3:_KEPT]
    # The slope of the homography changes along the bend: by -(h r) S - (S r) h to first order.
    cube = slope @ bends[..., _KEPT:]
    cube -= _of_product(perspective[:, None], square)
    cube -= _of_product(linear, np.einsum("na,nai->ni", horizon, bends[..., 3:_KEPT])[:, None])
    to_px = np.linalg.inv(slope @ slope.transpose(0, 2, 1))
    return (linear, base.square + square, perspective, base.cube + cube), to_px


def _of_product(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return coefficients of third order (n, 2, 4) of a linear term (.., 2) times one of second order."""
    (u, v), (a, b, c) = np.moveaxis(first, -1, 0), np.moveaxis(second, -1, 0)
    return np.stack([3.0 * a * u, 2.0 * b * u + a * v, c * u + 2.0 * b * v, 3.0 * c * v], axis=-1)
