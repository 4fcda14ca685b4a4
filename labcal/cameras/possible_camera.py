"""Refusal of parts that make no camera."""

from typing import TYPE_CHECKING

import numpy as np

from labcal.cameras.lens import LENGTH, PRESCRIPTION
from labcal.cameras.window import FlatWindow
from labcal.errors import InputError
from labcal.geometry.poses import require_rigid

if TYPE_CHECKING:
    from labcal.cameras.camera import Camera


def require_possible(camera: "Camera") -> None:
    """Raise where the parts of a camera make none.

    Raises
    ------
    InputError
        The camera matrix, the pose, the size or the coefficients are not of the form that they must have, or
        two parts exclude each other.
    UnknownNameError
        There is no such lens model.
    """
    if (camera.lens == PRESCRIPTION) != (camera.prescription is not None):
        raise InputError(
            f"A camera has a prescription if its lens is '{PRESCRIPTION}', and only then; here the lens "
            f"is '{camera.lens}'. Set lens to '{PRESCRIPTION}', or leave out the prescription."
        )
    model = camera.model
    fx, fy, cx, cy = camera.intrinsics
    expected = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    if not (np.isfinite(camera.K).all() and np.array_equal(camera.K, expected) and min(fx, fy) > 0):
        raise InputError(
            "K must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] with positive focal lengths in pixels."
        )
    if len(camera.dist) < LENGTH or not np.isfinite(camera.dist).all():
        raise InputError(f"dist must hold at least {LENGTH} finite coefficients; pad it with zeros.")
    if np.any(camera.dist[model.coefficients :] != 0.0):
        raise InputError(
            f"The lens model '{camera.lens}' has {model.coefficients} coefficients; the rest of dist must "
            "be 0. Shorten dist, or choose another lens."
        )
    if camera.prescription is not None and fx != fy:
        raise InputError("A lens prescription images round things round: fx and fy must be equal.")
    if model.parallel and isinstance(camera.window, FlatWindow):
        raise InputError(
            f"A flat window leaves the rays of the lens '{camera.lens}' parallel: it is no more than "
            "another place of the camera. Leave the window out."
        )
    if min(camera.size) < 1:
        raise InputError(f"The picture size must be positive, but is {camera.size[0]} x {camera.size[1]}.")
    require_rigid(camera.T_cam_world, "T_cam_world")
