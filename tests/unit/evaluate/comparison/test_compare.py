"""Differences of two calibrations: against answers known by construction, and against mrcal."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

import labcal
from labcal import Camera, InputError, LabcalError, Rig, examples
from labcal.bench.solve.mrcal_programs import is_installed, module_run
from labcal.cameras.interop.mrcal import write_mrcal
from labcal.cameras.rig_covariance import RigCovariance, parameter_names
from labcal.cameras.support import CalibrationSupport
from labcal.evaluate.comparison.compare_settings import parse_names
from labcal.evaluate.comparison.lens_difference import CalibratedLens, lens_difference
from labcal.evaluate.comparison.weighted_squares import weighted_squares_tail
from labcal.geometry.hull import inside_hull
from labcal.geometry.poses import from_rotation_vector, inverse
from labcal.pipeline import CompareSettings
from labcal.rng import generator

NEAR = CompareSettings(distances_mm=(500.0, 700.0), pictures="different")


def _moved(T_new_old: np.ndarray) -> Rig:
    """Return the example's rig in another world."""
    rig = examples.rig()
    cameras = {}
    for name in rig.cameras:
        c = rig.camera(name)
        cameras[name] = Camera(c.K, c.lens, c.dist, c.T_cam_world @ inverse(T_new_old), c.size)
    return Rig.of(cameras)


def _with_camera(name: str, K: np.ndarray | None = None, T: np.ndarray | None = None) -> Rig:
    rig = examples.rig()
    cameras = {one: rig.camera(one) for one in rig.cameras}
    c = cameras[name]
    cameras[name] = Camera(c.K if K is None else K, c.lens, c.dist, c.T_cam_world if T is None else T, c.size)
    return Rig.of(cameras)


def _with_covariance(rig: Rig, sigma: float) -> Rig:
    """Return a rig that states independent parameters: px and mm by `sigma`, the rest less."""
    names = parameter_names(rig.cameras)
    small = np.array([1.0 if name.rsplit(".", 1)[1][0] in "fcs" else 1e-3 for name in names])
    record = RigCovariance.of(rig.cameras, np.diag((sigma * small) ** 2))
    return rig.model_copy(update={"covariance": record})


def test_a_motion_of_the_world_is_no_difference() -> None:
    T = from_rotation_vector(np.array([0.3, -0.2, 0.5]), np.array([100.0, -50.0, 700.0]))
    found = labcal.compare(examples.rig(), _moved(T), NEAR)
    assert found.volume is not None
    assert found.volume.remaining.largest < 1e-6
    np.testing.assert_allclose(found.volume.T_one_other, inverse(T), atol=1e-8)


def test_a_camera_that_moved_shows_in_the_volume_and_in_no_lens() -> None:
    T = examples.rig().camera("right").T_cam_world.copy()
    T = from_rotation_vector(np.array([0.0, 1e-3, 0.0]), np.zeros(3)) @ T
    found = labcal.compare(examples.rig(), _with_camera("right", T=T), NEAR)
    assert found.volume is not None
    assert found.volume.remaining.rms > 0.05
    for camera in found.cameras:
        assert all(part.remaining.largest < 1e-5 for part in camera.differences)


def test_a_moved_principal_point_is_a_rotation_for_far_points() -> None:
    rig = examples.rig()
    K = rig.camera("left").K + np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    (left, right) = labcal.compare(rig, _with_camera("left", K=K), NEAR).cameras
    # A shift by 1 px, of which the rotation by 1/800 explains all but second-order parts.
    assert left.differences[-1].remaining.rms < 0.2
    assert right.differences[-1].remaining.largest < 1e-6


def test_a_longer_focal_length_is_no_motion_at_infinity() -> None:
    rig = examples.rig()
    K = rig.camera("left").K + np.diag([0.8, 0.8, 0.0])  # 0.1%
    left = labcal.compare(rig, _with_camera("left", K=K), NEAR).cameras[0]
    q, r = left.differences[-1].q, left.differences[-1].remaining
    np.testing.assert_allclose(r.difference, 1e-3 * (q - [322.0, 238.0]), atol=0.02)


def test_what_both_budgets_expect_is_what_simulated_calibrations_differ_by() -> None:
    """Draw parameters from the stated covariance: mean squares and p-values must be as stated."""
    rng, rig = generator(0, "compare"), _with_covariance(examples.rig(), 0.3)
    ratios, chances = [], []
    for _ in range(24):
        found = labcal.compare(_drawn(rig, rng), _drawn(rig, rng), NEAR)
        parts = [
            found.main,
            found.cameras[0].differences[0].remaining,
            found.cameras[1].differences[-1].remaining,
        ]
        ratios.append([(part.rms / part.expected_of_both) ** 2 for part in parts])
        chances.append([part.p_value() for part in parts])
    spread = np.std(ratios, axis=0) / np.sqrt(len(ratios))
    np.testing.assert_array_less(np.abs(np.mean(ratios, axis=0) - 1.0), 3.0 * spread)
    for column in np.array(chances).T:  # uniform: Fisher's method, both sides
        value = -2.0 * np.log(column).sum()
        assert 0.005 < chi2.sf(value, 2 * len(column)) < 0.995


def _drawn(rig: Rig, rng: np.random.Generator) -> Rig:
    """Return a rig whose parameters are off by errors of its covariance."""
    assert rig.covariance is not None
    sigma = np.sqrt(np.diagonal(rig.covariance.matrix))
    off = dict(zip(rig.covariance.parameters, sigma * rng.standard_normal(len(sigma)), strict=True))
    cameras = {}
    for number, name in enumerate(rig.cameras):
        c, e = rig.camera(name), lambda key, name=name: off[f"{name}.{key}"]
        K = c.K + np.array([[e("fx"), 0, e("cx")], [0, e("fy"), e("cy")], [0, 0, 0]])
        dist = c.dist + np.array([e(k) for k in c.model.names])
        T = c.T_cam_world.copy()
        if number:
            turn = from_rotation_vector(np.array([e(f"turn_{axis}") for axis in "xyz"]), np.zeros(3))
            T[:3, :3] = turn[:3, :3] @ T[:3, :3]
            T[:3, 3] += [e(f"shift_{axis}") for axis in "xyz"]
        cameras[name] = Camera(K, c.lens, dist, T, c.size)
    return Rig.of(cameras).model_copy(update={"covariance": rig.covariance})


@pytest.mark.skipif(not is_installed(), reason="mrcal is not installed")
@pytest.mark.parametrize("distance_mm", [None, 1000.0])
def test_a_lens_differs_as_mrcal_says(tmp_path: Path, distance_mm: float | None) -> None:
    """At mrcal's own implied motion our projections differ as its do; least squares leave a little less."""
    one = examples.rig().camera("left")
    K = one.K + np.array([[2.0, 0.0, 1.5], [0.0, 1.2, -2.0], [0.0, 0.0, 0.0]])
    other = Camera(K, one.lens, 1.02 * one.dist, np.eye(4), one.size)
    files = []
    for name, camera in (("a", one), ("b", other)):
        files.append(tmp_path / f"{name}.cameramodel")
        files[-1].write_text(write_mrcal(Rig.of({name: camera}), "").files[0].text, encoding="utf-8")
    far = distance_mm is None
    said = json.loads(module_run(_DIFF, files, json.dumps(None if far else distance_mm / 1000.0)))
    theirs, q, (R, t) = np.array(said[0]), np.array(said[1]), (np.array(said[2][:3]), np.array(said[2][3]))
    none = np.empty((0, 2))
    ours = lens_difference(
        CalibratedLens(one, None, none), CalibratedLens(other, None, none), () if far else (distance_mm,)
    )
    np.testing.assert_allclose(ours.q, q.reshape(-1, 2), atol=1e-9)
    p = one.rays(ours.q).direction * (1e9 if far else distance_mm)
    at_theirs = other.project(p @ R.T + (0.0 if far else 1000.0 * t)).q - ours.q
    np.testing.assert_allclose(at_theirs, theirs.reshape(-1, 2), atol=1e-5)
    theirs_rms = np.sqrt((theirs**2).sum(axis=-1).mean())
    assert 0.93 * theirs_rms < ours.remaining.rms <= theirs_rms


_DIFF = """
import sys, json, numpy as np, mrcal
models = [mrcal.cameramodel(f) for f in sys.argv[1:3]]
_, diff, q, Rt = mrcal.projection_diff(models, gridn_width=33, gridn_height=25,
    distance=json.loads(sys.stdin.read()), use_uncertainties=False, focus_radius=1e6)
print(json.dumps([np.asarray(diff).tolist(), q.tolist(), Rt.tolist()]))
"""


@pytest.mark.parametrize("weights", [[1.0], [1.0, 1.0, 1.0], [5.0, 1.0, 0.1, 0.1], np.geomspace(1, 1e-6, 30)])
def test_the_tail_of_weighted_squares_is_that_of_many_draws(weights: list[float]) -> None:
    draws = (generator(1, "squares").standard_normal((400_000, len(weights))) ** 2) @ np.asarray(weights)
    for share in (0.9, 0.5, 0.1, 0.01, 0.001):
        value = float(np.quantile(draws, 1.0 - share))
        assert weighted_squares_tail(value, np.asarray(weights)) == pytest.approx(share, rel=0.12)
    assert weighted_squares_tail(0.0, np.ones(2)) == 1.0
    assert np.isnan(weighted_squares_tail(float("nan"), np.ones(2)))
    for small in (1e-30, 1e-13, 1e-9):
        assert weighted_squares_tail(small, np.asarray(weights)) == pytest.approx(1.0, abs=1e-3)
    for large in (1e4, 1e7, 1e30):
        assert weighted_squares_tail(large, np.asarray(weights)) < 1e-6


def test_calibrations_of_the_same_pictures_are_not_tested() -> None:
    rig = _with_covariance(examples.rig(), 0.1)
    assert labcal.compare(rig, rig, NEAR).p_value == pytest.approx(1.0)  # nothing differs
    same = labcal.compare(rig, rig, replace(NEAR, pictures="same"))
    assert same.is_consistent is None
    assert "are not tested" in " ".join(same.warnings)
    unknown = labcal.compare(rig, rig, replace(NEAR, pictures=None))
    assert "both calibrations name views alike" in " ".join(unknown.warnings)


def test_a_calibration_states_where_its_dots_were() -> None:
    dots = examples.detections()
    rig = labcal.pipeline.calibrate(examples.TARGET, dots).rig
    assert rig.calibration is not None
    support = rig.calibration.support
    assert support is not None
    ok = dots.where((dots.camera == "left") & (dots.flag == "ok"))
    np.testing.assert_allclose(support.outline("left").max(axis=0), ok.position.max(axis=0), atol=0.06)
    assert inside_hull(examples.points().point, support.volume, 3.0).all()
    assert not inside_hull(examples.points().point * 1.1, support.volume, 3.0).all()
    found = labcal.compare(rig, rig, CompareSettings(pictures="same"))
    assert found.volume is not None
    assert len(found.volume.point) > 500


@pytest.mark.parametrize(
    ("other", "settings", "message"),
    [
        (Rig.of({"left": examples.rig().camera("left")}), {}, "not the same"),
        (examples.rig(), {"cameras": {"left": "middle"}}, "middle"),
        (examples.rig(), {"distances_mm": [-1.0]}, "positive"),
        (examples.rig(), {"distances_mm": 1e-9}, "fields of view overlap"),
        (examples.rig(), {"pictures": "others"}, "others"),
    ],
)
def test_what_cannot_be_compared_is_refused_with_a_reason(
    other: Rig, settings: dict[str, object], message: str
) -> None:
    with pytest.raises(LabcalError, match=message):
        labcal.compare(examples.rig(), other, CompareSettings(**settings))


def test_pictures_of_two_sizes_are_refused() -> None:
    c = examples.rig().camera("left")
    other = Rig.of({"left": Camera(c.K, c.lens, c.dist, c.T_cam_world, (800, 600))})
    with pytest.raises(InputError, match="640 x 480 pixels in the first rig and 800 x 600"):
        labcal.compare(Rig.of({"left": c}), other)


def test_names_are_paired() -> None:
    assert parse_names("left=a,right=b") == {"left": "a", "right": "b"}
    rig = examples.rig()
    renamed = Rig.of({"b": rig.camera("right"), "a": rig.camera("left")})  # in another order, too
    found = labcal.compare(rig, renamed, replace(NEAR, cameras={"left": "a", "right": "b"}))
    assert found.volume is not None
    assert found.volume.remaining.largest < 1e-6
    with pytest.raises(InputError, match="pairs each name"):
        parse_names("left")


def test_a_support_reads_back_and_old_files_have_none(tmp_path: Path) -> None:
    rig = examples.rig()
    rig.save(tmp_path / "old.json")
    assert "support" not in (tmp_path / "old.json").read_text(encoding="utf-8")
    support = CalibrationSupport(pictures_px={"left": [(0, 0), (9, 0), (0, 9)]}, volume_mm=[(0, 0, 500)])
    record = {"calibration": {"support": support.model_dump()}}
    with_it = Rig.model_validate({**json.loads(rig.model_dump_json()), **record})
    with_it.save(tmp_path / "new.json")
    assert Rig.load(tmp_path / "new.json") == with_it
