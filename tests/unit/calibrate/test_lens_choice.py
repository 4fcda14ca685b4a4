"""The lens model is chosen by views that it was not fitted to."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.calibrate import lens_choice
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.lens_choice import LensChoice, choose_lens
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.run.progress import NoProgress
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
NOISE_PX = 0.05


@pytest.fixture
def measured(
    see: See, pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]
) -> Callable[[str, list[float]], Detections]:
    """Return what makes noisy dots of one camera with a lens."""

    def measure(lens: str, dist: list[float]) -> Detections:
        camera = replace(pair["left"], lens=lens, dist=np.array(dist))
        exact = see({"only": camera}, grid, poses)
        noise = NOISE_PX * np.random.default_rng(11).normal(size=exact.position.shape)
        return replace(exact, position=exact.position + noise)

    return measure


def chosen(detections: Detections, grid: DotGrid) -> LensChoice:
    return choose_lens(detections, grid, HandheldSettings(eccentricity_rounds=0), NoProgress())


@pytest.mark.parametrize(
    ("lens", "dist"),
    [
        ("pinhole", [0.0, 0.0, 0.0, 0.0, 0.0]),
        ("brown-k1k2", [-0.3, 0.09, 0.0, 0.0, 0.0]),
        ("brown5", [-0.3, 0.09, 5e-3, -4e-3, 0.0]),
    ],
)
def test_the_simplest_that_suits_is_chosen(
    lens: str, dist: list[float], measured: Callable[..., Detections], grid: DotGrid
) -> None:
    choice = chosen(measured(lens, dist), grid)
    assert choice.lens == lens
    trials = {trial.lens: trial for trial in choice.trials}
    # Poses take up 6 of the 40 numbers of a picture with 20 dots.
    assert trials[lens].held_out_px == pytest.approx(NOISE_PX * np.sqrt(2 * 34 / 40), rel=0.15)
    assert trials["rational8"].refused is not None
    assert "do not determine its coefficients k4" in trials["rational8"].refused
    assert "thin-prism12" not in trials  # of eight views


def test_a_fisheye_is_told_from_a_lens_that_is_none(centroids: See, grid: DotGrid) -> None:
    K = np.array([[260.0, 0.0, 322.4], [0.0, 260.0, 237.1], [0.0, 0.0, 1.0]])
    true = Camera(K, "fisheye-kb4", np.array([-0.04, 0.01, -0.006, 0.001, 0.0]), np.eye(4), (640, 480))
    random = np.random.default_rng(31)
    poses = {}
    for number in range(8):
        T = np.eye(4)
        tilt = 0.5 * np.array([np.cos(number), np.sin(number)])
        a, b = tilt
        R = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
        R = R @ np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ R
        T[:3, 3] = random.uniform([-35, -25, 60], [35, 25, 90]) - T[:3, :3] @ grid.points().mean(axis=0)
        poses[f"pose-{number}"] = T
    exact = centroids({"only": true}, grid, poses)
    noise = 0.03 * random.normal(size=exact.position.shape)
    choice = choose_lens(
        replace(exact, position=exact.position + noise),
        grid,
        HandheldSettings(eccentricity_rounds=1),
        NoProgress(),
    )
    assert choice.lens == "fisheye-kb4"
    simple = {trial.lens: trial for trial in choice.trials}["brown-k1k2"]
    assert not simple.as_good


def test_what_a_lens_leaves_open_is_told(measured: Callable[..., Detections], grid: DotGrid) -> None:
    dots = measured("brown-k1k2", [-0.3, 0.09, 0.0, 0.0, 0.0])
    settings = HandheldSettings(eccentricity_rounds=0)
    assert calibrate_handheld(dots, grid, "brown5", settings).fits["only"].undetermined == ()
    left_open = calibrate_handheld(dots, grid, "rational8", settings).fits["only"].undetermined
    assert {"k4", "k5"} <= set(left_open)
    assert not {"k1", "k2", "p1", "p2"} & set(left_open)


def test_few_views_choose_nothing(measured: Callable[..., Detections], grid: DotGrid) -> None:
    dots = measured("pinhole", [0.0, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(InputError, match="4 usable views, but to choose a lens model needs 5"):
        chosen(dots.where(np.isin(dots.view, [f"pose-{number}" for number in range(4)])), grid)


def test_lenses_are_compared_with_free_dots_where_these_will_be_freed(
    measured: Callable[..., Detections],
    grid: DotGrid,
    poses: dict[str, np.ndarray],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(lens_choice, "OF_VIEWS", ("pinhole", "brown-k1k2"))
    dots = measured("brown-k1k2", [-0.3, 0.09, 0.0, 0.0, 0.0])
    off = 0.2 * np.random.default_rng(4).normal(size=(grid.count, 2))  # mm on the print, about 0.5 px
    number = dots.index[:, 1] * grid.cols + dots.index[:, 0]
    scale = 700.0 / np.array([T[2, 3] for T in poses.values()]).mean()
    shift = np.zeros_like(dots.position)
    for view, T in poses.items():
        rows = dots.view == view
        shift[rows] = scale * off[number[rows]] @ T[:2, :2].T
    uneven = replace(dots, position=dots.position + shift)
    held, freed = (
        choose_lens(uneven, grid, HandheldSettings(eccentricity_rounds=0, dot_places=places), NoProgress())
        for places in ("declared", "freed")
    )
    flat = {trial.lens: trial.held_out_px for trial in held.trials}
    free = {trial.lens: trial.held_out_px for trial in freed.trials}
    assert freed.lens == "brown-k1k2"
    assert free["brown-k1k2"] < 0.5 * flat["brown-k1k2"]
