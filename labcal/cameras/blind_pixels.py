"""Notes on pixels that see no direction, and refusal of them."""

import numpy as np

from labcal.cameras.camera import Camera
from labcal.errors import InputError


def blind_pixels(name: str, camera: Camera) -> str | None:
    """Return a note where some pixels of a camera see no direction; None where all do.

    Parameters
    ----------
    name : str
        The camera's.
    camera : Camera
    """
    share = camera.share_without_rays
    if share == 0.0:
        return None
    return (
        f"{100.0 * share:.1f}% of the picture of {name} sees no direction: the lens '{camera.lens}' folds "
        "there, or the picture reaches beyond its field. Points there are lost; if the picture is not black "
        "there, take pictures with dots up to its corners, or another lens model"
    )


def require_rays_everywhere(name: str, camera: Camera) -> None:
    """Raise where the lens model folds, or has no inverse, within the picture.

    Raises
    ------
    InputError
        A pixel on a lattice over the picture has no ray.
    """
    q = np.stack(camera.lattice(), axis=-1)
    lost = ~camera.rays(q).ok
    if lost.any():
        q = q[lost][0]
        raise InputError(
            f"The lens of camera '{name}' ({camera.lens}) folds within its picture: pixel "
            f"({q[0]:.1f}, {q[1]:.1f}) sees no direction. {_mend(camera)}"
        )


def _mend(camera: Camera) -> str:
    """Return advice for a picture that reaches beyond the lens's field of view."""
    if camera.prescription is not None:
        return "Raise focal_px, lessen the picture's size, or give the prescription wider surfaces."
    if camera.model.ranges is not None:
        return "Raise the focal length, lessen the picture's size, or let the lens see farther."
    return "Weaken the distortion, or add coefficients that let it grow outwards."
