"""Large grids through strong fisheyes: outlines as the lens images them, numbered by their rings."""

import cv2
import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.detect.grid import Grid, find_grid
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.smoothness import is_smooth, is_smooth_through_fisheye
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.settings import DEFAULTS
from labcal.targets.grid import DotGrid, Rings

SIZE = (1280, 960)
BIG = DotGrid(
    name="big",
    cols=49,
    rows=36,
    pitch_x_mm=10,
    pitch_y_mm=10,
    dot_diameter_mm=5,
    ring_outer_diameter_mm=7,
    ring_inner_diameter_mm=3.5,
    rings=Rings(origin=(22, 16), x=(26, 16), y=(22, 19)),
    margin_mm=8,
)
EQUIDISTANT, EQUISOLID, STEREOGRAPHIC = (
    (0.0, 0.0, 0.0, 0.0),
    (-1 / 24, 1 / 1920, 0.0, 0.0),
    (1 / 12, 1 / 120, 0.0, 0.0),
)


def outlines(focal: float, dist: tuple[float, ...], tilt: tuple[float, float, float], distance: float):  # noqa: ANN201
    """Return the outlines that are whole in the picture and 5 px across at least, and their (col, row)."""
    middle = np.array(SIZE) / 2 + [11.0, -17.0]
    K = np.array([[focal, 0, middle[0]], [0, focal, middle[1]], [0, 0, 1.0]])
    camera = Camera(K, "fisheye-kb4", np.array([*dist, 0.0]), np.eye(4), SIZE)
    about_x, about_y, about_z = np.radians(tilt)
    turns = [cv2.Rodrigues(np.array(v))[0] for v in ((0, 0, about_z), (about_x, 0, 0), (0, about_y, 0))]
    T = np.eye(4)
    T[:3, :3] = turns[0] @ turns[1] @ turns[2] @ np.diag([1.0, -1.0, -1.0])
    T[:3, 3] = np.array([0, 0, distance]) - T[:3, :3] @ BIG.points().mean(axis=0)
    images = dot_images(camera, T, BIG.points(), 0.5 * BIG.outer_diameters_mm())
    away = images.outline - images.outline.mean(axis=1, keepdims=True)
    shape = 2 * np.einsum("nki,nkj->nij", away, away) / away.shape[1]
    inside = ((images.outline > 1) & (images.outline < np.array(SIZE) - 2)).all(axis=(1, 2))
    with np.errstate(invalid="ignore"):
        seen = images.ok & inside & (np.linalg.eigvalsh(np.nan_to_num(shape))[:, 0] > 2.5**2)
    index = BIG.indices()
    ring = np.array([tuple(one) in BIG.ring_indices for one in index.tolist()])
    noise = np.random.default_rng(5).normal(0, 0.05, (len(index), 2))
    found = Outlines(images.centroid + noise, shape, np.where(ring, 1.0, 0.0), np.full(len(index), 0.7))
    return found.select(seen), index[seen]


@pytest.mark.parametrize(
    ("focal", "dist", "tilt", "distance"),
    [
        (600.0, EQUIDISTANT, (25, 0, 10), 120.0),
        (480.0, EQUIDISTANT, (0, 0, 0), 120.0),
        (400.0, EQUISOLID, (10, 30, 40), 120.0),
        (380.0, STEREOGRAPHIC, (15, -20, 150), 100.0),
        (320.0, EQUIDISTANT, (25, 0, -70), 120.0),
    ],
)
def test_every_dot_of_a_grid_through_a_strong_fisheye_keeps_its_id(
    focal: float, dist: tuple[float, ...], tilt: tuple[float, float, float], distance: float
) -> None:
    seen, index = outlines(focal, dist, tilt, distance)
    grid = find_grid(seen, BIG, SIZE, DEFAULTS.grid)
    assert isinstance(grid, Grid)
    assert len(grid.spots) > 0.97 * len(index)
    for node, spot in grid.lattice.spots.items():
        assert grid.numbering.index(node) == tuple(index[spot])


def test_a_row_linked_one_step_off_is_told_through_a_fisheye() -> None:
    seen, index = outlines(400.0, EQUIDISTANT, (10, 20, 40), 120.0)

    def lattice(nodes: np.ndarray) -> Lattice:
        return Lattice({(int(a), int(b)): k for k, (a, b) in enumerate(nodes.tolist())})

    assert not is_smooth(lattice(index), seen.centre, DEFAULTS.grid)  # through a lens without distortion
    assert is_smooth_through_fisheye(lattice(index), seen.centre, SIZE, DEFAULTS.grid)
    for row in (8, 15, 22, 28):
        sheared, skipped = index.copy(), index.copy()
        sheared[index[:, 1] > row, 0] += 1
        skipped[index[:, 1] > row, 1] += 1
        for wrong in (sheared, skipped):
            assert not is_smooth_through_fisheye(lattice(wrong), seen.centre, SIZE, DEFAULTS.grid)
