"""Plans of rigs: what they state, and what is refused."""

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal import examples, load_rig_plan
from labcal.errors import InputError, UnknownNameError
from labcal.geometry.poses import inverse, transform
from labcal.guide.rehearsal.catalogue import rig_plan_names
from labcal.guide.rehearsal.planned_camera import PlannedCamera
from labcal.guide.rehearsal.planned_rig import PlannedRig

PLAN = examples.rig_plan().model_dump(mode="json", exclude_none=True)


def refusal(tmp_path: Path, change: dict[str, Any], *left_out: str) -> str:
    """Return why a changed plan is refused."""
    content = {key: value for key, value in copy.deepcopy(PLAN).items() if key not in left_out} | change
    file = tmp_path / "plan.yaml"
    file.write_text(json.dumps(content), encoding="utf-8")  # which is YAML, too
    with pytest.raises(InputError) as caught:
        load_rig_plan(file)
    return str(caught.value)


CAMERA = {"size": [640, 480], "lens": "brown5"}


@pytest.mark.parametrize(
    ("change", "left_out", "words"),
    [
        ({"camera": CAMERA}, ("cameras",), "none of them is"),
        ({"camera": {**CAMERA, "fov_deg": 50, "focal_px": 500}}, ("cameras",), "keep one of them"),
        ({"camera": {**CAMERA, "focal_mm": 8}}, ("cameras",), "pixel_um belong together"),
        ({"camera": {**CAMERA, "focal_px": 500, "lens": "brwn5"}}, ("cameras",), "brown5"),
        ({"camera": {**CAMERA, "focal_px": 9, "lens": "telecentric"}}, ("cameras",), "parallel rays"),
        ({"camera": {**CAMERA, "fov_deg": 200}}, ("cameras",), "fisheye-kb4"),
        ({"camera": {**CAMERA, "fov_deg": 50}}, (), "keep one of them"),
        ({"cameras": {"one": {**CAMERA, "fov_deg": 50}}}, (), "2"),
        ({"geometry": {"kind": "pair", "baseline_mm": 0}}, (), "more than 0"),
        ({"geometry": {"kind": "places", "places": {}}}, (), "same cameras"),
        ({"volume": {"width_mm": 1, "height_mm": 1, "near_mm": 5, "far_mm": 4}}, (), "less than far_mm"),
        ({"target": "charuco-12x9"}, (), "grids of dots only"),
        ({"target": "rings-10x9"}, (), "rings-10x8"),
        ({"shoot": {"views": 2}}, (), "at least 3"),
        ({"photometry": "webcam-2001"}, (), "webcam-2000"),
        ({"print_sigma": 0.1}, (), "print_sigma_mm"),
    ],
)
def test_what_cannot_be_is_refused_with_its_mend(
    tmp_path: Path, change: dict[str, Any], left_out: tuple[str, ...], words: str
) -> None:
    assert words in refusal(tmp_path, change, *left_out)


def test_two_lens_models_are_refused(tmp_path: Path) -> None:
    left = {**CAMERA, "fov_deg": 50}
    said = refusal(tmp_path, {"cameras": {"left": left, "right": {**left, "lens": "brown-k1k2"}}})
    assert "brown-k1k2 and brown5" in said


def test_an_unknown_plan_offers_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="webcams"):
        load_rig_plan("webcam")


@pytest.mark.parametrize("lens", ["brown5", "fisheye-kb4"])
def test_the_field_of_view_spans_the_width(lens: str) -> None:
    planned = PlannedCamera(size=(1000, 500), fov_deg=90.0, lens=lens)
    camera = planned.described((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)).camera()
    edge = camera.rays(np.array([499.5 + 500.0, 249.5])).direction
    assert np.degrees(np.arctan2(edge[0], edge[2])) == pytest.approx(45.0)


def test_a_focal_length_in_mm_is_one_in_pixels() -> None:
    assert PlannedCamera(size=(100, 100), focal_mm=35.0, pixel_um=3.5).focal_length_px() == pytest.approx(1e4)


@pytest.mark.parametrize("name", rig_plan_names())
def test_a_shipped_plan_sees_its_volume(name: str) -> None:
    planned = PlannedRig.of(load_rig_plan(name))
    assert planned.seen(planned.grid).all()
    assert planned.plan.description


def test_the_frame_of_a_plan_lies_between_its_cameras() -> None:
    planned = PlannedRig.of(examples.rig_plan())
    T_plan_first = inverse(planned.T_first_plan)
    eyes = [transform(T_plan_first, camera.centre) for camera in planned.cameras]
    np.testing.assert_allclose(eyes, [[-75.0, 0.0, 0.0], [75.0, 0.0, 0.0]], atol=1e-9)
    on_axis = np.array([[0.0, 0.0, 500.0], [10.0, 0.0, 500.0]])
    # Both look at the point where their axes meet, and x points right in the picture.
    for camera in planned.cameras:
        q = camera.project(transform(planned.T_first_plan, on_axis)).q
        np.testing.assert_allclose(q[0], [319.5, 239.5], atol=1e-9)
        assert q[1, 0] > q[0, 0]
