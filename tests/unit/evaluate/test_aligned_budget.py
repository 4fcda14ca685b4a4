"""Covariances of points after a rigid alignment, against points of cameras that are drawn anew."""

from dataclasses import replace

import numpy as np

from labcal import Points, Rig, examples
from labcal.cameras.rig_covariance import RigCovariance
from labcal.cameras.triangulation import triangulate
from labcal.correspond.matching import match
from labcal.evaluate.aligned_budget import PointOrigin, aligned_covariance
from labcal.geometry.poses import from_rotation_vector, rigid_alignment, transform
from labcal.reconstruct.point_budget import Budget
from labcal.reconstruct.reconstruction import reconstruct_centres

SIGMA = np.array([*([0.05] * 4 + [1e-4, 1e-4, 1e-5, 1e-5, 1e-4]) * 2, 2e-4, 3e-4, 1e-4, 0.02, 0.02, 0.02])


def rig() -> Rig:
    plain = examples.rig()
    return plain.model_copy(update={"covariance": RigCovariance.of(plain.cameras, np.diag(SIGMA**2))})


def points(budget: Budget | None = None) -> Points:
    return reconstruct_centres(rig(), examples.detections(), None, budget).points


def test_a_turned_camera_leaves_what_an_alignment_leaves() -> None:
    turn_only = np.zeros(len(SIGMA))
    turn_only[-5] = 1e-4  # about its own y
    plain = examples.rig()
    known = plain.model_copy(update={"covariance": RigCovariance.of(plain.cameras, np.diag(turn_only**2))})
    dots = examples.detections()
    found = reconstruct_centres(known, dots, None).points
    left = aligned_covariance(found, PointOrigin(known), dots)
    noise = reconstruct_centres(known, dots, None, Budget.NOISE).points.covariance
    assert left is not None
    share = np.sqrt(np.trace(left - noise, axis1=1, axis2=2))
    # The same by turning the camera and aligning the points that come of it.
    first, second = (known.camera(name) for name in known.cameras)
    T = second.T_cam_world.copy()
    T[:3, :3] = from_rotation_vector(np.array([0.0, 1e-4, 0.0]), np.zeros(3))[:3, :3] @ T[:3, :3]
    matches = match(dots, ("left", "right"))
    moved = triangulate([first, replace(second, T_cam_world=T)], matches.q, matches.covariance).point
    off = transform(rigid_alignment(found.point, moved), moved) - found.point
    np.testing.assert_allclose(share, np.linalg.norm(off, axis=1), rtol=0.02, atol=2e-3 * share.max())
    full = np.sqrt(np.trace(found.covariance - noise, axis1=1, axis2=2))
    assert np.sqrt((share**2).mean()) < 0.5 * np.sqrt((full**2).mean())


def test_points_of_noise_alone_stay_as_they_are() -> None:
    assert aligned_covariance(points(Budget.NOISE), PointOrigin(rig()), examples.detections()) is None
    assert aligned_covariance(points(), PointOrigin(examples.rig()), examples.detections()) is None


def test_points_of_other_dots_stay_as_they_are() -> None:
    dots = examples.detections()
    assert aligned_covariance(points(), PointOrigin(rig()), dots.where(dots.view != "hand-0")) is None
