"""The benchmark's own checks on small data: they pass as they stand, and can fail."""

import numpy as np
import pytest

from labcal.bench.render import dots, rays
from labcal.bench.render.sensors import sensor_checks
from labcal.run.progress import NoProgress


def test_projections_agree_with_opencv() -> None:
    checks = rays.opencv_checks(0)
    assert len(checks) == 7
    assert all(check.ok for check in checks)


def test_presets_come_back_from_flat_fields() -> None:
    checks = sensor_checks(np.full((256, 256), 0.7, dtype=np.float32), 1)
    assert len(checks) == 12
    assert all(check.ok for check in checks)


def test_grey_centroids_of_dots_lie_on_the_true_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dots, "OPTICS", {"brown5": None})
    monkeypatch.setattr(dots, "RADII_PX", (10.0,))
    monkeypatch.setattr(dots, "SIZE", (320, 240))
    checks = dots.dot_checks(0, (45.0,), NoProgress())
    assert [check.ok for check in checks] == [True, True]
    # A truth that is off by a hundredth of a pixel would be noticed.
    monkeypatch.setattr(dots, "grey_errors", dots_moved)
    moved = dots.dot_checks(0, (45.0,), NoProgress())
    assert [check.ok for check in moved] == [False, False]


GREY_ERRORS = dots.grey_errors


def dots_moved(light: np.ndarray, whole: object) -> np.ndarray:
    return GREY_ERRORS(light, whole) + 0.01
