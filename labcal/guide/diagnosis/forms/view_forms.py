"""Normal equations of views, in which all cameras see the target in one pose."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose
from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.rig_start import placed_cameras
from labcal.calibrate.single_calibration import SingleCalibration
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.poses import inverse
from labcal.guide.diagnosis.forms.picture_forms import SHAPE, PictureForms

_RIDGE = 1e-12


@dataclass(frozen=True)
class ViewForms:
    """Products of columns of each view, the pose of the target eliminated.

    Columns: of each camera its pose (turn and shift along its axes), its lens, the pose times the height in
    the picture; then the shape of the board, which all cameras see; last the residual.

    Attributes
    ----------
    cameras : tuple of SingleCalibration
    T_cam_world : tuple of ndarray
        Poses of the cameras, by most views; the first one is the world.
    lens : tuple of int
        Numbers of the lenses' parameters.
    products : float64 array, (views, columns, columns)
    dots : float64 array, (cameras, views)
        Numbers of dots of each picture.
    """

    cameras: tuple[SingleCalibration, ...]
    T_cam_world: tuple[Pose, ...]
    lens: tuple[int, ...]
    products: Float64[np.ndarray, "views columns columns"]
    dots: Float64[np.ndarray, "cameras views"]

    @classmethod
    def of(cls, cameras: Sequence[SingleCalibration], views: int) -> "ViewForms":
        """Return the forms of cameras that are calibrated alone.

        Parameters
        ----------
        cameras : sequence of SingleCalibration
            With the numbers of their views among those of the rig.
        views : int
            Number of views of the rig.

        Raises
        ------
        InputError
            A camera shares no view with the others.
        """
        forms = [PictureForms.of(camera) for camera in cameras]
        placed = placed_cameras([camera.single for camera in cameras])
        lens = tuple(form.lens for form in forms)
        width = sum(2 * POSE + one for one in lens) + SHAPE + 1
        whole = np.zeros((views, POSE + width, POSE + width))
        counts = np.zeros((len(forms), views))
        world = _world_poses(cameras, placed, views)
        shape = np.arange(POSE + width - SHAPE - 1, POSE + width - 1)
        start = POSE
        for number, (form, T_cam_world) in enumerate(zip(forms, placed, strict=True)):
            single = form.camera.single
            of_pose = np.arange(start, start + POSE)
            of_lens = np.arange(start + POSE, start + POSE + form.lens)
            of_row = np.arange(
                of_lens[-1] + 1 if form.lens else of_pose[-1] + 1, start + 2 * POSE + form.lens
            )
            for at, view in enumerate(single.views.tolist()):
                moves = np.zeros((form.products.shape[1], POSE + width))
                tied = T_cam_world @ world[view]
                R = T_cam_world[:3, :3]
                moves[:3, :3] = moves[3:6, 3:6] = R
                moves[np.arange(POSE), of_pose] = 1.0
                arm = R @ world[view][:3, 3]
                moves[3:6, of_pose[:3]] = -cross_matrices(arm[None])[0]
                moves[:POSE, -1] = _difference(tied, single.T_cam_target[at])
                moves[POSE + np.arange(form.lens), of_lens] = 1.0
                moves[POSE + form.lens + np.arange(SHAPE), shape] = 1.0
                moves[POSE + form.lens + SHAPE + np.arange(POSE), of_row] = 1.0
                moves[-1, -1] = 1.0
                whole[view] += moves.T @ form.products[at] @ moves
                counts[number, view] = form.dots[at]
            start += 2 * POSE + form.lens
        return cls(tuple(cameras), tuple(placed), lens, _eliminated(whole), counts)

    @property
    def views(self) -> int:
        """Number of views."""
        return len(self.products)

    def pose(self, camera: int) -> slice:
        """Return the columns of a camera's pose."""
        start = sum(2 * POSE + one for one in self.lens[:camera])
        return slice(start, start + POSE)

    def lens_of(self, camera: int) -> slice:
        """Return the columns of a camera's lens."""
        start = self.pose(camera).stop
        return slice(start, start + self.lens[camera])

    def rows_of(self, camera: int) -> slice:
        """Return the columns of a camera's pose times the height in its picture."""
        start = self.lens_of(camera).stop
        return slice(start, start + POSE)

    @property
    def shape(self) -> slice:
        """Return the columns of the board's shape."""
        return slice(self.products.shape[1] - SHAPE - 1, self.products.shape[1] - 1)


def _world_poses(
    cameras: Sequence[SingleCalibration], placed: Sequence[Pose], views: int
) -> Float64[np.ndarray, "views 4 4"]:
    """Return ``T_world_target`` by the first camera that sees each view."""
    world = np.full((views, 4, 4), np.nan)
    for camera, T_cam_world in zip(cameras, placed, strict=True):
        new = np.isnan(world[camera.single.views, 0, 0])
        world[camera.single.views[new]] = inverse(T_cam_world) @ camera.single.T_cam_target[new]
    return world


def _difference(T: Pose, reference: Pose) -> Float64[np.ndarray, "6"]:
    """Return the turn and the shift that take the reference to a pose."""
    turn = Rotation.from_matrix(T[:3, :3] @ reference[:3, :3].T).as_rotvec()
    return np.concatenate([turn, T[:3, 3] - reference[:3, 3]])


def _eliminated(whole: Float64[np.ndarray, "views all all"]) -> Float64[np.ndarray, "views columns columns"]:
    """Return the products with the poses of the target eliminated."""
    found = np.zeros((len(whole), whole.shape[1] - POSE, whole.shape[1] - POSE))
    for view, products in enumerate(whole):
        own = products[:POSE, :POSE]
        scale = 1.0 / np.sqrt(np.maximum(np.diagonal(own), 1e-300))
        if not np.diagonal(own).any():
            continue
        inverted = np.linalg.pinv(own * np.outer(scale, scale), rcond=_RIDGE, hermitian=True)
        cross = products[:POSE, POSE:] * scale[:, None]
        found[view] = products[POSE:, POSE:] - cross.T @ inverted @ cross
    return found
