"""Plain dots matched between cameras, on exact projections with noise."""

from collections import defaultdict

import numpy as np
import pytest

from labcal import NamedPixels, Rig, examples
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.dot_image import SAMPLES, outlined_images
from labcal.correspond.mark_measurement import MarkPixels
from labcal.reconstruct.plain_dots import MatchedDots, matched_dots

SIGMA = 0.03
ANGLE = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES


def rig(scatter: float) -> Rig:
    return examples.rig().model_copy(update={"calibration": CalibrationRecord(scatter_px=scatter)})


def scattered(n: int, rng: np.random.Generator) -> np.ndarray:
    """Return places on a wavy surface, none too near to another."""
    places: list[np.ndarray] = []
    for x, y in rng.uniform([-110, -85], [110, 85], (n, 2)):
        p = np.array([x, y, 600.0 + 0.3 * x + 20.0 * np.sin(x / 50.0)])
        if all(np.linalg.norm(p - other) > 7.0 for other in places):
            places.append(p)
    return np.array(places)


def seen(p: np.ndarray, rng: np.random.Generator, lost: float = 0.05) -> tuple[MarkPixels, np.ndarray]:
    """Return pixels of discs of 4 mm in random order, some lost, and the number of the disc of each."""
    slope = 0.3 + 0.4 * np.cos(p[:, 0] / 50.0)
    across = np.stack([np.ones(len(p)), np.zeros(len(p)), slope], axis=1)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    circle = np.cos(ANGLE)[:, None] * across[:, None] + np.sin(ANGLE)[:, None] * np.array([0.0, 1.0, 0.0])
    parts = []
    for name in ("left", "right"):
        one = outlined_images(rig(0.0).camera(name).project, p, p[:, None] + 2.0 * circle)
        off = one.outline - one.outline.mean(axis=1, keepdims=True)
        a, b = (2.0 / SAMPLES * (off * wave(ANGLE)[:, None]).sum(axis=1) for wave in (np.cos, np.sin))
        S = a[:, :, None] * a[:, None] + b[:, :, None] * b[:, None]
        order = rng.permutation(np.flatnonzero(one.ok & (rng.uniform(size=len(p)) >= lost)))
        q = one.centroid[order] + SIGMA * rng.normal(size=(len(order), 2))
        parts.append((np.full(len(order), name), q, S[order], order))
    camera, q, S, disc = (np.concatenate(part) for part in zip(*parts, strict=True))
    names = [f"dot-{k}" for k in range(len(q))]
    covariance = np.tile(SIGMA**2 * np.eye(2), (len(q), 1, 1))
    pixels = NamedPixels(np.full(len(q), "v"), camera, names, q, covariance)
    return MarkPixels(pixels, S, np.full(len(q), np.nan), np.ones(len(q), dtype=bool)), disc


def outcome(found: MatchedDots, disc: np.ndarray) -> tuple[int, int]:
    """Return how many matches there are, and how many of them are of different discs."""
    of: dict[str, list[int]] = defaultdict(list)
    for name, number in zip(found.marks.pixels.point.tolist(), disc.tolist(), strict=True):
        of[name].append(number)
    pairs = [numbers for numbers in of.values() if len(numbers) > 1]
    return len(pairs), sum(len(set(numbers)) > 1 for numbers in pairs)


@pytest.mark.parametrize("seed", range(3))
def test_most_of_many_dots_are_matched_and_none_wrongly(seed: int) -> None:
    rng = np.random.default_rng(seed)
    marks, disc = seen(scattered(250, rng), rng)
    found = matched_dots(rig(0.03), marks)
    both = len(set(disc[marks.pixels.camera == "left"]) & set(disc[marks.pixels.camera == "right"]))
    matches, wrong = outcome(found, disc)
    assert wrong == 0
    assert both > 120
    assert matches > 0.85 * both
    alone = np.array(["dot-left" in name or "dot-right" in name for name in found.marks.pixels.point])
    assert found.ambiguous[~alone].sum() == 0
    assert found.ambiguous.sum() > 0


def test_a_calibration_that_is_worse_matches_fewer_and_none_wrongly() -> None:
    rng = np.random.default_rng(7)
    marks, disc = seen(scattered(250, rng), rng)
    good, poor = matched_dots(rig(0.03), marks), matched_dots(rig(0.5), marks)
    assert outcome(poor, disc)[1] == 0
    assert outcome(poor, disc)[0] < 0.8 * outcome(good, disc)[0]
    assert poor.ambiguous.sum() > 2 * good.ambiguous.sum()


def test_dots_in_rows_along_epipolar_lines_are_ambiguous() -> None:
    x, y = np.meshgrid(np.arange(-60.0, 61.0, 12.0), np.arange(-36.0, 37.0, 12.0))
    p = np.stack([x.ravel() + 60.0, y.ravel(), np.full(x.size, 600.0)], axis=1)
    marks, disc = seen(p, np.random.default_rng(0), lost=0.0)
    found = matched_dots(rig(0.3), marks)
    assert outcome(found, disc)[1] == 0
    assert found.ambiguous.mean() > 0.9


def test_a_dot_of_one_camera_alone_matches_nothing_and_other_marks_keep_their_names() -> None:
    rng = np.random.default_rng(2)
    marks, disc = seen(scattered(12, rng), rng, lost=0.0)
    kept = ~((disc == 3) & (marks.pixels.camera == "right"))
    pixels = marks.pixels.where(kept)
    is_plain = np.ones(len(pixels), dtype=bool)
    coded = int(np.flatnonzero(disc[kept] == 5)[0])
    names = pixels.point.astype("<U20")
    names[coded], is_plain[coded] = "ring-23-5", False
    pixels = NamedPixels(pixels.view, pixels.camera, names, pixels.position, pixels.covariance)
    found = matched_dots(
        rig(0.03), MarkPixels(pixels, marks.outline[kept], marks.diameter_mm[kept], is_plain)
    )
    point = found.marks.pixels.point
    assert point[coded] == "ring-23-5"
    (single,) = point[(disc[kept] == 3)].tolist()
    assert single.startswith("dot-left-")
    assert not found.ambiguous.any()
    assert outcome(found, disc[kept]) == (len(set(disc)) - 2, 0)
