import json
from pathlib import Path

import numpy as np
import pytest

from labcal.bench.detect import speed
from labcal.bench.detect.bench import bench_detect
from labcal.bench.detect.dot_visibility import DotVisibility
from labcal.bench.detect.opencv_grid import MODES, finds_grid
from labcal.bench.detect.plain_centres import blob_centres, contour_centres
from labcal.bench.settings import BenchSettings
from labcal.detect.detector import detect_dots
from labcal.errors import UnknownNameError
from labcal.rng import generator
from labcal.run.progress import NoProgress


def test_groups_can_be_chosen_and_what_is_left_out_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("LABCAL_REAL_DATA", raising=False)
    result = bench_detect(tmp_path / "out", BenchSettings(groups=("real",)), NoProgress())
    assert result.checks == ()
    assert "LABCAL_REAL_DATA" in result.notes[0]
    assert json.loads((tmp_path / "out" / "results.json").read_text())["bench"] == "detect"
    with pytest.raises(UnknownNameError, match="Did you mean 'suite'"):
        bench_detect(tmp_path / "other", BenchSettings(groups=("suit",)), NoProgress())


def test_opencv_finds_the_plain_board_and_its_centres_are_near() -> None:
    picture = speed.drawn_board((640, 480), generator(0, "test"), hole=0.0)
    boxed = blob_centres(picture, *_found(picture))
    centres, shapes = _found(picture)
    contours = contour_centres(picture, centres, shapes)
    assert np.isfinite(boxed).all()
    assert 0.0 < np.abs(boxed - centres).max() < 0.5
    assert 0.0 < np.abs(contours - centres).max() < 0.5
    seen = _sight(centres)
    assert any(finds_grid(picture, speed.TARGET, seen, flags) for flags in MODES.values())
    # Truth elsewhere is not found.
    assert not any(
        finds_grid(picture, speed.TARGET, _sight(centres + 9.0), flags) for flags in MODES.values()
    )


def _found(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    with_rings = speed.drawn_board((640, 480), generator(0, "test"))
    dots = detect_dots(with_rings, speed.TARGET)
    assert dots.ok.sum() == speed.TARGET.count
    assert picture.shape == with_rings.shape
    return dots.position[dots.ok], dots.outline[dots.ok]


def _sight(centroid: np.ndarray) -> DotVisibility:
    n = len(centroid)
    return DotVisibility(
        index=speed.TARGET.indices(),
        centroid=centroid,
        minor_px=np.full(n, 6.0),
        pitch_px=np.full(n, 30.0),
        hidden=np.zeros(n),
        in_frame=np.ones(n, dtype=bool),
        measurable=np.ones(n, dtype=bool),
        ring=np.zeros(n, dtype=bool),
    )
