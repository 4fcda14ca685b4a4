"""Decisions of the acceptance test on a rendered volume, with limits near the largest error."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import labcal as library
from labcal.evaluate.acceptance.decision import Outcome
from labcal.pipeline import CertifySettings
from labcal.rng import generator

Run = Callable[..., Any]
TARGET = "paper-13x10"
HELD = 4
"""Views that the calibration does not see."""
CASES, SIGMAS = 40, 6.0


def _lengths(views: list[str], rng: np.random.Generator) -> tuple[library.ReferenceLengths, np.ndarray]:
    """Return 35 lengths between dots of views, the calibrated ones with errors, and the true ones."""
    target = library.load_target(TARGET)
    p = target.points()
    number, rows = np.arange(target.count), []
    for line in range(7):
        view = views[line % len(views)]
        for length in range(5):
            a, b = rng.choice(number, 2, replace=False).tolist()
            ends = [f"{n % target.cols}:{n // target.cols}" for n in (a, b)]
            rows.append(
                (str(line), str(length), view, ends[0], view, ends[1], float(np.linalg.norm(p[a] - p[b])))
            )
    columns = [list(column) for column in zip(*rows, strict=True)]
    return library.ReferenceLengths(*columns), np.array(columns[6])


@pytest.mark.slow
def test_forty_decisions_near_the_limit_are_right(labcal: Run, tmp_path: Path) -> None:
    """A rendered set, calibrated from eight views; lengths in the four others."""
    shoot, dots, rig = tmp_path / "shoot", tmp_path / "dots.csv", tmp_path / "rig.json"
    words = ("--views", 12, "--spp", 16, "--workers", 1)
    assert labcal("render", "webcam-handheld", "-o", shoot, *words).status == 0
    assert labcal("detect", shoot, "-o", dots, "--workers", 1).status in {0, 1}
    found = library.read_detections(dots)
    held = list(found.views)[:HELD]
    made = library.pipeline.calibrate(TARGET, found, "brown5", hold_out=held)
    made.save(rig)
    points = library.pipeline.reconstruct(made.rig, found, TARGET)
    rng, wrong, open_ = generator(0, "certify rendered"), [], []
    for _ in range(CASES):
        reference, true = _lengths(held, rng)
        exact = library.certify(points, reference)
        error = np.abs(exact.error_mm)
        worst = float(np.nanmax(error))
        sigma = 0.1 * worst
        nominal = true + sigma * rng.standard_normal(len(true))
        noisy = library.ReferenceLengths(
            reference.line, reference.length, reference.view_a, reference.point_a, reference.view_b,
            reference.point_b, nominal, np.full(len(true), sigma),
        )  # fmt: skip
        off = rng.uniform(-SIGMAS, SIGMAS)
        limit = worst + off * sigma
        outcome = library.certify(points, noisy, CertifySettings(limit_mm=limit)).outcome
        stated = {Outcome.CONFORMING: True, Outcome.NOT_CONFORMING: False}
        wrong.append(outcome in stated and stated[outcome] is not (worst <= limit))
        open_.append(outcome is Outcome.UNDECIDED and abs(off) > 5.0)
    assert sum(wrong) <= 0.05 * CASES
    assert sum(open_) <= 0.05 * CASES
