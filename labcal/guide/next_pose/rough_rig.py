"""The rig roughly, by the first views: to choose the next pose before there is a calibration."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.lens import lens_by_name, undistorted_dist
from labcal.cameras.optics import INTRINSICS
from labcal.cameras.parameter_derivatives import POSE, parameter_slices
from labcal.capture.guide_settings import GuideSettings
from labcal.correspond.detections import Detections
from labcal.geometry.poses import inverse, transform
from labcal.geometry.projective_map import projective_map
from labcal.guide.next_pose.findable import Findable, images
from labcal.guide.next_pose.first_poses import FEWEST, FOCAL, camera_matrix, pose_by_pixels
from labcal.guide.next_pose.information import view_information
from labcal.guide.next_pose.standing import DotVariance
from labcal.guide.next_pose.volume import MeasuredVolume
from labcal.targets.catalogue import AnyTarget

_SHORTEST, _LONGEST = 0.5, 10.0
"""Focal lengths that are believed, over the width of the picture."""
_LEAST_TILT = 0.05
"""Of the target, as sin^2 of its tilt, below which its picture tells no focal length."""
_FOCAL_SHARE, _MIDDLE_SHARE, _COEFFICIENT = 0.15, 0.03, 0.3
"""Standard deviations of what is roughly known: focal lengths as a share, the principal point over the width
of the picture, coefficients of distortion."""
_TURN, _SHIFT_SHARE = 0.1, 0.1
"""Of the pose of the other cameras: rad, and as a share of the target's distance."""
_EXTRA_PX2 = 0.1**2
"""Variance of dots by all that the rough rig does not describe."""


@dataclass(frozen=True)
class RoughRig:
    """Cameras without distortion, and how far off they may be.

    Attributes
    ----------
    names : tuple of str
    cameras : tuple of Camera
        The first one is the world.
    covariance : float64 array, (parameters, parameters)
        Of the rig's parameters, with the information of the views so far.
    poses : float64 array, (views, 4, 4)
        ``T_world_target``, mm.
    centre : float64 array, (3,)
        Where the middle of the target was in the first view, mm.
    volume : MeasuredVolume
    variance : DotVariance
    """

    names: tuple[str, ...]
    cameras: tuple[Camera, ...]
    covariance: Float64[np.ndarray, "parameters parameters"]
    poses: Float64[np.ndarray, "views 4 4"]
    centre: Vectors3
    volume: MeasuredVolume
    variance: DotVariance

    @property
    def distance_share(self) -> float:
        """Relative standard deviation of distances: that of the focal lengths."""
        return _FOCAL_SHARE

    @classmethod
    def of(
        cls,
        views: Sequence[Detections],
        sizes: Mapping[str, tuple[int, int]],
        target: AnyTarget,
        settings: GuideSettings,
    ) -> "RoughRig | None":
        """Return the rig by views of the target; None where a camera does not see it in the first one.

        Parameters
        ----------
        views : sequence of Detections
            The usable dots of each view.
        sizes : mapping of str to (int, int)
            Width and height of the pictures by camera, px.
        target : AnyTarget
        settings : GuideSettings
            Lens and volume.
        """
        lens, cameras, first = lens_by_name(settings.lens), list[Camera](), list[Pose]()
        if lens.parallel:
            return None
        for name, size in sizes.items():
            own = [dots.where(dots.camera == name) for dots in views]
            if len(own[0]) < FEWEST:
                return None
            pairs = [(target.points(dots.index), dots.position) for dots in own if len(dots) >= FEWEST]
            K = camera_matrix(_focal(pairs, size), size)
            first.append(pose_by_pixels(*pairs[0], K))
            T_cam_world = first[-1] @ inverse(first[0])
            cameras.append(Camera(K, settings.lens, undistorted_dist(lens), T_cam_world, size))
        centre = transform(first[0], Findable.of(target).middle[None])[0]
        volume = MeasuredVolume.of(tuple(cameras), centre, settings.volume_mm)
        return _with_views(tuple(sizes), volume, views, target, (first[0], centre))


def _with_views(
    names: tuple[str, ...],
    volume: MeasuredVolume,
    views: Sequence[Detections],
    target: AnyTarget,
    first: tuple[Pose, Vectors3],
) -> RoughRig:
    """Return the rig with the information of the views that a camera of it sees."""
    cameras, (T_first, centre) = volume.cameras, first
    findable, poses = Findable.of(target), [T_first]
    for dots in views[1:]:
        name = next(one for one in names if (dots.camera == one).any())
        own, camera = dots.where(dots.camera == name), cameras[names.index(name)]
        T = pose_by_pixels(target.points(own.index), own.position, camera.K)
        poses.append(inverse(camera.T_cam_world) @ T)
    T_world_target = np.array(poses)
    seen = np.array([[(dots.camera == name).any() for dots in views] for name in names])
    inside = np.array([findable.seen(camera, T_world_target)[1] for camera in cameras]) & seen[..., None]
    stated = np.nanmedian([np.nanmedian(np.trace(one.covariance, axis1=1, axis2=2)) for one in views]) / 2.0
    size = np.concatenate(
        [images(one, T_world_target, findable.dots, findable.radius_mm)[1].minor_px for one in cameras]
    )
    variance = DotVariance(float(np.median(size[size > 0.0])), float(stated), _EXTRA_PX2)
    known = np.diag(1.0 / _deviations(cameras, float(np.linalg.norm(centre))) ** 2)
    added = view_information(cameras, T_world_target, findable, inside, variance).sum(axis=0)
    return RoughRig(names, cameras, np.linalg.inv(known + added), T_world_target, centre, volume, variance)


def _deviations(cameras: tuple[Camera, ...], distance: float) -> Float64[np.ndarray, " parameters"]:
    """Return how far off the parameters of the rig may be."""
    found = np.full(parameter_slices(cameras)[-1].stop, _COEFFICIENT)
    for number, (camera, place) in enumerate(zip(cameras, parameter_slices(cameras), strict=True)):
        found[place.start : place.start + 2] = _FOCAL_SHARE * camera.K[0, 0]
        found[place.start + 2 : place.start + INTRINSICS] = _MIDDLE_SHARE * camera.size[0]
        if number:
            found[place.stop - POSE : place.stop - POSE // 2] = _TURN
            found[place.stop - POSE // 2 : place.stop] = _SHIFT_SHARE * distance
    return found


def _focal(pairs: Sequence[tuple[Vectors3, Pixels]], size: tuple[int, int]) -> float:
    """Return the focal length (px) of square pixels about the middle of the picture, by pictures of a plane.

    Columns h1, h2 of a plane's map into the picture are orthogonal and of one length after division by the
    focal length (Zhang 2000): linear equations for 1 / f^2. A guess where the target faces the camera in all
    views, which then tell nothing, or where the result is not believed.
    """
    middle, known, unknown = 0.5 * (np.array(size) - 1.0), list[float](), list[float]()
    for points, q in pairs:
        flat = points[:, :2] - points[:, :2].mean(axis=0)
        M = projective_map("first views", flat, (q - middle) / size[0])
        h1, h2 = (M / np.sqrt(np.linalg.norm(M[:2, 0]) * np.linalg.norm(M[:2, 1])))[:, :2].T
        unknown += [h1[:2] @ h2[:2], h1[:2] @ h1[:2] - h2[:2] @ h2[:2]]
        known += [-h1[2] * h2[2], h2[2] ** 2 - h1[2] ** 2]
    a, b = np.array(unknown), np.array(known)
    square = float(a @ b) / max(float(a @ a), 1e-12)
    if float(a @ a) < _LEAST_TILT**2 or not _LONGEST**-2 <= square <= _SHORTEST**-2:
        return FOCAL * size[0]
    return size[0] / float(np.sqrt(square))
