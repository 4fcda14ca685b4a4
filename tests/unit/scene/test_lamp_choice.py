import numpy as np
import pytest

from labcal.scene.catalogue import load_scene
from labcal.scene.lamp_choice import lamp_choice_variance
from labcal.scene.lamps import Ambient, Panel
from labcal.scene.model import Scene


def _lit(*lamps: Panel | Ambient) -> Scene:
    return load_scene("still-handheld").model_copy(update={"lamps": lamps})


def _small(x: float, radiance: float) -> Panel:
    """Return a small lamp far away, so that the whole board has the same light of all of it."""
    return Panel(
        centre_mm=(x, 0.0, 1e6), look_at_mm=(0.0, 0.0, 0.0), size_mm=(100.0, 100.0), radiance=radiance
    )


def test_two_lamps_vary_by_their_difference_over_their_sum() -> None:
    assert lamp_choice_variance(_lit(_small(0.0, 1.0)), np.eye(4)) == pytest.approx(0.0, abs=1e-6)
    found = lamp_choice_variance(_lit(_small(-1e3, 1.0), _small(1e3, 3.0)), np.eye(4))
    assert found == pytest.approx((2.0 / 4.0) ** 2, rel=1e-3)


def test_light_from_everywhere_steadies_and_no_light_is_no_noise() -> None:
    assert lamp_choice_variance(_lit(Ambient(kind="ambient", radiance=1.0)), np.eye(4)) == 0.0
    behind = np.diag([1.0, -1.0, -1.0, 1.0])
    assert lamp_choice_variance(_lit(_small(0.0, 1.0)), behind) == 0.0
    lamps = (_small(-1e3, 1.0), _small(1e3, 3.0))
    of_lamps = 1e4 * 4.0 / 1e12 / np.pi  # radiance that a white board would send back
    found = lamp_choice_variance(_lit(*lamps, Ambient(kind="ambient", radiance=of_lamps)), np.eye(4))
    assert found == pytest.approx(0.25 / 4.0, rel=1e-3)
