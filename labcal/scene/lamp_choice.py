"""The variance of light by the choice of one point of one lamp for each ray, as the renderer makes it."""

import numpy as np

from labcal.arrays import Pose
from labcal.geometry.poses import transform
from labcal.scene.lamps import Ambient
from labcal.scene.lighting import REC709, irradiance, patch_irradiances
from labcal.scene.model import Scene

_POINTS = 5
"""Along each side of the board."""


def lamp_choice_variance(scene: Scene, T_world_target: Pose) -> float:
    """Return the variance of the light of one ray over the square of its mean, the mean over the board.

    Parameters
    ----------
    scene : Scene
    T_world_target : ndarray, shape (4, 4)
        Mm.

    Notes
    -----
    Each of k lamps is chosen as often, and each of m patches of it: a ray sees k m times the irradiance by
    its patch. The board is flat here, and nothing shades it. In a pixel of one colour the choices of all rays
    make up for each other; at an edge they do not, since paper takes some of them.
    """
    x_min, y_min, x_max, y_max = scene.target.extent_mm
    x, y = np.meshgrid(np.linspace(x_min, x_max, _POINTS), np.linspace(y_min, y_max, _POINTS))
    p = transform(T_world_target, np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=-1))
    normal = T_world_target[:3, 2]
    lamps = [lamp for lamp in scene.lamps if not isinstance(lamp, Ambient)]
    mean, square, steady = np.zeros(len(p)), np.zeros(len(p)), np.zeros(len(p))
    for lamp in scene.lamps:
        grey = float(REC709 @ np.array(lamp.colour))
        if isinstance(lamp, Ambient):
            steady += grey * irradiance(lamp, p, normal)
        else:
            parts = grey * patch_irradiances(lamp, p, normal)
            mean += parts.sum(axis=1)
            square += len(lamps) * parts.shape[1] * (parts**2).sum(axis=1)
    lit = mean + steady > 0.0
    relative = (square - mean**2)[lit] / (mean + steady)[lit] ** 2
    return float(relative.mean()) if lit.any() else 0.0
