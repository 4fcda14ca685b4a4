import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.guide.target_design.cameras import described_camera, known_cameras
from labcal.guide.target_design.design import TargetDesign, _best, designed
from labcal.guide.target_design.forms import LEAST_AXIS_PX, MOST_DOTS, farthest_mm, rings_among
from labcal.guide.target_design.question import TargetQuestion
from labcal.guide.target_design.room import fits_paper
from labcal.guide.target_design.sight import Sight
from labcal.guide.target_design.suitability import board_mm
from labcal.guide.target_design.trial import tried_views
from labcal.run.progress import NoProgress
from labcal.scene.photometry import Photometry
from labcal.targets.grid import DotGrid
from labcal.targets.paper import paper_of

WEBCAM, MACHINE = (Photometry.model_validate(name) for name in ("webcam-2000", "machine-vision-5mp"))


def camera(**description: object) -> Camera:
    return described_camera(description)


def small(**changes: object) -> TargetQuestion:
    question = TargetQuestion(
        {"left": camera(size=(640, 480), fov_deg=60)},
        near_mm=400.0,
        far_mm=600.0,
        photometry=WEBCAM,
        tilt_max_deg=40.0,
    )
    return replace(question, **changes)  # type: ignore[arg-type]


@cache
def small_design() -> TargetDesign:
    return designed(small())


def test_sight_of_a_pinhole_is_its_focal_length() -> None:
    sight = Sight.of(camera(size=(1280, 960), focal_px=1000, lens="pinhole"))
    assert sight.least_px_per_rad == pytest.approx(1000, rel=2e-3)
    assert sight.axis_px_per_rad == pytest.approx(1000, rel=1e-3)
    assert sight.width_mm(500.0) == pytest.approx((0.5 * 1279, 0.5 * 959), rel=1e-3)
    assert sight.px_per_mm(500.0, 60.0) == pytest.approx(1.0, rel=2e-3)


def test_sight_of_a_fisheye_is_its_least_scale() -> None:
    straight = camera(size=(1280, 960), focal_px=500, lens="fisheye-kb4")
    bent = camera(size=(1280, 960), focal_px=500, lens="fisheye-kb4", dist=(-0.05,))
    assert Sight.of(straight).least_px_per_rad == pytest.approx(500, rel=5e-3)
    assert Sight.of(bent).least_px_per_rad < 450


def test_a_design_has_the_least_dots_that_are_found_and_fits_its_paper() -> None:
    question, found = small(), small_design()
    target = found.target
    assert isinstance(target, DotGrid)
    assert fits_paper(target, question)
    scale = Sight.of(question.cameras["left"]).px_per_mm(farthest_mm(question, max(board_mm(target))), 40.0)
    assert found.least_px == pytest.approx(0.5 * target.dot_diameter_mm * scale)
    assert LEAST_AXIS_PX <= found.least_px < 1.1 * LEAST_AXIS_PX
    assert (2 * target.pitch_x_mm) % 1 == 0  # half mm
    assert all(view.passed for view in found.views)
    assert {(view.distance_mm, view.tilt_deg) for view in found.views} == {
        (distance, tilt) for distance in (400, 600) for tilt in (0, 30, 40)
    }
    far = next(view for view in found.views if (view.distance_mm, view.tilt_deg) == (600, 40))
    near = next(view for view in found.views if (view.distance_mm, view.tilt_deg) == (400, 0))
    assert far.size_px < near.size_px
    assert far.size_px > found.least_px - 0.2  # the middle of the board is nearer than its far edge


def test_other_pictures_have_the_errors_that_the_design_states() -> None:
    question, found = small(), small_design()
    again = tried_views(found.target, question, seed=7, progress=NoProgress())
    for stated, view in zip(found.views, again, strict=True):
        assert view.passed
        assert view.sigma_px < 1.3 * stated.sigma_px


@pytest.mark.parametrize("change", [{"far_mm": 700.0}, {"tilt_max_deg": 50.0}])
def test_harder_questions_get_larger_dots(change: dict[str, float]) -> None:
    asked = small(**change)
    easy, hard = small_design().target, _best(asked, [Sight.of(asked.cameras["left"])], 1.0)
    assert isinstance(easy, DotGrid)
    assert isinstance(hard, DotGrid)
    assert hard.dot_diameter_mm > easy.dot_diameter_mm


def test_the_design_is_better_than_what_ships_and_says_why_others_do_not_fit() -> None:
    question = TargetQuestion(
        {"left": camera(size=(1280, 960), fov_deg=65)},
        near_mm=400.0,
        far_mm=700.0,
        photometry=WEBCAM,
        tilt_max_deg=45.0,
    )
    found = designed(question)
    by_name = {one.target: one for one in found.shipped}
    assert by_name["webcam-a4"].fits
    assert 1.0 <= by_name["webcam-a4"].relative_error < 1.5
    assert found.shipped[0].fits
    assert any("too small" in reason for reason in by_name["rings-10x8"].reasons)
    assert any("needs a0" in reason for reason in by_name["paper-13x10"].reasons)
    assert any("kind charuco" in reason for reason in by_name["charuco-12x9"].reasons)
    assert math.isnan(by_name["rings-10x8"].relative_error)


def test_what_cannot_be_is_refused_with_what_would_do() -> None:
    with pytest.raises(InputError, match=r"tilt of at most 55.*distance of at most \d+ mm.*a3"):
        designed(small(tilt_max_deg=60.0))
    with pytest.raises(InputError, match="more pixels"):
        designed(small(near_mm=400.0, far_mm=90000.0, tilt_max_deg=0.0))
    for change in ({"near_mm": 700.0}, {"tilt_max_deg": 80.0}, {"kind": "chess"}, {"tiles": (0, 2)}):
        with pytest.raises(InputError):
            small(**change)


@pytest.mark.parametrize(
    ("cols", "rows", "reach"), [(5, 4, 9.0), (8, 8, 9.0), (24, 30, 50.0), (24, 30, 3.5), (4, 5, 2.0)]
)
def test_rings_lie_in_the_grid_and_tell_their_axes(cols: int, rows: int, reach: float) -> None:
    rings = rings_among(cols, rows, reach)
    assert rings.x_steps != rings.y_steps
    assert max(rings.x_steps, rings.y_steps) <= max(2, reach)
    assert rings.x[0] < cols
    assert rings.y[1] < rows


def test_known_cameras_bring_distances_and_sensor() -> None:
    known = known_cameras("webcams")
    assert list(known.cameras) == ["left", "right"]
    assert known.distances_mm == (550, 850)
    assert known.photometry is not None
    assert known_cameras("webcam-plane").distances_mm is None
    with pytest.raises(InputError):
        known_cameras("webcamz")


# Questions of different kind; pictures of other turns and noise than those of the design.
def question(name: str) -> TargetQuestion:
    return {
        "640x480": small(tilt_max_deg=50.0),
        "1280x960": TargetQuestion(
            {"left": camera(size=(1280, 960), fov_deg=70, dist=(0.06, -0.15))}, 400.0, 700.0,
            photometry=WEBCAM,
        ),
        "5 megapixels": TargetQuestion(
            {"left": camera(size=(2464, 2056), focal_mm=25, pixel_um=3.45)}, 290.0, 310.0, photometry=MACHINE
        ),
        "fisheye": TargetQuestion(
            {"left": camera(size=(1280, 960), fov_deg=130, lens="fisheye-kb4", dist=(-0.02, 0.004))},
            300.0, 500.0,
            photometry=MACHINE,
        ),
        "12 megapixels": TargetQuestion(
            {"left": camera(size=(4096, 3000), focal_mm=16, pixel_um=3.45)}, 900.0, 1100.0, paper_of("a3"),
            photometry=MACHINE,
        ),
        "telephoto": TargetQuestion(
            {"left": camera(size=(2464, 2056), focal_mm=100, pixel_um=3.45)}, 600.0, 650.0, photometry=MACHINE
        ),
        "tiles": TargetQuestion(
            {"left": camera(size=(1280, 960), fov_deg=60)}, 1000.0, 1500.0, tiles=(2, 2), photometry=MACHINE
        ),
        "charuco": TargetQuestion(
            {"left": camera(size=(1280, 960), fov_deg=70)}, 400.0, 600.0, kind="charuco", photometry=WEBCAM
        ),
        "coded dots": TargetQuestion(
            {"left": camera(size=(1280, 960), fov_deg=70)}, 400.0, 600.0, kind="coded-dots",
            photometry=MACHINE,
        ),
    }[name]  # fmt: skip


# Of the nine questions those that differ most: all nine take too long for every run.
@pytest.mark.slow
@pytest.mark.parametrize("name", ["640x480", "charuco", "coded dots"])
def test_designed_targets_are_found_near_and_far_square_and_tilted(name: str) -> None:
    asked = question(name)
    found = designed(asked)
    assert found.target.count <= MOST_DOTS
    views = tried_views(found.target, asked, seed=11, progress=NoProgress())
    assert all(view.passed for view in views)
    stated, measured = (np.array([view.sigma_px for view in some]) for some in (found.views, views))
    assert np.sqrt((measured**2).mean()) < 1.3 * np.sqrt((stated**2).mean())


def test_a_flat_picture_of_180_degrees_is_refused() -> None:
    with pytest.raises(InputError, match="cannot have a field of view of 180 degrees"):
        camera(size=(1280, 960), fov_deg=180)
    assert camera(size=(1280, 960), fov_deg=180, lens="fisheye-kb4").size == (1280, 960)


def test_distances_in_metres_are_told_as_too_short() -> None:
    with pytest.raises(InputError, match="1 m is 1000"):
        designed(small(near_mm=1.0, far_mm=2.0), 0, NoProgress())
