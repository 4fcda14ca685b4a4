"""Tone curves against figures worked out by hand from the standards, and what undoing one does to a dot."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ndtr

from labcal.detect.edge_fit import fit_edges
from labcal.detect.outlines.outlines import Outlines
from labcal.errors import InputError
from labcal.shoot.tone_curve import ToneCurve, find_tone_curve, light, tone, undone


@pytest.mark.parametrize(
    ("curve", "linear", "expected"),
    [
        # IEC 61966-2-1 and ITU-R BT.709-6, worked out by hand.
        (ToneCurve.SRGB, [0.0, 0.002, 0.0031308, 0.18, 1.0], [0.0, 0.02584, 0.040450, 0.461356, 1.0]),
        (ToneCurve.REC709, [0.0, 0.01, 0.018, 0.18, 1.0], [0.0, 0.045, 0.0812, 0.409008, 1.0]),
        (ToneCurve.GAMMA22, [0.0, 0.18, 0.5, 1.0], [0.0, 0.458656, 0.729740, 1.0]),
        (ToneCurve.LINEAR, [0.0, 0.3, 1.0], [0.0, 0.3, 1.0]),
    ],
)
def test_curves_are_those_of_the_standards_and_are_undone(
    curve: ToneCurve, linear: list[float], expected: list[float]
) -> None:
    tolerance = 1e-4 if curve == "rec709" else 2e-6
    np.testing.assert_allclose(tone(np.array(linear), curve), expected, atol=tolerance)
    every = np.linspace(0.0, 1.0, 1001)
    np.testing.assert_allclose(
        light(tone(every, curve), curve), every, atol=1e-4 if curve == "rec709" else 1e-7
    )


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_a_picture_keeps_its_range_and_light_is_left_alone(kind: type[np.uint8] | type[np.uint16]) -> None:
    top = np.iinfo(kind).max
    picture = np.array([[0, top // 2, top]], dtype=kind)
    found = undone(picture, ToneCurve.GAMMA22)
    np.testing.assert_allclose(found, [[0.0, top * (top // 2 / top) ** 2.2, top]], rtol=1e-6)
    exr = found / top
    assert undone(exr, ToneCurve.GAMMA22) is exr


def s_curve(value: np.ndarray) -> np.ndarray:
    """Contrast as a camera's picture style adds it."""
    return value * value * (3.0 - 2.0 * value)


@pytest.fixture
def write_s_curve(tmp_path: Path) -> Callable[[], str]:
    def write() -> str:
        shone = np.linspace(0.0, 1.0, 33)
        lines = [f"{value},{one}" for value, one in zip(s_curve(shone).tolist(), shone.tolist(), strict=True)]
        path = tmp_path / "camera.csv"
        path.write_text("\n".join(["value,light", *lines, ""]))
        return str(path)

    return write


def test_a_measured_curve_takes_off_the_shift_it_makes_in_uneven_light(
    write_s_curve: Callable[[], str],
) -> None:
    fine, side, radius = 5, 90, 30.0
    k = (np.arange(side * fine) + 0.5) / fine - 0.5
    x, y = np.meshgrid(k, k)
    centre = np.array([44.3, 44.8])
    inside = ndtr((radius - np.hypot(x - centre[0], y - centre[1])) / 0.7)
    shone = (0.8 - 0.75 * inside) * np.exp(-0.6 * x / side)
    shone = shone.reshape(side, fine, side, fine).mean((1, 3))
    picture = np.rint(65535.0 * s_curve(shone)).astype(np.uint16)
    start = Outlines(centre[None] + 0.2, np.eye(2)[None] * radius**2, np.zeros(1), np.ones(1))

    def off(values: np.ndarray) -> float:
        found = fit_edges(values.astype(np.float32), start, np.zeros(1), 1.4)
        return float(np.linalg.norm(found.centre[0] - centre))

    assert off(picture) > 0.015
    assert off(undone(picture, find_tone_curve(write_s_curve()))) < 0.002


@pytest.mark.parametrize(
    "text",
    [
        "value,light\n0,0\n1,1\n",
        "value,light\n0,0\n0.5,nan\n1,1\n",
        "value,light\n0,0\n0.5,0.4\n0.4,0.6\n1,1\n",
        "value,light\n0,0\n128,0.4\n255,1\n",
        "value,light\n0,0\nhalf,0.4\n1,1\n",
        "light,value\n0,0\n0.5,0.4\n1,1\n",
        "value,light\n0,0\n1e-300,0.5\n1,1\n",
    ],
)
def test_a_curve_that_cannot_be_undone_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "curve.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=r"curve\.csv"):
        find_tone_curve(str(path))


def test_an_unknown_curve_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(InputError, match=r"Did you mean 'srgb'\?"):
        find_tone_curve("sgrb")
