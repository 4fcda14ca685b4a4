"""Lenses that are not OpenCV's, or have its coefficients in another order, are not taken for OpenCV's."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.lens_start import camera_as_lens
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import resect
from labcal.cameras.camera import Camera
from labcal.cameras.ideal import ideal_camera
from labcal.cameras.interop.exchange import Home, ReadOptions
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.interop.rig_files import read_rig_files, write_rig_files
from labcal.cameras.lens import LENSES
from labcal.cameras.opencv_model import PERSPECTIVE
from labcal.cameras.paper import paper_camera
from labcal.cameras.perspective import Perspective
from labcal.cameras.remapping import source_pixels
from labcal.cameras.rig import Rig
from labcal.cameras.window import FlatWindow
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.render.camera_rays import _fall_off
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
FOREIGN = [name for name in FORMATS if name != "labcal"]


@dataclass(frozen=True)
class MadeUp(Perspective):
    """k1 and k2 under names that OpenCV does not have, and with a fall-off that nobody knows."""

    opencv = None
    fall_off = None
    names = ("first", "second")


@dataclass(frozen=True)
class Turned(Perspective):
    """Brown's k3, k1, p2, p1, k2, in this order."""

    names = ("k3", "k1", "p2", "p1", "k2")

    def formula(self, m, dist):  # noqa: ANN001, ANN201 -- as the protocol has it
        return super().formula(m, in_opencvs_order(dist))

    def forward_parameters(self, m, dist):  # noqa: ANN001, ANN201 -- as the protocol has it
        return super().forward_parameters(m, in_opencvs_order(dist))

    def parameters(self, m, dist, reach):  # noqa: ANN001, ANN201 -- as the protocol has it
        forward = Perspective.forward_parameters(self, m, in_opencvs_order(dist))
        whole = Perspective("brown5", 5).parameters(m, in_opencvs_order(dist), reach)
        return (*forward, *whole[len(forward) :])


def in_opencvs_order(dist: tuple) -> tuple:
    k3, k1, p2, p1, k2, *rest = dist
    return (k1, k2, p1, p2, k3, *rest)


@pytest.fixture(autouse=True)
def registered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(LENSES, "made-up", MadeUp("made-up", 2))
    monkeypatch.setitem(LENSES, "turned", Turned("turned", 5))


@pytest.fixture
def made_up(pair: dict[str, Camera]) -> dict[str, Camera]:
    dist = np.array([-0.3, 0.09, 0.0, 0.0, 0.0])
    return {name: replace(camera, lens="made-up", dist=dist) for name, camera in pair.items()}


def turned(camera: Camera) -> Camera:
    k1, k2, p1, p2, k3 = camera.dist
    return replace(camera, lens="turned", dist=np.array([k3, k1, p2, p1, k2]))


@pytest.mark.parametrize("name", FOREIGN)
def test_formats_refuse_a_lens_that_is_none_of_opencvs(name: str, made_up: dict[str, Camera]) -> None:
    chosen = FORMATS[name]
    with pytest.raises(InputError, match=r"cannot hold the lens 'made-up' of camera 'left'.*brown5"):
        chosen.write(Rig.of(made_up), chosen.suffixes[0])


@pytest.mark.parametrize("name", FOREIGN)
def test_formats_refuse_a_window(name: str, pair: dict[str, Camera]) -> None:
    behind = replace(pair["left"], window=FlatWindow(distance_mm=50.0))
    chosen = FORMATS[name]
    with pytest.raises(InputError, match="cannot hold the window of camera 'left'"):
        chosen.write(Rig.of({"left": behind}), chosen.suffixes[0])


@pytest.mark.parametrize("name", FOREIGN)
def test_formats_write_coefficients_in_opencvs_order(
    name: str, pair: dict[str, Camera], tmp_path: Path
) -> None:
    """Kalibr has no place for k3, which is 0 in the left camera only."""
    cameras = {"left": pair["left"]} if name == "kalibr" else pair
    chosen = FORMATS[name]
    texts = chosen.write(Rig.of({key: turned(one) for key, one in cameras.items()}), chosen.suffixes[0])
    in_folder = chosen.home is Home.FOLDER
    path = tmp_path / ("model" if in_folder else f"rig{chosen.suffixes[0]}")
    files = write_rig_files(path, chosen, texts, force=False)
    given = ReadOptions(size=(640, 480) if name == "matchid" else None)
    _, read = read_rig_files([path] if in_folder else files, name, given)
    for found, camera in zip(read.rig.cameras.values(), cameras.values(), strict=True):
        assert found.lens == "brown5"
        np.testing.assert_array_equal(found.dist, camera.dist)


def test_labcals_own_files_hold_both(pair: dict[str, Camera], made_up: dict[str, Camera]) -> None:
    for cameras in (made_up, {name: turned(camera) for name, camera in pair.items()}):
        rig = Rig.of(cameras)
        assert Rig.model_validate_json(FORMATS["labcal"].write(rig, ".json").files[0].text) == rig


def test_a_fall_off_that_is_not_known_is_refused(pair: dict[str, Camera], made_up: dict[str, Camera]) -> None:
    with pytest.raises(InputError, match=r"lens 'made-up' is not known.*photometry.fall_off=false"):
        _fall_off(made_up["left"], None)
    assert _fall_off(turned(pair["left"]), None) == _fall_off(pair["left"], None)


def test_maps_are_those_of_the_rays(pair: dict[str, Camera]) -> None:
    camera = pair["left"]
    same = turned(camera)
    expected = source_pixels(camera, ideal_camera(camera), None)
    np.testing.assert_allclose(source_pixels(same, ideal_camera(same), None), expected, atol=1e-3)


def test_a_rig_to_start_from_keeps_its_lens(pair: dict[str, Camera], made_up: dict[str, Camera]) -> None:
    camera = pair["right"]
    wider = camera_as_lens(turned(camera), "rational8", "right")
    np.testing.assert_array_equal(wider.dist, [*camera.dist, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(camera_as_lens(camera, "turned", "right").dist, turned(camera).dist)
    for known, lens in ((made_up["left"], "brown5"), (camera, "made-up"), (turned(camera), "brown-k1k2")):
        with pytest.raises(InputError, match="cannot start"):
            camera_as_lens(known, lens, "right")


@pytest.mark.parametrize("lens", ["made-up", "turned"])
def test_both_are_calibrated(
    see: See, pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray], lens: str
) -> None:
    """Without OpenCV's order nothing begins with OpenCV's coefficients."""
    if lens == "made-up":
        pair = {
            name: replace(camera, lens="brown-k1k2", dist=np.array([*camera.dist[:2], 0.0, 0.0, 0.0]))
            for name, camera in pair.items()
        }
    found = calibrate_handheld(see(pair, grid, poses), grid, lens, HandheldSettings(eccentricity_rounds=0))
    for name, camera in pair.items():
        record = found.rig.camera(name)
        np.testing.assert_allclose(record.K, camera.K, atol=0.02)
        meant = turned(camera).dist if lens == "turned" else camera.dist
        np.testing.assert_allclose(record.dist, meant, atol=1e-3)
        assert found.fits[name].undetermined == ()


@pytest.mark.parametrize("lens", ["made-up", "turned"])
def test_both_are_resected(pair: dict[str, Camera], lens: str) -> None:
    camera = pair["left"]
    if lens == "made-up":
        camera = replace(camera, lens="brown-k1k2", dist=np.array([-0.3, 0.09, 0.0, 0.0, 0.0]))
    random = np.random.default_rng(4)
    rays = camera.rays(random.uniform([0.0, 0.0], camera.size, (200, 2)))
    p = rays.origin + random.uniform(800.0, 1500.0, (200, 1)) * rays.direction
    found = resect("bundle", camera.project(p).q, p, camera_of_lens(lens, camera.size, None)).camera
    meant = turned(camera).dist if lens == "turned" else camera.dist
    np.testing.assert_allclose(found.dist, meant, atol=1e-3)


def test_the_papers_camera_is_a_pinhole_and_nothing_like_it(pair: dict[str, Camera]) -> None:
    """A fisheye without coefficients is equidistant, and a window bends rays."""
    K, none = np.diag([700.0, 700.0, 1.0]), np.zeros(5)
    plain = replace(pair["left"], K=K, dist=none, lens="pinhole")
    paper_camera(plain, 0.01)
    for other in (replace(plain, lens="fisheye-kb4"), replace(plain, window=FlatWindow(distance_mm=50.0))):
        with pytest.raises(InputError, match="no lens distortion"):
            paper_camera(other, 0.01)


def test_what_every_lens_declares_fits_together() -> None:
    for lens in LENSES.values():
        assert len(lens.names) == lens.coefficients
        if lens.opencv is not None:
            assert set(lens.names) <= set(lens.opencv.order)
    assert LENSES["tilted14"].names == PERSPECTIVE.order
