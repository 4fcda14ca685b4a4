"""The bench group against mrcal: how it compares, and what it says where there is no mrcal."""

from pathlib import Path

import numpy as np
import pytest

from labcal.bench.detect.bias import bench_target
from labcal.bench.groups import Bench
from labcal.bench.hand_views import HandViews, dots_at, poses_in_hand
from labcal.bench.solve import mrcal
from labcal.bench.solve.mrcal_programs import calibrated_by_mrcal, is_installed
from labcal.cameras.dot_image import dot_images
from labcal.run.progress import NoProgress


def test_without_mrcal_there_is_a_note_and_no_check(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(mrcal, "is_installed", lambda: False)
    found = mrcal.mrcal_findings(Bench(quick=True, seed=0, folder=tmp_path, progress=NoProgress()))
    assert found.checks == []
    assert "not installed" in found.notes[0]


def test_the_ratio_is_that_of_all_and_what_mrcal_lost_is_told() -> None:
    found = mrcal._compared("some", [(3.0, 4.0), None, (4.0, 3.0)])
    assert found.checks[0].value == pytest.approx(1.0)
    assert found.checks[0].ok
    assert [figure.value for figure in found.references] == pytest.approx([12.5**0.5, 12.5**0.5, 0.75, 4 / 3])
    assert "1 of 3 left out" in found.notes[0]
    assert not mrcal._compared("some", [(4.0, 3.0)]).checks[0].ok
    assert mrcal._compared("some", [None]).checks == []


@pytest.mark.slow
@pytest.mark.skipif(not is_installed(), reason="mrcal is not installed")
def test_mrcal_finds_the_camera_from_our_corners(tmp_path: Path) -> None:
    camera, target = mrcal.bench_camera(), bench_target()
    poses = poses_in_hand(camera, target, HandViews(8, 45.0, 24.0), np.random.default_rng(3))
    seen = [dot_images(camera, T, target.points(), 0.5 * target.outer_diameters_mm()) for T in poses]
    dots = dots_at([one.centre for one in seen], [one.ok for one in seen], target, camera.size, 0.1)
    found = calibrated_by_mrcal(dots, target, 1900.0, tmp_path)
    assert found is not None
    assert found.size == camera.size
    # mrcal's regularisation is what is left without noise.
    np.testing.assert_allclose(found.intrinsics, camera.intrinsics, atol=0.5)
