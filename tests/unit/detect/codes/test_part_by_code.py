"""Parts of boards whose dots are all alike, placed by the code printed beside them."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from coded_print import photographed

from labcal.correspond.measure import measure_picture
from labcal.correspond.sources import Source
from labcal.detect.codes.own_board import own_board_where_seen
from labcal.detect.codes.part_by_code import placed_by_code
from labcal.detect.detector import detect_dots
from labcal.targets.catalogue import load_target
from labcal.targets.code_text import PrintedTarget


@pytest.mark.parametrize("name", ["plain-11x8", "chessboard-9x6"])
def test_a_part_beside_its_code_has_the_ids_of_the_whole(name: str, tmp_path: Path) -> None:
    target, picture = load_target(name), photographed(name, 0)
    whole = detect_dots(own_board_where_seen(picture, target), target)
    assert whole.refusal is None
    left, top = np.percentile(whole.position[whole.ok], 40, axis=0).astype(int)
    x, y = int(left), int(top)
    part = np.ascontiguousarray(picture[y:, x:])
    path = tmp_path / f"{x}-{y}.png"
    cv2.imwrite(str(path), part)
    found = measure_picture(Source("a", "camera", str(path), None), target).dots
    assert found is not None
    assert found.refusal is None
    assert 9 <= int(found.ok.sum()) < whole.ok.sum()
    right = {tuple(key): q for key, q in zip(whole.index.tolist(), whole.position, strict=True)}
    off = [
        np.abs(q + np.array([x, y]) - right[tuple(key)]).max()
        for key, q, ok in zip(found.index.tolist(), found.position, found.ok, strict=True)
        if ok
    ]
    assert max(off) < 0.2
    assert len(found.others) == len(whole.others)  # cameras still agree on the orientation


def test_a_part_without_its_code_stays_refused() -> None:
    target, picture = load_target("plain-11x8"), photographed("plain-11x8", 0)
    part = np.ascontiguousarray(picture[: picture.shape[0] // 2])
    dots = detect_dots(part, target)
    assert dots.refusal is not None
    assert dots.part is not None
    assert placed_by_code(part, dots, PrintedTarget(target)) is dots
    of_another = np.ascontiguousarray(photographed("chessboard-9x6", 0)[400:])
    assert placed_by_code(of_another, dots, PrintedTarget(target)) is dots
