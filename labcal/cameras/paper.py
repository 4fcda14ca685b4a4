"""The camera of "Applying neural networks in 3-D vision", Eq. 1 to 11, and its converter.

The paper prints the last row of G (Eq. 3) as ``0 0 1 1``. With that row the model is no camera; it is a
misprint of ``0 0 0 1``, which stands here.
"""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Mask, Matrix3, Pixels, Vectors3, Pose
from labcal.cameras.camera import Camera
from labcal.cameras.opencv_model import PERSPECTIVE
from labcal.errors import InputError
from labcal.geometry.poses import inverse

_TURN = np.diag([-1.0, -1.0, 1.0])
"""The paper's image is inverted: its frame is OpenCV's turned by 180 degrees about the view."""


def _rotation(pan: float, tilt: float) -> Matrix3:
    """Return R of Eq. 4."""
    ct, st, ca, sa = np.cos(pan), np.sin(pan), np.cos(tilt), np.sin(tilt)
    return np.array([[ct, st, 0.0], [-st * ca, ct * ca, sa], [st * sa, -ct * sa, ca]])


@dataclass(frozen=True)
class PaperCamera:
    """A pinhole camera on a gimbal, as Eq. 1 to 11 have it.

    Parameters
    ----------
    focal_length_mm : float
        lambda of Eq. 2. The image plane lies at z = 0 of the camera frame, the lens centre at z = lambda.
    gimbal_mm : ndarray, shape (3,)
        (X0, Y0, Z0) of Eq. 3 (with the misprint corrected), the gimbal in the world.
    pan_rad, tilt_rad : float
        theta and alpha of Eq. 4. A camera that looks down has a tilt beyond 90 degrees.
    displacement_mm : ndarray, shape (3,)
        (r1, r2, r3) of Eq. 5, the image plane's place as seen from the gimbal.
    """

    focal_length_mm: float
    gimbal_mm: np.ndarray
    pan_rad: float
    tilt_rad: float
    displacement_mm: np.ndarray

    def __post_init__(self) -> None:
        if not self.focal_length_mm > 0:
            raise InputError(f"The focal length must be positive, but is {self.focal_length_mm} mm.")

    @property
    def matrix(self) -> Pose:
        """The product P C R G of Eq. 1, shape (4, 4); not rigid."""
        G, R, C, P = np.eye(4), np.eye(4), np.eye(4), np.eye(4)
        G[:3, 3] = -self.gimbal_mm
        R[:3, :3] = _rotation(self.pan_rad, self.tilt_rad)
        C[:3, 3] = -self.displacement_mm
        P[3, 2] = -1.0 / self.focal_length_mm
        product: np.ndarray = P @ C @ R @ G
        return product

    def project(self, p: Vectors3) -> tuple[Pixels, Mask]:
        """Return image coordinates (Eq. 8 to 11) and whether each point lies in front of the lens.

        Parameters
        ----------
        p : ndarray, shape (..., 3)
            World points, mm.

        Returns
        -------
        image : ndarray, shape (..., 2)
            Millimetres on the image plane, inverted as behind a real lens; NaN where not `ok`.
        ok : ndarray of bool, shape (...)
        """
        homogeneous = np.concatenate([p, np.ones((*p.shape[:-1], 1))], axis=-1) @ self.matrix.T
        ok = homogeneous[..., 3] < 0.0  # 1 - Z / lambda
        with np.errstate(divide="ignore", invalid="ignore"):
            image = homogeneous[..., :2] / homogeneous[..., 3:]
        return np.where(ok[..., None], image, np.nan), ok

    def camera(
        self, pixel_pitch_mm: float, principal_point: tuple[float, float], size: tuple[int, int]
    ) -> Camera:
        """Return the same camera in OpenCV's terms; exact.

        Parameters
        ----------
        pixel_pitch_mm : float
            Distance of pixels on the sensor.
        principal_point : (float, float)
            Pixel at which the image plane's origin falls.
        size : (int, int)
            Width and height in pixels.
        """
        f = self.focal_length_mm / pixel_pitch_mm
        K = np.array([[f, 0.0, principal_point[0]], [0.0, f, principal_point[1]], [0.0, 0.0, 1.0]])
        R = _rotation(self.pan_rad, self.tilt_rad)
        lens_centre = np.array([0.0, 0.0, self.focal_length_mm])
        T_cam_world = np.eye(4)
        T_cam_world[:3, :3] = _TURN @ R
        T_cam_world[:3, 3] = _TURN @ (-R @ self.gimbal_mm - self.displacement_mm - lens_centre)
        return Camera(K, "pinhole", np.zeros(5), T_cam_world, size)


def paper_camera(camera: Camera, pixel_pitch_mm: float) -> PaperCamera:
    """Return a pinhole camera in the paper's terms, with r = 0.

    Parameters
    ----------
    camera : Camera
        A pinhole without roll and with fx = fy.
    pixel_pitch_mm : float
        Distance of pixels on the sensor; sets the scale of lambda.

    Raises
    ------
    InputError
        The camera has distortion, fx other than fy, or roll: the paper's model cannot hold it.
    """
    fx, fy, _, _ = camera.intrinsics
    if camera.model.opencv is not PERSPECTIVE or np.any(camera.dist != 0.0) or camera.window is not None:
        raise InputError(
            f"The paper's camera has no lens distortion, but this one is '{camera.lens}'"
            f"{'' if camera.window is None else ' behind a window'}."
        )
    if fx != fy:
        raise InputError(
            f"The paper's camera has one focal length, but this one has fx = {fx} and fy = {fy} px."
        )
    R = _TURN @ camera.T_cam_world[:3, :3]
    pan = float(np.arctan2(R[0, 1], R[0, 0]))
    tilt = float(np.arctan2(R[1, 2], R[2, 2]))
    if not np.allclose(R, _rotation(pan, tilt), rtol=0.0, atol=1e-9):
        roll = float(np.degrees(np.arcsin(np.clip(R[0, 2], -1.0, 1.0))))
        raise InputError(
            "The paper's camera pans and tilts but has no roll: the x axis of its picture stays parallel to "
            f"the world's x-y plane, and this camera's leaves it by {roll:.6g} degrees."
        )
    focal_length = fx * pixel_pitch_mm
    lens_centre = inverse(camera.T_cam_world)[:3, 3]
    gimbal = lens_centre - R.T @ np.array([0.0, 0.0, focal_length])
    return PaperCamera(focal_length, gimbal, pan, tilt, np.zeros(3))
