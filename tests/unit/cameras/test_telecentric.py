"""The telecentric lens: against OpenCV on a plane at unit depth, and what parallel rays mean."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.bounds import FIELD_MM
from labcal.cameras.camera import Camera
from labcal.cameras.ideal import ideal_camera, rectified_pair, whole_ideal_camera
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.mathematics import NUMPY
from labcal.cameras.pupil import ParallelPupil
from labcal.cameras.remapping import source_pixels
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig, write_rig
from labcal.cameras.triangulation import epipolar_distances, triangulate, triangulation_limit
from labcal.cameras.window import FlatWindow, Wave, WavyWindow
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, transform

DIST = np.array([-4e-4, 3e-7, 2e-5, -3e-5, -1e-10])
"""Some 15 px in the corners of the picture."""
K = np.array([[20.0, 0.0, 322.4], [0.0, 20.3, 237.1], [0.0, 0.0, 1.0]])
SIZE = (640, 480)
ELSEWHERE = from_rotation_vector(np.array([0.3, -0.2, 0.1]), np.array([3.0, -5.0, 90.0]))
MEETING_MM = 95.0
BESIDE = from_rotation_vector(np.array([0.02, 0.6, -0.03]), np.zeros(3))
BESIDE[:3, 3] = [0.0, 0.0, MEETING_MM] - BESIDE[:3, 2] * MEETING_MM
"""A second camera whose axis meets the first one's so far from it."""


def camera(T: np.ndarray = ELSEWHERE) -> Camera:
    return Camera(K, "telecentric", DIST, T, SIZE)


def points(depth: tuple[float, float] = (-200.0, 500.0)) -> np.ndarray:
    """Return world points in the picture of the camera elsewhere, mm, at depths within bounds."""
    low, high = depth
    local = np.random.default_rng(5).uniform([-15.0, -11.0, low], [15.0, 11.0, high], (200, 3))
    return (local - ELSEWHERE[:3, 3]) @ ELSEWHERE[:3, :3]


def test_it_is_brown_on_millimetres_whatever_the_depth() -> None:
    """OpenCV's projection of (X, Y, 1) distorts X and Y as they are."""
    one, p = camera(), points()
    local = transform(ELSEWHERE, p)
    on_plane = np.column_stack([local[:, :2], np.ones(len(p))])
    expected, _ = cv2.projectPoints(on_plane, np.zeros(3), np.zeros(3), K, DIST)
    found = one.project(p)
    assert found.ok.all()
    np.testing.assert_allclose(found.q, expected[:, 0], rtol=0, atol=1e-9)
    bent = np.abs(found.q - (local[:, :2] * [20.0, 20.3] + [322.4, 237.1])).max()
    assert bent > 10.0  # px


def test_its_rays_are_parallel_and_pass_what_they_image() -> None:
    one, p = camera(), points()
    rays = one.rays(one.project(p).q)
    assert rays.ok.all()
    np.testing.assert_allclose(rays.direction, np.tile(ELSEWHERE[2, :3], (len(p), 1)), rtol=0, atol=1e-15)
    beside = np.cross(p - rays.origin, rays.direction)
    np.testing.assert_allclose(beside, 0.0, rtol=0, atol=1e-10)
    np.testing.assert_allclose(transform(ELSEWHERE, rays.origin)[:, 2], 0.0, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(one.towards(p), np.tile(-ELSEWHERE[2, :3], (len(p), 1)))


def test_depth_and_principal_point_are_not_to_be_seen() -> None:
    one, p = camera(), points()
    along = np.outer(np.linspace(-50.0, 50.0, len(p)), ELSEWHERE[2, :3])
    np.testing.assert_allclose(one.project(p + along).q, one.project(p).q, rtol=0, atol=1e-9)
    np.testing.assert_allclose(one.point_jacobian(p) @ ELSEWHERE[2, :3], 0.0, rtol=0, atol=1e-12)
    plain, moved = replace(one, dist=np.zeros(5)), K + np.array([[0, 0, 5.0], [0, 0, -3.0], [0, 0, 0]])
    aside = ELSEWHERE.copy()
    aside[:2, 3] -= [5.0 / 20.0, -3.0 / 20.3]
    np.testing.assert_allclose(
        replace(plain, K=moved, T_cam_world=aside).project(p).q, plain.project(p).q, rtol=0, atol=1e-9
    )


def test_beyond_the_fold_it_images_nothing() -> None:
    """r (1 + k1 r^2) stops growing at r^2 = -1 / (3 k1)."""
    one = replace(camera(np.eye(4)), dist=np.array([-1e-3, 0.0, 0.0, 0.0, 0.0]))
    end = np.sqrt(1.0 / 3e-3)
    p = np.array([[0.999 * end, 0.0, 9.0], [1.001 * end, 0.0, 9.0], [np.nan, 0.0, 9.0]])
    np.testing.assert_array_equal(one.project(p).ok, [True, False, False])


def test_two_cameras_with_parallel_rays_give_points() -> None:
    cameras, p = [camera(), camera(BESIDE @ ELSEWHERE)], points((MEETING_MM - 9.0, MEETING_MM + 9.0))
    q = np.stack([one.project(p).q for one in cameras], axis=1)
    covariance = np.tile(0.01 * np.eye(2), (len(p), 2, 1, 1))
    found = triangulate(cameras, q, covariance)
    assert found.ok.all()
    np.testing.assert_allclose(found.point, p, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.covariance, triangulation_limit(cameras, p, covariance), rtol=1e-6)
    np.testing.assert_allclose(epipolar_distances(*cameras, q[:, 0], q[:, 1]), 0.0, rtol=0, atol=1e-8)
    same = triangulate([cameras[0], cameras[0]], q[:, [0, 0]], covariance)
    assert not same.ok.any()


def test_only_labcal_holds_it(tmp_path: Path) -> None:
    rig = Rig.of({"left": camera(np.eye(4)), "right": camera(BESIDE)})
    for name, one in FORMATS.items():
        if name == "labcal":
            continue
        with pytest.raises(InputError, match=r"(?s)telecentric.*(parallel|no lens)"):
            one.write(rig, one.suffixes[0] if one.suffixes else "")
    path = tmp_path / "rig.json"
    write_rig(path, rig)
    assert read_rig(path) == rig


def test_a_flat_window_is_refused_and_a_wavy_one_is_not() -> None:
    with pytest.raises(InputError, match="leaves the rays of the lens 'telecentric' parallel"):
        replace(camera(), window=FlatWindow(distance_mm=20.0))
    wavy = replace(
        camera(),
        window=WavyWindow(waves=(Wave(amplitude_px=(0.6, 0.4), period_px=150.0, direction_deg=30.0),)),
    )
    p = points()
    found = wavy.project(p)
    assert found.ok.all()
    rays = wavy.rays(found.q)
    np.testing.assert_allclose(np.cross(p - rays.origin, rays.direction), 0.0, rtol=0, atol=1e-7)


def test_figures_that_make_no_sense_are_refused() -> None:
    least, most = (640.0 / mm for mm in FIELD_MM[::-1])
    for scale in (0.9 * least, 1.1 * most):
        with pytest.raises(InputError, match=r"The scale fx is .* px/mm"):
            Rig.of({"left": replace(camera(), K=np.array([[scale, 0, 320], [0, scale, 240], [0, 0, 1.0]]))})
    with pytest.raises(InputError, match=r"dist\[0\] is 50"):
        Rig.of({"left": replace(camera(), dist=np.array([50.0, 0.0, 0.0, 0.0, 0.0]))})


def test_its_ideal_camera_is_one_without_distortion() -> None:
    one = camera()
    ideal = ideal_camera(one)
    assert (ideal.lens, ideal.dist.any()) == ("telecentric", False)
    source = source_pixels(one, ideal)
    q = np.array([[100.0, 60.0], [500.0, 400.0]])
    p = ideal.rays(q).origin + 37.0 * ideal.rays(q).direction
    np.testing.assert_allclose(source[[60, 400], [100, 500]], one.project(p).q, rtol=0, atol=1e-4)
    for refused in (lambda: whole_ideal_camera(one), lambda: rectified_pair(one, camera(BESIDE))):
        with pytest.raises(InputError, match="has parallel rays, and no pinhole"):
            refused()


def test_an_open_aperture_has_the_same_cone_around_every_ray() -> None:
    pupil, chief = ParallelPupil(4.0, 80.0), camera(np.eye(4))
    traced = chief.optics.trace(NUMPY, chief.parameters, np.array([10.0, 500.0]), np.array([400.0, 30.0]))
    disc = (np.array([0.6, -0.2]), np.array([0.3, 0.9]))
    ray = pupil.ray(NUMPY, pupil.parameters, traced, (0.0, 0.0, *disc)).ray
    start, direction = np.stack(ray.origin, axis=-1), np.stack(ray.direction, axis=-1)
    middle = np.stack(traced.origin, axis=-1)
    np.testing.assert_allclose(start - middle, 4.0 * np.stack([*disc, np.zeros(2)], axis=-1), atol=1e-12)
    in_focus = start + direction * (80.0 / direction[:, 2])[:, None]
    np.testing.assert_allclose(in_focus, middle + np.array([0.0, 0.0, 80.0]), rtol=0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1.0, rtol=1e-14)
