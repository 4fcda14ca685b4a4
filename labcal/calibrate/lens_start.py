"""Initial values of the calibration of one camera: a lens, and poses of the target in every view."""

from dataclasses import dataclass, replace
from functools import reduce
from operator import or_

import cv2
import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Pose, Vectors3
from labcal.calibrate.bent_start import as_perspective
from labcal.calibrate.gross_errors import gross_errors
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.start import camera_with_field, depth_held_mm
from labcal.cameras.camera import Camera
from labcal.cameras.lens import FISHEYE, LENGTH, PRESCRIPTION, lens_by_name
from labcal.cameras.opencv_model import PERSPECTIVE, from_order, to_order
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.parallel_pose import affine_map, parallel_plane_pose, plane_scale
from labcal.geometry.plane_pose import plane_pose
from labcal.geometry.poses import from_rotation_vector, transform
from labcal.run.threads import one_opencv_thread
from labcal.targets.target import Target

_TERMINATION = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-9)
_KEPT_AT_0 = {
    "k1": cv2.CALIB_FIX_K1,
    "k2": cv2.CALIB_FIX_K2,
    "p1": cv2.CALIB_ZERO_TANGENT_DIST,
    "p2": cv2.CALIB_ZERO_TANGENT_DIST,
    "k3": cv2.CALIB_FIX_K3,
}
"""OpenCV's flag for what a lens does not have; of those beyond these five none is free at the start."""
_FAR_OFF_PX = 2.0
"""RMS of OpenCV's start from which on it is not the lens: another start is tried."""
_HALF_FIELDS_DEG = np.geomspace(15.0, 170.0, 30)
_WIDEST_FLAT_DEG = 75.0
_SCAN_VIEWS = 12


@dataclass(frozen=True)
class LensStart:
    """A camera in its own frame, and where the target was in the views that it measured."""

    camera: Camera
    T_cam_target: Float64[np.ndarray, "views 4 4"]


def require_adjustable(lens: str) -> None:
    """Raise where the lens model has no coefficients to estimate.

    Raises
    ------
    UnknownNameError
        There is no such lens model.
    InputError
        It is traced through a prescription.
    """
    if lens == PRESCRIPTION:
        raise InputError(
            "A lens prescription describes glass that is known; there is nothing in it to calibrate. Use "
            "another lens model, such as rational8."
        )
    lens_by_name(lens)


def start_from_pictures(pictures: list[Detections], target: Target, lens: str) -> LensStart:
    """Return a first lens and poses from the dots of one camera alone.

    Parameters
    ----------
    pictures : list of Detections
        The dots of each view. Those that are grossly wrong are left out.
    target : Target
        Its dots are taken as flat and exactly placed.
    lens : str
        Any model but a prescription.

    Raises
    ------
    UnknownNameError
        There is no such lens model.
    InputError
        The dots determine no camera.
    """
    require_adjustable(lens)
    pictures = _without_gross_errors(pictures, target)
    if lens_by_name(lens).parallel:
        return _by_affine_maps(pictures, target, lens)
    if lens_by_name(lens).opencv is PERSPECTIVE:
        return _by_opencv(pictures, target, lens)
    return _by_scan(pictures, target, lens)


def start_from_camera(pictures: list[Detections], target: Target, known: Camera) -> LensStart:
    """Return first poses of the target, seen by a camera that is known more or less.

    Raises
    ------
    InputError
        The dots of a view are no picture of the target through this camera.
    """
    camera = replace(known, T_cam_world=np.eye(4))
    return LensStart(camera, _poses(camera, _without_gross_errors(pictures, target), target))


def camera_as_lens(known: Camera, lens: str, name: str) -> Camera:
    """Return a camera with another lens model that contains its own.

    Raises
    ------
    UnknownNameError
        There is no such lens model.
    InputError
        The model cannot be what the camera is.
    """
    require_adjustable(lens)
    if known.lens == lens:
        return known
    old, new = known.model, lens_by_name(lens)
    held = dict(zip(old.names, known.dist.tolist(), strict=False))
    lost = [name for name, value in held.items() if name not in new.names and value != 0.0]
    if old.opencv is None or old.opencv is not new.opencv or lost:
        raise InputError(
            f"Camera '{name}' of the rig to start from has the lens '{known.lens}', from which '{lens}' "
            "cannot start. Leave `start` out, or name a lens with at least its coefficients."
        )
    values = to_order(old.opencv, old.names, tuple(held.values()))
    dist = np.zeros(max(LENGTH, new.coefficients))
    dist[: new.coefficients] = from_order(old.opencv, new.names, values)
    return replace(known, lens=lens, dist=dist)


def _without_gross_errors(pictures: list[Detections], target: Target) -> list[Detections]:
    return [dots.where(~gross_errors(dots, target)) for dots in pictures]


@one_opencv_thread()
def _by_opencv(pictures: list[Detections], target: Target, lens: str) -> LensStart:
    """Start a lens of OpenCV's perspective model by Zhang's method."""
    names = lens_by_name(lens).names
    size = pictures[0].picture_size(pictures[0].cameras[0])
    try:
        rms, K, found, turns, shifts = cv2.calibrateCamera(
            [target.points(dots.index).astype(np.float32) for dots in pictures],
            [dots.position.astype(np.float32) for dots in pictures],
            size,
            np.eye(3),
            np.zeros(LENGTH),
            flags=reduce(or_, (flag for name, flag in _KEPT_AT_0.items() if name not in names), 0),
            criteria=_TERMINATION,
        )
    except cv2.error as error:
        raise InputError(
            f"The dots of camera '{pictures[0].cameras[0]}' determine no camera ({error.err}). Every view "
            "needs dots of several rows and columns, and the views different tilts."
        ) from error
    values = np.asarray(found, dtype=np.float64).ravel()[:LENGTH].tolist()
    dist = np.zeros(max(LENGTH, len(names)))
    dist[: len(names)] = from_order(PERSPECTIVE, names, tuple(values))
    poses = [
        from_rotation_vector(np.asarray(turn, dtype=np.float64).ravel(), np.asarray(shift).ravel())
        for turn, shift in zip(turns, shifts, strict=True)
    ]
    camera = Camera(np.asarray(K, dtype=np.float64), lens, dist, np.eye(4), size)
    folds = not all(_images_all(camera, T, dots, target) for T, dots in zip(poses, pictures, strict=True))
    if folds:
        # OpenCV may end at a lens that folds within the picture; from none the adjustment finds its own.
        camera = replace(camera, dist=np.zeros_like(dist))
    start = LensStart(camera, np.stack(poses))
    return _bent(pictures, target, start) if folds or rms > _FAR_OFF_PX else start


def _bent(pictures: list[Detections], target: Target, other: LensStart) -> LensStart:
    """Return a start that images angles proportionally, where it explains the dots better than another."""
    try:
        equidistant = _by_scan(pictures, target, FISHEYE).camera
        rays = equidistant.rays(np.concatenate([dots.position for dots in pictures]))
        widest = float(np.nanmax(np.arccos(np.clip(rays.direction[rays.ok, 2], -1.0, 1.0))))
        start = start_from_camera(pictures, target, as_perspective(equidistant, other.camera.lens, widest))
    except InputError:
        return other
    seen = list(zip(start.T_cam_target, pictures, strict=True))
    if not all(_images_all(start.camera, T, dots, target) for T, dots in seen):
        return other
    off = [_residual(one.camera, pictures, target) for one in (start, other)]
    return start if not off[1] <= off[0] else other


def _images_all(camera: Camera, T_cam_target: Pose, dots: Detections, target: Target) -> bool:
    return bool(camera.project(transform(T_cam_target, target.points(dots.index))).ok.all())


def _by_affine_maps(pictures: list[Detections], target: Target, lens: str) -> LensStart:
    """Start a lens with parallel rays without distortion: every view's affine map tells its scale."""
    size = pictures[0].picture_size(pictures[0].cameras[0])
    try:
        maps = [affine_map(dots.position, target.points(dots.index)[:, :2]) for dots in pictures]
    except InputError as error:
        raise InputError(
            f"The dots of camera '{pictures[0].cameras[0]}' determine no camera ({error}) Every view needs "
            "dots of several rows and columns, and the views different tilts."
        ) from error
    scale = float(np.median([plane_scale(found[:, :2]) for found in maps]))
    kind = camera_of_lens(lens, size, None)
    K = np.array([[scale, 0.0, 0.5 * (size[0] - 1)], [0.0, scale, 0.5 * (size[1] - 1)], [0.0, 0.0, 1.0]])
    return start_from_camera(pictures, target, replace(kind, K=K))


def _by_scan(pictures: list[Detections], target: Target, lens: str) -> LensStart:
    """Start any lens without distortion, with the focal length at which flat targets look flat."""
    scanned = pictures[:: -(-len(pictures) // _SCAN_VIEWS)]
    size = pictures[0].picture_size(pictures[0].cameras[0])
    kind = camera_of_lens(lens, size, None)
    widest = _WIDEST_FLAT_DEG if kind.model.rectilinear else 180.0
    half_fields = np.radians([field for field in _HALF_FIELDS_DEG if field < widest])
    candidates = [camera_with_field(kind, half_field) for half_field in half_fields]
    residuals = [_residual(camera, scanned, target) for camera in candidates]
    if not np.isfinite(residuals).any():
        raise InputError(
            f"The dots of camera '{pictures[0].cameras[0]}' determine no camera. Every view needs dots of "
            "several rows and columns, and the views different tilts."
        )
    return start_from_camera(pictures, target, candidates[int(np.nanargmin(residuals))])


def _residual(camera: Camera, pictures: list[Detections], target: Target) -> float:
    """Return the RMS reprojection error over pictures in px, relative to their size there; NaN for none."""
    try:
        poses = _poses(camera, pictures, target)
    except InputError:
        return float("nan")
    squares = []
    for T, dots in zip(poses, pictures, strict=True):
        p = transform(T, target.points(dots.index))
        squares.append(((camera.project(p).q - dots.position) ** 2).sum(axis=1))
    return float(np.sqrt(np.concatenate(squares).mean()))


def _poses(camera: Camera, pictures: list[Detections], target: Target) -> Float64[np.ndarray, "views 4 4"]:
    """Return the poses of the target from the rays of its dots, which are traced all at once."""
    rays = camera.rays(np.concatenate([dots.position for dots in pictures]))
    if camera.model.parallel:
        depth = depth_held_mm(camera, float(np.sqrt(camera.intrinsics[0] * camera.intrinsics[1])))
        found, first = [], 0
        for dots in pictures:
            seen = slice(first, first + len(dots))
            ok, first = rays.ok[seen], seen.stop
            plane = target.points(dots.index)[ok, :2]
            found.append(parallel_plane_pose(rays.origin[seen][ok, :2], plane, depth))
        return np.stack(found)
    ends = np.cumsum([len(dots) for dots in pictures])[:-1]
    split = zip(pictures, np.split(rays.direction, ends), np.split(rays.ok, ends), strict=True)
    return np.stack([_pose(dots, directions, ok, target) for dots, directions, ok in split])


def _pose(dots: Detections, directions: Vectors3, ok: Mask, target: Target) -> Pose:
    view, name = dots.view[0], dots.camera[0]
    if not ok.any():
        raise InputError(f"Camera '{name}' sees view '{view}' beyond its lens's field.")
    try:
        return plane_pose(directions[ok], target.points(dots.index)[ok, :2])
    except InputError as error:
        raise InputError(
            f"The dots of camera '{name}' determine no camera: view '{view}' shows too little of the target "
            f"({error}) Every view needs dots of several rows and columns, and the views different tilts."
        ) from error
