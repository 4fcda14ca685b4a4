"""Calibration of cameras from a hand-held target, by OpenCV (Zhang 2000): target poses are free.

Each camera's lens comes from all views that it measured. Its place in the rig comes from the views that it
shares with the first camera, whose frame is the world. Of a pair, the lenses are refined in that step too:
views from a narrow field leave much open that the other camera settles.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENGTH
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.matching import require_on_target
from labcal.errors import InputError, UnknownNameError
from labcal.geometry.poses import pose
from labcal.solve.opencv_threads import one_opencv_thread
from labcal.targets.target import Target

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
    """How well one camera explains its dots."""

    rms_px: float
    """Calibrated alone; OpenCV's: root mean square of the 2-D distance."""
    rms_in_rig_px: float
    """The same in the rig, over the dots shared with the first camera."""
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
    skipped: tuple[str, ...]
    """What did not enter, each with its reason, for people."""


@dataclass(frozen=True)
class _Alone:
    """One camera calibrated from its own dots."""

    rms_px: float
    K: np.ndarray
    dist: np.ndarray
    views: tuple[str, ...]
    dots: int


@dataclass(frozen=True)
class _Pair:
    """A camera and the first one, calibrated together."""

    K: tuple[np.ndarray, np.ndarray]
    dist: tuple[np.ndarray, np.ndarray]
    T_other_first: Pose
    rms_px: tuple[float, float]
    dots: int
    """In each camera."""


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
def calibrate_handheld(detections: Detections, target: Target, lens: str) -> HandheldCalibration:
    """Calibrate every camera in the detections, and their places relative to the first.

    Parameters
    ----------
    detections : Detections
        Only dots flagged ``ok`` enter.
    target : Target
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
    first, *others = usable.cameras
    # Of several pairs each would refine the first camera's lens to its own liking.
    flags = cv2.CALIB_USE_INTRINSIC_GUESS | _LENS_FLAGS[lens] if len(others) == 1 else cv2.CALIB_FIX_INTRINSIC
    alone = {name: _calibrate_alone(usable, name, target, lens, skipped) for name in usable.cameras}
    pairs = {other: _calibrate_pair(usable, (first, other), target, alone, flags) for other in others}
    return _assemble(usable, lens, alone, pairs, tuple(skipped))


def _assemble(
    usable: Detections, lens: str, alone: dict[str, _Alone], pairs: dict[str, _Pair], skipped: tuple[str, ...]
) -> HandheldCalibration:
    """Return the rig and its figures."""
    first = usable.cameras[0]
    K, dist, rms_first = alone[first].K, alone[first].dist, alone[first].rms_px
    squares, count = rms_first**2 * alone[first].dots, alone[first].dots
    if pairs:
        one = next(iter(pairs.values()))
        K, dist = one.K[0], one.dist[0]
        squares = sum((pair.rms_px[0] ** 2 + pair.rms_px[1] ** 2) * pair.dots for pair in pairs.values())
        count = 2 * sum(pair.dots for pair in pairs.values())
        rms_first = max(pair.rms_px[0] for pair in pairs.values())
    cameras = {first: Camera(K, lens, dist, np.eye(4), usable.picture_size(first))}
    for name, pair in pairs.items():
        cameras[name] = Camera(pair.K[1], lens, pair.dist[1], pair.T_other_first, usable.picture_size(name))
    in_rig = {first: rms_first} | {name: pair.rms_px[1] for name, pair in pairs.items()}
    return HandheldCalibration(
        rig=Rig.of(cameras),
        fits={
            name: CameraFit(found.rms_px, in_rig[name], found.views, found.dots)
            for name, found in alone.items()
        },
        rms_px=float(np.sqrt(squares / count)),
        skipped=skipped,
    )


def _calibrate_alone(
    usable: Detections, camera: str, target: Target, lens: str, skipped: list[str]
) -> _Alone:
    """Calibrate one camera from all its views."""
    views, points, pixels = [], [], []
    for view in usable.views:
        dots = usable.where((usable.camera == camera) & (usable.view == view))
        if 0 < len(dots) < MIN_DOTS:
            few = f"only {len(dots)} dots, at least {MIN_DOTS} are needed"
            skipped.append(f"view '{view}' of camera '{camera}': {few}")
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
        rms, K, dist, _, _ = cv2.calibrateCamera(
            points, pixels, size, np.eye(3), np.zeros(LENGTH), flags=_LENS_FLAGS[lens], criteria=_TERMINATION
        )
    except cv2.error as error:
        raise InputError(
            f"The dots of camera '{camera}' determine no camera ({error.err}). Every view needs dots of "
            "several rows and columns, and the views different tilts."
        ) from error
    return _Alone(float(rms), _matrix(K), _coefficients(dist), tuple(views), sum(map(len, points)))


def _calibrate_pair(
    usable: Detections, names: tuple[str, str], target: Target, alone: dict[str, _Alone], flags: int
) -> _Pair:
    """Calibrate the second camera's place relative to the first, and what else `flags` leave free."""
    points, pixels_a, pixels_b = [], [], []
    for view in usable.views:
        a, b = (usable.where((usable.camera == name) & (usable.view == view)) for name in names)
        _, in_a, in_b = np.intersect1d(_keys(a), _keys(b), return_indices=True)
        if len(in_a) >= MIN_DOTS:
            points.append(target.points(a.index[in_a]).astype(np.float32))
            pixels_a.append(a.position[in_a].astype(np.float32))
            pixels_b.append(b.position[in_b].astype(np.float32))
    if not points:
        raise InputError(
            f"Cameras '{names[0]}' and '{names[1]}' share no view with at least {MIN_DOTS} dots in both. "
            "Shoot the target where both cameras see it, and check that --cameras names the pairs."
        )
    start_a, start_b = (alone[name] for name in names)
    found = cv2.stereoCalibrateExtended(
        points, pixels_a, pixels_b,
        start_a.K.copy(), start_a.dist.copy(), start_b.K.copy(), start_b.dist.copy(),
        usable.picture_size(names[0]), np.eye(3), np.zeros(3), flags=flags, criteria=_TERMINATION,
    )  # fmt: skip
    _, K_a, dist_a, K_b, dist_b, R, t = found[:7]
    counts = np.array([len(p) for p in points])
    mean_squares = counts @ np.asarray(found[-1]) ** 2 / counts.sum()
    return _Pair(
        K=(_matrix(K_a), _matrix(K_b)),
        dist=(_coefficients(dist_a), _coefficients(dist_b)),
        T_other_first=pose(np.asarray(R), np.asarray(t).ravel()),
        rms_px=(float(np.sqrt(mean_squares[0])), float(np.sqrt(mean_squares[1]))),
        dots=int(counts.sum()),
    )


def _matrix(K: object) -> np.ndarray:
    return np.asarray(K, dtype=np.float64)


def _coefficients(dist: object) -> np.ndarray:
    return np.asarray(dist, dtype=np.float64).ravel()[:LENGTH]


def _keys(dots: Detections) -> np.ndarray:
    """Return one integer a dot."""
    return np.asarray(dots.index[:, 1] * 1_000_000 + dots.index[:, 0])
