"""Ideal cameras in the place of real ones: alone, and as a pair whose rows are aligned.

They are pinholes; in the place of a camera with parallel rays stands one with the same lens, undistorted.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Matrix3, Pixels
from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENGTH
from labcal.errors import InputError
from labcal.geometry.poses import pose

WIDEST_DEG = 60.0
"""Largest angle to an ideal camera's axis; the rest is cut: at 60 degrees the stretch is fourfold."""
_LATTICE = 129
_MOST_PIXELS = 2**26
_LENS = "pinhole"


@dataclass(frozen=True)
class _Field:
    """Field of view of a camera on the plane at unit distance of an ideal one: least and greatest x and y."""

    least: np.ndarray
    greatest: np.ndarray


def ideal_camera(camera: Camera) -> Camera:
    """Return the ideal camera with this one's place, matrix and picture size; the middle keeps its scale."""
    lens = camera.lens if camera.model.parallel else _LENS
    return Camera(camera.K, lens, np.zeros(LENGTH), camera.T_cam_world, camera.size)


def whole_ideal_camera(camera: Camera) -> Camera:
    """Return the pinhole whose picture shows all that the camera sees within :data:`WIDEST_DEG` of the axis.

    Square pixels of the mean of both focal lengths; the picture is as large as that takes.

    Raises
    ------
    InputError
        The camera sees nothing there, its rays are parallel, or the picture would be too large.
    """
    _refuse_parallel([camera], "`whole`")
    R = camera.T_cam_world[:3, :3]
    focal = _mean_focal([camera])
    field = _field(camera, R)
    return _placed([camera], R, focal, [field])[0]


def rectified_pair(first: Camera, second: Camera) -> tuple[Camera, Camera]:
    """Return two pinholes with one orientation and one focal length whose rows are aligned.

    Their x runs along the baseline, their z as nearly along both optical axes as that allows (Fusiello,
    Trucco and Verri 2000). The focal length is the geometric mean of all, so that the middle keeps its scale;
    all that either camera sees within :data:`WIDEST_DEG` of the new axis is in the pictures, which are of one
    size.

    Raises
    ------
    InputError
        Both cameras are at one place, the second lies ahead of the first, their rays are parallel, or the
        pictures would be too large.
    """
    _refuse_parallel([first, second], "`rectify`")
    baseline = second.centre - first.centre
    axes = [camera.T_cam_world[:3, :3] for camera in (first, second)]
    forward = axes[0][2] + axes[1][2]
    length = float(np.linalg.norm(baseline))
    across = np.cross(forward, baseline)
    if length == 0.0 or np.linalg.norm(across) < np.cos(np.radians(WIDEST_DEG)) * length * np.linalg.norm(
        forward
    ):
        raise InputError(
            "These two cameras cannot be rectified: they are at one place, or one is ahead of the other and "
            "not beside it. Undistort them without `rectify=True`."
        )
    x = baseline / length
    if x @ (axes[0][0] + axes[1][0]) < 0.0:
        x = -x
    z = forward - (forward @ x) * x
    z /= np.linalg.norm(z)
    R = np.stack([x, np.cross(z, x), z])
    cameras = [first, second]
    left, right = _placed(cameras, R, _mean_focal(cameras), [_field(camera, R) for camera in cameras])
    return left, right


def _refuse_parallel(cameras: Sequence[Camera], option: str) -> None:
    """Raise where rays are parallel, in whose place there is no pinhole."""
    for camera in cameras:
        if camera.model.parallel:
            raise InputError(
                f"The lens '{camera.lens}' has parallel rays, and no pinhole sees what it sees. Undistort "
                f"without {option}."
            )


def _mean_focal(cameras: Sequence[Camera]) -> float:
    """Return the geometric mean of the focal lengths, px."""
    return float(np.exp(np.mean([np.log(camera.intrinsics[:2]) for camera in cameras])))


def _field(camera: Camera, R_new_world: Matrix3) -> _Field:
    """Return what a camera sees along the axes of `R_new_world`."""
    direction = camera.rays(_lattice(camera)).direction @ R_new_world.T
    near = direction[direction[:, 2] > np.cos(np.radians(WIDEST_DEG))]
    if len(near) == 0:
        raise InputError(
            f"A camera sees nothing within {WIDEST_DEG:g} degrees of the axis of its ideal one. Undistort it "
            "without `rectify=True`."
        )
    seen = near[:, :2] / near[:, 2:]
    return _Field(seen.min(axis=0), seen.max(axis=0))


def _lattice(camera: Camera) -> Pixels:
    """Return pixels all over a picture, its outer ones included."""
    width, height = camera.size
    u, v = np.meshgrid(np.linspace(0.0, width - 1.0, _LATTICE), np.linspace(0.0, height - 1.0, _LATTICE))
    return np.stack([u.ravel(), v.ravel()], axis=-1)


def _placed(cameras: Sequence[Camera], R: Matrix3, focal: float, fields: Sequence[_Field]) -> list[Camera]:
    """Return pinholes at the cameras' places that see these fields, all with the same rows."""
    top = min(field.least[1] for field in fields)
    bottom = max(field.greatest[1] for field in fields)
    width = 1 + int(np.ceil(focal * max(field.greatest[0] - field.least[0] for field in fields)))
    height = 1 + int(np.ceil(focal * (bottom - top)))
    if width * height > _MOST_PIXELS:
        raise InputError(
            f"The ideal picture would have {width} x {height} pixels, more than any picture may have. "
            "Undistort smaller pictures, or leave out `whole` and `rectify`."
        )
    placed = []
    for camera, field in zip(cameras, fields, strict=True):
        K = np.array([[focal, 0.0, -focal * field.least[0]], [0.0, focal, -focal * top], [0.0, 0.0, 1.0]])
        T = pose(R, -R @ camera.centre)
        placed.append(Camera(K, _LENS, np.zeros(LENGTH), T, (width, height)))
    return placed
