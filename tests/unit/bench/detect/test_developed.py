import numpy as np
import pytest

from labcal.bench.detect.developed import (
    KINDS,
    NOISES,
    PictureKind,
    covariance_checks,
    covariance_figures,
    taken_picture,
)
from labcal.render.sensor_response import Shot

SHOT = Shot(1, "developed", "draw 0")


def drawn(n: int, scale: float) -> tuple[np.ndarray, np.ndarray]:
    covariance = np.array([[4e-5, 1e-5], [1e-5, 2e-5]])
    errors = scale * np.random.default_rng(2).multivariate_normal([0.0, 0.0], covariance, n)
    return errors, np.tile(covariance, (n, 1, 1))


@pytest.mark.parametrize(("scale", "ok"), [(1.0, True), (1.3, False), (0.7, False)])
def test_errors_should_be_as_large_as_stated(scale: float, *, ok: bool) -> None:
    (check,) = covariance_checks("dots", *drawn(2000, scale))
    assert check.ok is ok


def test_no_dot_is_no_success() -> None:
    assert not covariance_checks("dots", np.empty((0, 2)), np.empty((0, 2, 2)))[0].ok


def test_figures_tell_errors_what_is_stated_and_how_both_compare() -> None:
    rms, stated, share, off = (figure.value for figure in covariance_figures("dots", *drawn(4000, 1.0)))
    assert abs(rms / stated - 1.0) < 0.05
    assert abs(stated - np.sqrt(3e-5)) < 1e-12
    assert abs(share - 0.95) < 0.02
    assert off < 3.3


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_pictures_are_of_their_kind(kind: PictureKind) -> None:
    light = np.tile(np.linspace(0.1, 0.7, 64, dtype=np.float32), (48, 1))
    clean, usual, strong = (taken_picture(light, kind, noise, SHOT).astype(float) for noise in NOISES)
    # Of a lossy file in colour the luma is measured.
    assert clean.shape == ((48, 64, 3) if kind.bayer and kind.jpeg_quality is None else (48, 64))
    assert np.std(usual - clean) < 0.4 * np.std(strong - clean)
    grey = taken_picture(light, KINDS[0], NOISES[0], SHOT)
    seen = clean.mean(axis=2) if clean.ndim == 3 else clean
    assert np.abs(seen - grey).mean() < 3.0
