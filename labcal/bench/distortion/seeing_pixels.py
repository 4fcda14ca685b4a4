"""The middle of the pictures of a pair of cameras in which every pixel sees a direction."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from labcal.cameras.camera import Camera
from labcal.errors import InputError

_STEPS_TO_MIDDLE = 40


def seeing_margin(pair: tuple[Camera, Camera]) -> Float64[np.ndarray, " 2"]:
    """Return how much of the pictures is to be left out, px, on the left and right, above and below.

    It is 0 where every pixel sees a direction. The glass of a lens ends within the corners of the picture,
    and what a camera shows there is no matter of its lens model.

    Raises
    ------
    InputError
        No pixel around the middle sees a direction.
    """
    for step in range(_STEPS_TO_MIDDLE):
        margin = np.floor(0.5 * np.array(pair[0].size) * step / _STEPS_TO_MIDDLE)
        if all(cut(camera, margin).share_without_rays == 0.0 for camera in pair):
            return margin
    raise InputError(f"The lens '{pair[0].lens}' sees no direction around the middle of its picture.")


def cut(camera: Camera, margin: Float64[np.ndarray, " 2"]) -> Camera:
    """Return a camera whose picture lacks a margin on each side; pixels are counted from the new corner."""
    K = camera.K.copy()
    K[:2, 2] -= margin
    width, height = (np.array(camera.size) - 2 * margin).astype(int).tolist()
    return replace(camera, K=K, size=(width, height))
