"""What a reconstruction is told to be careful of, at length."""

import time
from collections.abc import Callable

import numpy as np

from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.points import Points
from labcal.reconstruct.reconstruction import Reconstruction
from labcal.reconstruct.reconstruction_warnings import reconstruction_warnings
from labcal.targets.grid import DotGrid


def test_thousands_of_views_without_a_point_are_told_at_once_and_in_short(
    see: Callable[..., Detections], pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]
) -> None:
    views, each = 4000, 20
    exact = see(pair, grid, poses)
    named = np.repeat([f"view-{n:04d}" for n in range(views)], each)
    detections = exact.where(np.arange(views * each) % len(exact))
    columns = {name: getattr(detections, name) for name in detections.__dataclass_fields__} | {"view": named}
    n = views * each // 2
    points = Points(
        named[:n],
        np.zeros((n, 2), dtype=np.int64),
        np.zeros((n, 3)),
        np.tile(np.eye(3), (n, 1, 1)),
        np.full(n, "ok"),
    )
    found = Reconstruction(points, None, None, None)
    started = time.process_time()
    (told,) = reconstruction_warnings(Rig.of(pair), Detections(**columns), found, grid)
    assert time.process_time() - started < 2.0  # a set of all points for every view took over ten
    assert told.startswith("no dot was measured by all cameras in 2000 views: view-2000, view-2001, ")
    assert told.endswith("and 1988 more")
