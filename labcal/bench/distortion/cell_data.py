"""Training and test data of a case: the same for every method."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.bench.distortion.case import NO_FAULT, Case, Cell, Layout, Measured
from labcal.bench.families.registry import family_by_name
from labcal.bench.families.volume import COLS, PLANES, ROWS, Volume
from labcal.bench.faults.planned_planes import PlannedPlanes
from labcal.bench.faults.registry import fault_named
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.errors import InputError
from labcal.geometry.hull import inside_hull
from labcal.geometry.projective_map import homogeneous, projective_map
from labcal.rng import generator

MARGIN = 0.25
"""Of the volume's sides, up to which points outside are drawn."""
_MOST_DRAWS = 50
_STREAM = "bench distortion"


@dataclass(frozen=True)
class RegionPoints:
    """Points of a region, their noisy pixels, and what exact cameras make of them.

    Attributes
    ----------
    p : float64 array, (n, 3)
        Mm.
    q : float64 array, (n, cameras, 2)
        Px.
    oracle : float64 array, (n, 3)
        Triangulated from the same pixels with the true cameras and optimal weights, mm.
    covariance : float64 array, (n, cameras, 2, 2)
        Of `q`, which methods are given, px squared.
    """

    p: Vectors3
    q: Float64[np.ndarray, "n cameras 2"]
    oracle: Vectors3
    covariance: Float64[np.ndarray, "n cameras 2 2"]


@dataclass(frozen=True)
class CellData:
    """The data of a case.

    Attributes
    ----------
    X : float64 array, (n, 2 x cameras)
        Noisy pixels of training points, px.
    Y : float64 array, (n, 3)
        Training points, mm.
    beyond_pinhole_px : float
        RMS length of what the best linear projection leaves of the training pixels without noise.
    pixel_error_px : float
        Of detected pixels, the RMS of each coordinate beside the exact one; NaN of simulated ones.
    """

    X: Float64[np.ndarray, "n inputs"]
    Y: Vectors3
    tests: Mapping[Measured, RegionPoints]
    beyond_pinhole_px: float
    pixel_error_px: float = float("nan")


def cell_data(case: Case) -> CellData:
    """Draw the data of a case; points that a camera does not see are left out.

    Cameras, points and noise are drawn by the cell and the seed and not by the methods, so that these are
    compared in pairs. A fault changes the exact pixels of training alone: with it and without, the
    methods know the same declared places, and the noise and the points to measure are the same.

    Raises
    ------
    UnknownNameError
        There is no such family.
    InputError
        The cameras see no training points, or none of a region; or a fault acts on pictures only, or on a
        board where there is none.
    """
    cell = case.cell
    family = family_by_name(cell.family)
    pair, volume = family.pair(cell.strength, case.seed), family.volume(cell.strength)
    random = generator(case.seed, _STREAM, *cell.names, "training")
    declared = _layout(cell, volume, random)
    exact = _images(pair, declared)
    seen = _seen(pair, exact)
    if not seen.any():
        raise InputError(f"The cameras of '{case.key}' see none of the {len(declared)} training points.")
    Y, exact = declared[seen], exact[seen]
    noise = cell.noise_px * random.standard_normal(exact.shape)
    tests = {region: _test_points(case, pair, volume, Y, region) for region in case.regions}
    if cell.fault != NO_FAULT:
        exact = _faulty_images(case, pair, declared)[seen]
        still_seen = _seen(pair, exact)
        if not still_seen.any():
            raise InputError(f"The cameras of '{case.key}' see none of the training points with this fault.")
        Y, exact, noise = Y[still_seen], exact[still_seen], noise[still_seen]
    return CellData((exact + noise).reshape(len(Y), -1), Y, tests, beyond_pinhole(Y, exact))


def lattice(points: int) -> tuple[int, int]:
    """Return columns and rows of the grids on the planes: with as many dots as points, or a few more."""
    per_plane = -(-points // PLANES)
    rows = max(2, int(np.floor(np.sqrt(per_plane * ROWS / COLS))))
    return max(2, -(-per_plane // rows)), rows


def _layout(cell: Cell, volume: Volume, random: np.random.Generator) -> Vectors3:
    if cell.layout is Layout.PLANES:
        return volume.planes(*lattice(cell.points))
    return volume.points(cell.points, random)


def _faulty_images(
    case: Case, pair: tuple[Camera, Camera], declared: Vectors3
) -> Float64[np.ndarray, "n cameras 2"]:
    """Return the exact pixels of training points with the fault of a case; NaN where there is no image."""
    if case.cell.layout is not Layout.PLANES:
        raise InputError(f"The fault '{case.cell.fault}' is one of a board, which takes the layout 'planes'.")
    fault = fault_named(case.cell.fault)
    return fault.kind.images(PlannedPlanes.of(declared, pair, case.seed), fault.size)


def _test_points(
    case: Case, pair: tuple[Camera, Camera], volume: Volume, Y: Vectors3, region: Measured
) -> RegionPoints:
    """Return the points of a region that both cameras see."""
    random = generator(case.seed, _STREAM, *case.cell.names, str(region))
    box = volume if region is Measured.WITHIN else volume.enlarged(MARGIN)
    found: list[np.ndarray] = []
    for _ in range(_MOST_DRAWS):
        drawn = box.points(4 * case.tests, random)
        in_region = inside_hull(drawn, Y, 0.0) == (region is Measured.WITHIN)
        found.append(drawn[in_region & _seen(pair, _images(pair, drawn))])
        if sum(map(len, found)) >= case.tests:
            break
    p = np.concatenate(found)[: case.tests]
    if len(p) == 0:
        raise InputError(f"The cameras of '{case.key}' see no points {region} the trained volume.")
    exact = _images(pair, p)
    q = exact + case.cell.noise_px * random.standard_normal(exact.shape)
    weights = np.tile(case.cell.noise_px**2 * np.eye(2), (len(p), len(pair), 1, 1))
    return RegionPoints(p, q, triangulate(pair, q, weights).point, weights)


def _images(pair: tuple[Camera, Camera], p: Vectors3) -> Float64[np.ndarray, "n cameras 2"]:
    return np.stack([camera.project(p).q for camera in pair], axis=1)


def _seen(pair: tuple[Camera, Camera], q: Float64[np.ndarray, "n cameras 2"]) -> np.ndarray:
    seen = [camera.in_picture(q[:, i]) for i, camera in enumerate(pair)]
    return np.asarray(np.stack(seen, axis=1).all(axis=1))


def beyond_pinhole(Y: Vectors3, exact: Float64[np.ndarray, "n cameras 2"]) -> float:
    """Return the RMS length of what linear projections leave, over both cameras; NaN where there is none."""
    squares = []
    for i in range(exact.shape[1]):
        try:
            image = homogeneous(Y) @ projective_map("bench distortion", Y, exact[:, i]).T
        except InputError:
            return float("nan")
        squares.append(((image[:, :2] / image[:, 2:] - exact[:, i]) ** 2).sum(axis=1).mean())
    return float(np.sqrt(np.mean(squares)))
