"""Rendered light against the light that is computed without a renderer."""

import numpy as np
import pytest

from labcal.geometry.poses import inverse, transform
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.laboratory import Laboratory
from labcal.render.variant import COLOUR, MONO, renderer
from labcal.scene.catalogue import load_scene
from labcal.scene.lighting import irradiance
from labcal.scene.model import Scene
from labcal.scene.plan import planned_takes
from labcal.scene.surface import Surface
from labcal.scene.views import planned_views

SMALL = (
    "cameras.left.size=[40, 30]", "cameras.left.focal_px=44", "cameras.left.principal_px=null",
    "photometry.bayer=off", "photometry.fall_off=off", "photometry.blur_px=0",
    "board.dark=[0.8, 0.8, 0.8]", "board.light=[0.8, 0.8, 0.8]",
)  # fmt: skip
AIM = "look_at_mm: [1000, 1000, 200]"
PANEL = f"{{centre_mm: [200, 400, 1900], {AIM}, size_mm: [300, 200], radiance: 9}}"
RING = (
    f"{{kind: ring, centre_mm: [720, 640, 1900], {AIM}, inner_diameter_mm: 200, outer_diameter_mm: 420, "
    "radiance: 3}"
)
SPOT = f"{{kind: spot, centre_mm: [700, 500, 2000], {AIM}, intensity: 1e6, cutoff_deg: 20, beam_deg: 5}}"
AMBIENT = "{kind: ambient, radiance: 2}"


def rendered(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a first view's light in the left camera, which pixels show the board alone, and where."""
    view, camera = planned_views(scene, 0)[0], scene.true_cameras()["left"]
    with renderer(COLOUR if scene.photometry.bayer else MONO) as mi:
        take = planned_takes(scene, (view,), 0).takes[0]
        light = render_light(Laboratories(mi, scene, 0), Case(take, 0))
    u, v = np.meshgrid(np.arange(camera.size[0]), np.arange(camera.size[1]))
    rays = camera.rays(np.stack([u, v], axis=-1).astype(np.float64))
    T_target_world = inverse(view.T_world_target)
    origin, way = transform(T_target_world, rays.origin), rays.direction @ T_target_world[:3, :3].T
    place = origin - (origin[..., 2] / way[..., 2])[..., None] * way
    surface = Surface.of(scene.target, scene.board.bend)
    on_board = (np.abs(place[..., :2] - surface.middle) < surface.half - 60.0).all(axis=-1)
    return light, on_board, transform(view.T_world_target, place)


@pytest.mark.parametrize("lamps", [[PANEL], [RING], [SPOT], [PANEL, SPOT, AMBIENT.replace("2", "0.03")]])
def test_lamps_light_the_board_as_computed(lamps: list[str]) -> None:
    scene = load_scene("webcam-plane", (*SMALL, f"lamps=[{', '.join(lamps)}]", "spp=256"))
    light, on_board, place = rendered(scene)
    normal = np.array([0.0, 0.0, 1.0])
    expected = sum(irradiance(lamp, place[on_board], normal) for lamp in scene.lamps) * 0.8 / np.pi
    ratio = light[on_board] / np.asarray(expected)
    assert on_board.sum() > 200
    assert np.ptp(expected) > 0.1 * np.mean(expected)  # else a constant would do
    # Noise of 256 rays is 0.9% of a pixel at most, of which 0.05% is left in the mean.
    assert ratio.std() < 0.015
    assert abs(ratio.mean() - 1.0) < 2e-3


def test_a_spotlight_has_no_noise_and_ends_at_its_cutoff() -> None:
    scene = load_scene(
        "webcam-plane", (*SMALL, f"lamps=[{SPOT.replace('cutoff_deg: 20', 'cutoff_deg: 9')}]", "spp=64")
    )
    light, on_board, place = rendered(scene)
    computed = irradiance(scene.lamps[0], place[on_board], np.array([0.0, 0.0, 1.0])) * 0.8 / np.pi
    assert (computed == 0.0).sum() > 20
    assert (computed > 0.0).sum() > 100
    np.testing.assert_allclose(
        light[on_board], computed, rtol=0, atol=0.04 * computed.max()
    )  # a pixel has a size


def test_light_from_everywhere_is_reflectance_times_radiance_without_noise() -> None:
    scene = load_scene("webcam-plane", (*SMALL, f"lamps=[{AMBIENT}]", "spp=4"))
    light, on_board, _ = rendered(scene)
    np.testing.assert_allclose(light[on_board], 2.0 * 0.8, rtol=1e-6)
    with renderer(MONO) as mi:
        laboratory = Laboratory(mi, scene, (40, 30), 0)
        assert laboratory.ambient == pytest.approx((2.0,))


def test_colours_of_lamp_and_board_multiply() -> None:
    overrides = (
        "photometry.bayer=on", "board.light=[0.8, 0.4, 0.2]", "board.dark=[0.8, 0.4, 0.2]", "spp=4",
        "lamps=[{kind: ambient, radiance: 2, colour: [0.25, 0.5, 1]}, "
        + SPOT.replace("beam_deg: 5", "beam_deg: 5, colour: [0.5, 1, 2]") + "]",
    )  # fmt: skip
    scene = load_scene("webcam-plane", (*SMALL, *overrides))
    light, on_board, place = rendered(scene)
    spot = irradiance(scene.lamps[1], place[on_board], np.array([0.0, 0.0, 1.0]))[:, None] / np.pi
    expected = (2.0 * np.array([0.25, 0.5, 1.0]) + spot * [0.5, 1.0, 2.0]) * [0.8, 0.4, 0.2]
    np.testing.assert_allclose(light[on_board], expected, rtol=0.02)


def test_gloss_adds_a_highlight_where_the_board_mirrors_the_lamp() -> None:
    lamp = f"{{centre_mm: [1200, 1300, 1900], {AIM}, size_mm: [100, 100], radiance: 9}}"
    common = (
        *SMALL,
        "board.dark=[0.1, 0.1, 0.1]",
        "board.light=[0.1, 0.1, 0.1]",
        f"lamps=[{lamp}]",
        "spp=64",
    )
    matt, on_board, place = rendered(load_scene("webcam-plane", common))
    gloss, _, _ = rendered(load_scene("webcam-plane", (*common, "board.gloss_roughness=0.05")))
    gain = np.divide(gloss, matt, out=np.zeros_like(matt), where=on_board)
    brightest = place[np.unravel_index(gain.argmax(), gain.shape)]
    eye, mirrored = np.array([720.0, 640.0, 1850.0]), np.array([1200.0, 1300.0, 200.0 - 1700.0])
    share = (eye[2] - 200.0) / (eye[2] - mirrored[2])
    np.testing.assert_allclose(brightest, eye + share * (mirrored - eye), atol=50.0)  # two pixels
    assert gain.max() > 5.0 * np.median(gain[on_board])
    assert gain[on_board].min() < 1.1
