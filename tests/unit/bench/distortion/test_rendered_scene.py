"""The scene of a rendered case: the family's own cameras, and a board that spans its volume."""

import numpy as np
import pytest

from labcal.bench.distortion.case import Case, Cell, Layout, Measured, Pictures, Source
from labcal.bench.distortion.measuring import measured_case
from labcal.bench.distortion.rendered_scene import rendered_scene
from labcal.bench.distortion.seeing_pixels import seeing_margin
from labcal.bench.families.registry import FAMILIES, family_by_name
from labcal.errors import DeviceError, LabcalError
from labcal.geometry.poses import transform
from labcal.scene.check import check_scene
from labcal.scene.views import planned_views
from labcal.shoot.manifest import Role

PICTURES = Pictures(views=4, spp=16)


def cell_of(family: str, strength: float) -> Cell:
    return Cell(family, strength, 0.0, 520, Layout.PLANES, Source.RENDERED)


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("strength", [0.0, 0.7])
def test_the_pictured_cameras_are_those_that_are_simulated(family: str, strength: float) -> None:
    pictured = rendered_scene(cell_of(family, strength), PICTURES, 5).true_cameras().values()
    pair = family_by_name(family).pair(strength, 5)
    if (family, strength) != ("prescription", 0.7):
        assert tuple(pictured) == pair
        return
    p = family_by_name(family).volume(strength).planes()
    margin = seeing_margin(pair)
    assert (margin > 0.0).all()
    for camera, whole in zip(pictured, pair, strict=True):
        assert whole.share_without_rays > 0.0
        np.testing.assert_allclose(camera.project(p).q + margin, whole.project(p).q, rtol=0, atol=1e-9)
        assert camera.in_picture(camera.project(p).q).all()


@pytest.mark.parametrize("family", FAMILIES)
def test_the_laboratory_renders_every_family_at_its_strongest(family: str) -> None:
    check_scene(rendered_scene(cell_of(family, 1.0), PICTURES, 0), 0)


@pytest.mark.parametrize("family", ["brown", "fisheye", "double-sphere", "wavy-pane", "water"])
def test_the_board_spans_the_volume_and_the_cameras_see_it(family: str) -> None:
    scene = rendered_scene(cell_of(family, 0.8), PICTURES, 0)
    check_scene(scene, 0)
    dots = {
        view.name: (view.role, transform(view.T_world_target, scene.target.points()))
        for view in planned_views(scene, 0)
    }
    trained = np.concatenate([p for role, p in dots.values() if role is Role.TRAIN])
    volume = family_by_name(family).volume(0.8)
    np.testing.assert_allclose([trained.min(axis=0), trained.max(axis=0)], [volume.low, volume.high])
    between = sorted({p[0, 2] for role, p in dots.values() if role is Role.TEST})
    np.testing.assert_allclose(between, np.array([1.0, 3.0, 5.0]) / 6.0 * volume.high[2])


def test_cameras_that_cannot_be_rendered_are_a_line_with_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("labcal.bench.distortion.seeing_pixels.cut", lambda camera, _margin: camera)
    case = Case(cell_of("double-sphere", 1.0), 0, ("dlt",), (Measured.WITHIN,), 50, pictures=PICTURES)
    found = measured_case(case)
    assert found.methods == ()
    assert found.reason == "The lens 'double-sphere' sees no direction around the middle of its picture."


def test_the_want_of_a_renderer_is_no_property_of_the_case(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its line would be kept, and another machine would not try again."""

    def refuse(_case: Case, _pictures: Pictures) -> LabcalError:
        raise DeviceError("no LLVM")

    monkeypatch.setattr("labcal.bench.distortion.measuring.rendered_data", refuse)
    case = Case(cell_of("brown", 1.0), 0, ("dlt",), (Measured.WITHIN,), 50, pictures=PICTURES)
    with pytest.raises(DeviceError, match="no LLVM"):
        measured_case(case)
