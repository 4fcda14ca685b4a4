"""Calibration of cameras from a hand-held target, by OpenCV (Zhang 2000): target poses are free.

Each camera's lens comes from all views that it measured. Its place in the rig then comes from the views
that it shares with the first camera, whose frame is the world, with the lenses held.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.arrays import Pose
from labcal.cameras.brown import LENGTH
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.matching import require_on_target
from labcal.errors import InputError, UnknownNameError
from labcal.geometry.poses import from_rotation_vector, pose
from labcal.solve.opencv_threads import one_opencv_thread
from labcal.targets.grid import DotGrid

_TERMINATION = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-12)
_LENS_FLAGS = {
    "pinhole": cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3,
    "brown-k1k2": cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K3,
    "brown5": 0,
}
MIN_DOTS = 8
"""Dots that a view needs to enter: a homography takes four, and a lens wants more than it leaves over."""
MIN_VIEWS = 3
"""Views that a camera needs: two fix four intrinsics of a plane target, the third checks them."""


@dataclass(frozen=True)
class CameraFit:
    """How well one camera's lens explains its own dots."""

    rms_px: float
    """OpenCV's: root mean square of the 2-D distance."""
    views: tuple[str, ...]
    dots: int


@dataclass(frozen=True)
class HandheldCalibration:
    """A rig whose world is the first camera, and where the target was."""

    rig: Rig
    fits: dict[str, CameraFit]
    """By camera."""
    rms_px: float
    """Over all cameras, in the rig; of the one camera where there is only one."""
    T_world_target: dict[str, Pose]
    """Target pose by view, for the views of the first camera, mm."""
    skipped: tuple[str, ...]
    """What did not enter, each with its reason, for people."""


@dataclass(frozen=True)
class _Lens:
    fit: CameraFit
    K: np.ndarray
    dist: np.ndarray
    T_cam_target: dict[str, Pose]


def require_handheld_lens(lens: str) -> None:
    """Raise where a hand-held target cannot calibrate a lens model.

    Raises
    ------
    UnknownNameError
        It is not among those that this file knows.
    """
    if lens not in _LENS_FLAGS:
        raise UnknownNameError("lens model for a hand-held target", lens, _LENS_FLAGS)


@one_opencv_thread()
def calibrate_handheld(detections: Detections, target: DotGrid, lens: str) -> HandheldCalibration:
    """Calibrate every camera in the detections, and their places relative to the first.

    Parameters
    ----------
    detections : Detections
        Only dots flagged ``ok`` enter.
    target : DotGrid
        Its dots are taken as flat and exactly placed.
    lens : str
        ``pinhole``, ``brown-k1k2`` or ``brown5``.

    Raises
    ------
    UnknownNameError
        There is no such lens model here.
    InputError
        A dot is not on the target, a camera has too few views or shares too few with the first camera, or the
        dots determine no camera.
    """
    require_handheld_lens(lens)
    usable = detections.where(detections.ok)
    if len(usable) == 0:
        raise InputError("There are no dots with ids to calibrate with. See the flags in the detections.")
    require_on_target(usable, target)
    skipped: list[str] = []
    lenses = {name: _calibrate_lens(usable, name, target, lens, skipped) for name in usable.cameras}
    first, *others = usable.cameras
    cameras = {first: _camera(lenses[first], lens, np.eye(4), usable.picture_size(first))}
    squares, count = lenses[first].fit.rms_px ** 2 * lenses[first].fit.dots, lenses[first].fit.dots
    if others:
        squares, count = 0.0, 0
    for other in others:
        T_other_first, rms, dots = _relative_pose(usable, (first, other), target, lenses)
        cameras[other] = _camera(lenses[other], lens, T_other_first, usable.picture_size(other))
        squares, count = squares + rms**2 * dots, count + dots
    return HandheldCalibration(
        rig=Rig.of(cameras),
        fits={name: found.fit for name, found in lenses.items()},
        rms_px=float(np.sqrt(squares / count)),
        T_world_target=lenses[first].T_cam_target,
        skipped=tuple(skipped),
    )


def _camera(found: _Lens, lens: str, T_cam_world: Pose, size: tuple[int, int]) -> Camera:
    return Camera(found.K, lens, found.dist, T_cam_world, size)


def _calibrate_lens(usable: Detections, camera: str, target: DotGrid, lens: str, skipped: list[str]) -> _Lens:
    """Calibrate one camera from all its views."""
    views, points, pixels = [], [], []
    for view in usable.views:
        dots = usable.where((usable.camera == camera) & (usable.view == view))
        if 0 < len(dots) < MIN_DOTS:
            skipped.append(
                f"view '{view}' of camera '{camera}': only {len(dots)} dots, at least {MIN_DOTS} are needed"
            )
        if len(dots) >= MIN_DOTS:
            views.append(view)
            points.append(target.points(dots.index).astype(np.float32))
            pixels.append(dots.position.astype(np.float32))
    if len(views) < MIN_VIEWS:
        raise InputError(
            f"Camera '{camera}' has {len(views)} usable views, but needs {MIN_VIEWS} at different tilts."
        )
    size = usable.picture_size(camera)
    try:
        rms, K, dist, rotations, translations = cv2.calibrateCamera(
            points, pixels, size, np.eye(3), np.zeros(LENGTH), flags=_LENS_FLAGS[lens], criteria=_TERMINATION
        )
    except cv2.error as error:
        raise InputError(
            f"The dots of camera '{camera}' determine no camera ({error.err}). Every view needs dots of "
            "several rows and columns, and the views different tilts."
        ) from error
    poses = [from_rotation_vector(r.ravel(), t.ravel()) for r, t in zip(rotations, translations, strict=True)]
    return _Lens(
        fit=CameraFit(float(rms), tuple(views), sum(map(len, points))),
        K=np.asarray(K, dtype=np.float64),
        dist=np.asarray(dist, dtype=np.float64).ravel()[:LENGTH],
        T_cam_target=dict(zip(views, poses, strict=True)),
    )


def _relative_pose(
    usable: Detections, pair: tuple[str, str], target: DotGrid, lenses: dict[str, _Lens]
) -> tuple[Pose, float, int]:
    """Return the second camera's ``T_other_first``, the pair's rms and its number of dots."""
    points, pixels_a, pixels_b = [], [], []
    for view in usable.views:
        a, b = (usable.where((usable.camera == camera) & (usable.view == view)) for camera in pair)
        _, in_a, in_b = np.intersect1d(_keys(a), _keys(b), return_indices=True)
        if len(in_a) >= MIN_DOTS:
            points.append(target.points(a.index[in_a]).astype(np.float32))
            pixels_a.append(a.position[in_a].astype(np.float32))
            pixels_b.append(b.position[in_b].astype(np.float32))
    if not points:
        raise InputError(
            f"Cameras '{pair[0]}' and '{pair[1]}' share no view with at least {MIN_DOTS} dots in both. "
            "Shoot the target where both cameras see it, and check that --cameras names the pairs."
        )
    found_a, found_b = lenses[pair[0]], lenses[pair[1]]
    rms, _, _, _, _, R, t, _, _ = cv2.stereoCalibrate(
        points, pixels_a, pixels_b, found_a.K, found_a.dist, found_b.K, found_b.dist,
        usable.picture_size(pair[0]), flags=cv2.CALIB_FIX_INTRINSIC, criteria=_TERMINATION,
    )  # fmt: skip
    return pose(np.asarray(R), np.asarray(t).ravel()), float(rms), 2 * sum(map(len, points))


def _keys(dots: Detections) -> np.ndarray:
    """Return one integer a dot."""
    return np.asarray(dots.index[:, 1] * 1_000_000 + dots.index[:, 0])
