import pytest

from labcal.errors import InputError
from labcal.scene.catalogue import load_scene
from labcal.scene.lamps import Ambient, Panel, Ring, Spot

AIMED = "centre_mm: [0, 0, 2000], look_at_mm: [1000, 1000, 200]"


def test_a_lamp_without_a_kind_is_a_panel() -> None:
    scene = load_scene("webcam-plane")
    assert [type(lamp) for lamp in scene.lamps] == [Panel, Panel, Ambient]
    kinds = [lamp["kind"] for lamp in scene.model_dump(mode="json")["lamps"]]
    assert kinds == ["panel", "panel", "ambient"]


@pytest.mark.parametrize(
    ("lamp", "kind"),
    [
        (f"{{{AIMED}, size_mm: [10, 10], radiance: 1}}", Panel),
        (f"{{kind: panel, {AIMED}, size_mm: [10, 10], radiance: 1}}", Panel),
        (f"{{kind: ring, {AIMED}, inner_diameter_mm: 50, outer_diameter_mm: 90, radiance: 1}}", Ring),
        (f"{{kind: spot, {AIMED}, intensity: 1e5, cutoff_deg: 20, beam_deg: 15}}", Spot),
        ("{kind: ambient, radiance: 1}", Ambient),
    ],
)
def test_the_kind_picks_the_lamp_and_survives_yaml(lamp: str, kind: type) -> None:
    scene = load_scene("webcam-plane", (f"lamps=[{lamp}]",))
    assert type(scene.lamps[0]) is kind
    assert load_scene("webcam-plane", (f"lamps=[{lamp}]",)) == scene


@pytest.mark.parametrize(
    ("lamp", "what"),
    [
        ("{kind: torch, radiance: 1}", "kind should be panel, ring, spot or ambient"),
        (f"{{{AIMED}, size_mm: [10, 10], radience: 1}}", "radiance"),
        (f"{{kind: ring, {AIMED}, inner_diameter_mm: 90, outer_diameter_mm: 90, radiance: 1}}", "smaller"),
        (f"{{kind: spot, {AIMED}, intensity: 1, cutoff_deg: 20, beam_deg: 20}}", "beam_deg must be smaller"),
        (f"{{kind: spot, {AIMED}, intensity: 0, cutoff_deg: 20, beam_deg: 10}}", "more than 0"),
        ("{kind: ambient, radiance: -1}", "more than 0"),
        ("{kind: ambient}", "radiance"),
    ],
)
def test_a_lamp_that_cannot_be_is_refused_by_name(lamp: str, what: str) -> None:
    with pytest.raises(InputError, match=what) as caught:
        load_scene("webcam-plane", (f"lamps=[{lamp}]",))
    assert "lamps.0" in str(caught.value)
