"""Rehearsals: forecasts against simulated calibrations, limits, boards and numbers of views."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.stats import spearmanr

from labcal import examples, load_rig_plan, rehearse
from labcal.bench.solve.rehearsal_set import RehearsalSet, measured_rehearsal
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.errors import InputError
from labcal.guide.rehearsal.boards import ViewCount, enough_views, scaled
from labcal.guide.rehearsal.dot_noise import DotNoise
from labcal.guide.rehearsal.forecast import forecast, rms, with_known_lenses
from labcal.guide.rehearsal.held_scene import held_scene
from labcal.guide.rehearsal.limits import LimitName, farther_apart
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.guide.rehearsal.sources import Sources
from labcal.pipeline import RehearseSettings
from labcal.scene.model import Scene
from labcal.scene.views import planned_views
from labcal.shoot.manifest import Role

PLAN = examples.rig_plan()
NOISE = DotNoise(8.0, 0.01**2, -1.0)


@pytest.fixture(scope="module")
def found() -> Rehearsal:
    """The example's plan, rehearsed once."""
    return examples.rehearsal()


def test_limits_are_sorted_by_their_gain_and_make_nothing_worse(found: Rehearsal) -> None:
    gains = [one.gain for one in found.limits]
    assert gains == sorted(gains, reverse=True)
    assert {one.name for one in found.limits} == set(LimitName)
    assert found.limited_by == found.limits[0].name.value
    by_name = {one.name: one for one in found.limits}
    for name in (LimitName.PIXELS, LimitName.LENS, LimitName.PRINT):
        assert 0.0 < by_name[name].gain < 0.5


def test_halving_pixels_and_print_halves_the_error(found: Rehearsal) -> None:
    planned = PlannedRig.of(PLAN)
    views = list(found.views)
    sources = Sources.of(PLAN, NOISE)
    halved = replace(
        sources,
        dots=sources.dots.times(0.5),
        points=sources.points.times(0.5),
        print_sigma_mm=0.5 * sources.print_sigma_mm,
    )
    whole, half = forecast(planned, views, sources), forecast(planned, views, halved)
    np.testing.assert_allclose(half.point_mm, 0.5 * whole.point_mm, rtol=1e-3)  # but for the weak prior


def test_dots_are_foretold_as_a_calibration_treats_them(found: Rehearsal) -> None:
    freed, declared = (found.by_dot_places[one] for one in (DotTreatment.FREED, DotTreatment.DECLARED))
    assert freed < 0.9 * declared
    assert found.forecast.dot_places is DotTreatment.FREED
    assert found.rms_mm == freed
    planned = PlannedRig.of(PLAN)
    few = forecast(planned, list(found.views[:4]), Sources.of(PLAN, NOISE))  # too few to decide by
    assert few.dot_places is DotTreatment.DECLARED
    exact = PLAN.model_copy(update={"print_sigma_mm": 0.0})
    even = forecast(PlannedRig.of(exact), list(found.views), Sources.of(exact, NOISE))
    assert even.dot_places is DotTreatment.DECLARED


def test_the_forecast_hardly_depends_on_the_poses_where_dots_are_freed(found: Rehearsal) -> None:
    assert len(found.by_poses_mm) == 3
    np.testing.assert_allclose(found.by_poses_mm, found.rms_mm, rtol=0.25)


def test_an_alignment_leaves_the_errors_of_shape(found: Rehearsal) -> None:
    made = found.forecast
    assert made.shape_mm < made.rms_mm
    assert made.shapes.sets_needed <= made.places.sets_needed
    np.testing.assert_allclose(rms(made.shape_point_mm), made.shape_mm)
    np.testing.assert_allclose(made.places.rms_mm, made.rms_mm)
    # Of what the calibration does to all points, next to all is a rigid motion.
    assert made.shapes.calibration_mm < 0.1 * made.places.calibration_mm


def test_the_map_has_shares_that_add_up(found: Rehearsal) -> None:
    table = found.map_columns()
    np.testing.assert_allclose(np.hypot(table["noise_mm"], table["calibration_mm"]), table["rms_mm"])
    both = np.sqrt(table["depth_mm"] ** 2 + 2.0 * table["sideways_mm"] ** 2)
    np.testing.assert_allclose(both, table["rms_mm"])
    low, high = found.forecast.places.range_mm
    assert low < found.rms_mm < high


def test_more_views_are_planned_from_those_that_are_there(found: Rehearsal) -> None:
    by_views = {one.views: one.rms_mm for one in found.counts}
    assert by_views[len(found.views)] == found.rms_mm
    assert by_views[48] < by_views[4]
    assert enough_views((ViewCount(4, 1.0), ViewCount(8, 0.8), ViewCount(16, 0.75))) == 8
    assert enough_views((ViewCount(4, 1.0), ViewCount(8, 0.8))) is None
    # A pause is no end.
    paused = {4: 1.0, 8: 0.99, 16: 0.7, 32: 0.68}
    assert enough_views(tuple(ViewCount(*one) for one in paused.items())) == 16


def test_a_board_that_is_printed_twice_as_large_has_all_lengths_doubled() -> None:
    double = scaled(PLAN.target, 2.0)
    np.testing.assert_allclose(double.points(), 2.0 * PLAN.target.points())
    np.testing.assert_allclose(double.outer_diameters_mm(), 2.0 * PLAN.target.outer_diameters_mm())
    assert double.cols == PLAN.target.cols


def test_lenses_that_are_known_better_have_half_the_deviation() -> None:
    random = np.random.default_rng(0)
    root = random.standard_normal((6, 6))
    covariance = root @ root.T
    lens = np.array([True, True, True, False, False, False])
    known = with_known_lenses(covariance, lens, 0.5)
    np.testing.assert_allclose(known[:3, :3], 0.25 * covariance[:3, :3])
    assert np.linalg.eigvalsh(known)[0] > 0.0
    assert (np.diagonal(known)[3:] < np.diagonal(covariance)[3:]).all()
    np.testing.assert_allclose(with_known_lenses(covariance, lens, 1.0), covariance)


def test_cameras_at_listed_places_move_apart_from_their_middle() -> None:
    wider = farther_apart(PLAN)
    assert PlannedRig.of(wider).rig.baseline_mm("left", "right") == pytest.approx(300.0)


def test_the_scene_has_the_recommended_poses(found: Rehearsal) -> None:
    scene = Scene.model_validate(yaml.safe_load(held_scene(found).to_yaml()))
    planned = PlannedRig.of(PLAN)
    T_first_scene = next(iter(scene.true_cameras().values())).T_cam_world
    views = planned_views(scene, 0)
    assert [view.role for view in views] == [Role.TRAIN] * 6 + [Role.TEST] * 4
    poses = [*found.views, *found.test_views]
    for view, T in zip(views, poses, strict=True):
        np.testing.assert_allclose(T_first_scene @ view.T_world_target, T, atol=1e-6)
    assert planned.rig.cameras.keys() == scene.true_cameras().keys()


def test_a_volume_behind_the_cameras_is_refused_and_leaves_no_folder(tmp_path: Path) -> None:
    behind = PLAN.volume.model_copy(update={"near_mm": -500.0, "far_mm": -400.0})
    with pytest.raises(InputError, match="seen by all cameras"):
        rehearse(PLAN.model_copy(update={"volume": behind}), tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_a_confirmation_needs_a_folder() -> None:
    with pytest.raises(InputError, match="Give `folder`"):
        rehearse(PLAN, settings=RehearseSettings(confirm=1))


@pytest.mark.slow
def test_the_forecast_is_what_simulated_calibrations_find() -> None:
    plan = load_rig_plan("webcams")
    planned = PlannedRig.of(plan)
    made = forecast(planned, planned.views(plan.shoot.views, 0), Sources.of(plan, NOISE))
    sets = [RehearsalSet(plan.name, NOISE, made.dot_places, seed) for seed in range(12)]
    errors = [measured_rehearsal(one) for one in sets]
    square = np.array([one.square_mm2 for one in errors])
    for one in errors:  # each by itself
        assert np.sqrt(np.mean(one.shape_mm2)) / made.shape_mm == pytest.approx(1.0, abs=0.15)
    by_set = square.mean(axis=1)
    chance = 2.6 * 0.5 * by_set.std() / by_set.mean() / np.sqrt(len(by_set))
    assert np.sqrt(by_set.mean()) / made.rms_mm == pytest.approx(1.0, abs=0.1 + chance)
    assert spearmanr(square.mean(axis=0), made.point_mm[made.seen]).statistic > 0.9
