import numpy as np

from labcal.correspond.coverage import coverage
from labcal.correspond.detections import Detections


def test_dots_are_counted_in_their_cells_of_their_camera() -> None:
    # The frame of 80 x 60 px begins at -0.5, so cells are 10 px and the first ends at 9.5.
    position = np.array([[-0.4, -0.4], [9.4, 9.4], [9.6, 9.4], [79.4, 59.4], [30.0, 30.0], [np.nan, np.nan]])
    detections = Detections(
        view=np.array(["a"] * 6),
        camera=np.array(["left"] * 4 + ["right", "left"]),
        image=np.array(["a.png"] * 6),
        size=np.tile([80, 60], (6, 1)),
        index=np.zeros((6, 2), np.int64),
        has_id=np.ones(6, dtype=bool),
        position=position,
        covariance=np.full((6, 2, 2), np.nan),
        flag=np.array(["ok"] * 5 + ["cut"]),
    )
    expected = np.zeros((6, 8), np.int64)
    expected[0, 0], expected[0, 1], expected[5, 7] = 2, 1, 1
    np.testing.assert_array_equal(coverage(detections, "left", (80, 60)), expected)
    np.testing.assert_array_equal(
        coverage(detections.where(detections.flag == "cut"), "left", (80, 60)), np.zeros((6, 8), np.int64)
    )
