"""Settings of detection: documented, checked, reached by name, and with the effect that they state."""

import pickle
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.correspond.measure import measure_pictures
from labcal.correspond.sources import Source
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.settings import DetectSettings, describe_settings, detect_settings
from labcal.detect.stage_settings.setting import UNITS
from labcal.errors import InputError, UnknownNameError
from labcal.run.executor import open_executor
from labcal.targets.catalogue import load_target

TARGET = load_target("paper-13x10")


@pytest.fixture(scope="module")
def picture() -> np.ndarray:
    """A drawn picture of the whole target: sheared, noisy, with grey edges."""
    rng = np.random.default_rng(2)
    fine, size = 4, (600, 480)
    big = np.full((size[1] * fine, size[0] * fine), 210.0, np.float32)
    for col, row in TARGET.indices():
        x, y = (40 + 40 * col + 3 * row) * fine, (440 - 42 * row - 2 * col) * fine
        cv2.circle(big, (int(x), int(y)), 11 * fine, 30.0, -1, cv2.LINE_AA)
        if (int(col), int(row)) in TARGET.ring_indices:
            cv2.circle(big, (int(x), int(y)), 5 * fine, 210.0, -1, cv2.LINE_AA)
    grey = cv2.GaussianBlur(big, (0, 0), 0.7 * fine).reshape(size[1], fine, size[0], fine).mean((1, 3))
    return np.clip(np.round(grey + rng.normal(0, 1.0, grey.shape)), 0, 255).astype(np.uint8)


def found(picture: np.ndarray, *words: str) -> PictureDots:
    return detect_dots(picture, TARGET, detect_settings([f"detect.{word}" for word in words]))


def same(a: PictureDots, b: PictureDots) -> bool:
    return a.flag == b.flag and a.position.tobytes() + a.covariance.tobytes() == (
        b.position.tobytes() + b.covariance.tobytes()
    )


def test_every_setting_is_described_with_unit_bounds_and_effect() -> None:
    settings = describe_settings()
    assert len({setting.name for setting in settings}) == len(settings) > 150
    for setting in settings:
        assert len(setting.description) > 20, setting.name
        assert any(f"{word}: " in setting.description for word in ("Larger", "More")), setting.name
        low, _, high = setting.bounds.partition(" to ")
        assert low, setting.name
        assert high, setting.name
        counts = setting.default if isinstance(setting.default, tuple) else (setting.default,)
        assert setting.unit in UNITS.values() or all(isinstance(count, int) for count in counts), setting.name


def test_defaults_lie_within_their_bounds_and_come_back_from_text() -> None:
    words = [
        f"{setting.name}={','.join(map(repr, setting.default))}"
        if isinstance(setting.default, tuple)
        else f"{setting.name}={setting.default!r}"
        for setting in describe_settings()
    ]
    assert detect_settings(words) == DetectSettings()
    assert detect_settings(words).changes() == ()


def test_settings_given_as_text_are_those_given_in_python() -> None:
    by_text = detect_settings(["detect.edge.max_iterations=7", "detect.grid.fisheye_fields_deg=120,160"])
    by_name = DetectSettings(edge={"max_iterations": 7}, grid={"fisheye_fields_deg": (120.0, 160.0)})
    assert by_text == by_name
    assert by_text.changes() == (
        "detect.grid.fisheye_fields_deg=120.0,160.0",
        "detect.edge.max_iterations=7",
    )
    assert detect_settings(by_text.changes()) == by_text
    assert pickle.loads(pickle.dumps(by_text)) == by_text  # noqa: S301 -- our own


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("detect.edge.max_iterations", "NAME=value"),
        ("detect.edge.max_iterations=3.5", r"whole number \(2 to 1000; default 12\), not '3.5'"),
        ("detect.edge.max_iterations=1", "2 to 1000"),
        ("detect.edge.edge_px=wide", "a number .0 to 10; default 0.3., not 'wide'"),
        ("detect.edge.edge_px=nan", "not 'nan'"),
        ("detect.grid.windows_nodes=2,3,5", "4 numbers with commas"),
        ("detect.grid.windows_nodes=2,3,5,99", "1 to 20 each"),
        ("detect.segmentation.min_ray_samples=65", "contradict each other: min_ray_samples"),
    ],
)
def test_a_bad_value_is_refused_with_what_was_expected(word: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        detect_settings([word])


@pytest.mark.parametrize(
    "name", ["detect.edge.max_iteration", "edge.max_iterations", "detect.edges.max_iterations"]
)
def test_an_unknown_name_is_refused_with_the_nearest(name: str) -> None:
    with pytest.raises(UnknownNameError, match=r"Did you mean 'detect\.edge\.max_iterations'"):
        detect_settings([f"{name}=3"])


def test_defaults_are_what_holds_where_no_settings_are_given(picture: np.ndarray) -> None:
    plain = detect_dots(picture, TARGET)
    assert plain.ok.sum() == TARGET.count
    assert same(plain, detect_dots(picture, TARGET, DetectSettings()))
    assert same(plain, found(picture, "edge.max_iterations=12"))


def test_fewer_steps_of_gauss_newton_settle_fewer_dots(picture: np.ndarray) -> None:
    exact = "edge.shift_tolerance_px=1e-6"
    few = found(picture, exact, "edge.max_iterations=2")
    enough = found(picture, exact)
    assert few.refusal is Refusal.NO_USABLE_DOTS
    assert few.flag.count(DotFlag.BAD_FIT) == TARGET.count
    assert enough.ok.sum() > 0.9 * TARGET.count


def test_a_smaller_limit_flags_more_dots(picture: np.ndarray) -> None:
    strict = found(picture, "quality.max_misfit_factor=1.01", "quality.min_noise_share=0")
    assert 0 < strict.ok.sum() < TARGET.count
    assert set(strict.flag) == {DotFlag.OK, DotFlag.BAD_FIT}
    soft = found(picture, "quality.max_blur_share=0.01")
    assert soft.refusal is Refusal.NO_USABLE_DOTS
    assert set(soft.flag) == {DotFlag.BLURRED}


def test_larger_least_sizes_and_contrasts_lose_the_dots(picture: np.ndarray) -> None:
    assert found(picture, "segmentation.min_outline_axis_px=40").refusal is Refusal.NO_DOTS
    assert found(picture, "segmentation.min_contrast_sigma=1000").refusal is Refusal.NO_DOTS
    assert found(picture, "grid.min_dots=200").refusal is Refusal.TOO_FEW_DOTS


def test_a_narrower_band_measures_with_larger_covariances(picture: np.ndarray) -> None:
    narrow = found(picture, "edge.edge_blurs=1.2", "edge.edge_px=0")
    wide = detect_dots(picture, TARGET)
    both = narrow.ok & wide.ok
    assert both.sum() > 0.8 * TARGET.count
    ratio = np.trace(narrow.covariance[both], axis1=1, axis2=2) / np.trace(
        wide.covariance[both], axis1=1, axis2=2
    )
    assert np.median(ratio) > 1.0


class Silent:
    def start(self, label: str, total: int, done: int = 0) -> None: ...

    def advance(self, steps: int = 1) -> None: ...


@pytest.fixture
def sources(picture: np.ndarray, tmp_path: Path) -> list[Source]:
    path = tmp_path / "one_left.png"
    cv2.imwrite(str(path), picture)
    return [Source(view, "left", str(path), None) for view in ("a", "b")]


def test_settings_reach_the_worker_processes(picture: np.ndarray, sources: list[Source]) -> None:
    settings = DetectSettings(quality={"max_blur_share": 0.01})
    with open_executor(2) as executor:
        results = measure_pictures(sources, TARGET, executor, Silent(), settings=settings)
    for result in results:
        assert result.dots is not None
        assert result.dots.refusal is Refusal.NO_USABLE_DOTS
        assert same(result.dots, detect_dots(picture, TARGET, settings))
