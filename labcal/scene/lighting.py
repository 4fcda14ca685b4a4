"""How bright the target's bare board is under the lamps, without a renderer: this sets the exposure."""

import numpy as np

from labcal.arrays import Points, Pose
from labcal.geometry.poses import look_at, transform
from labcal.scene.model import Scene
from labcal.scene.room import Lamp
from labcal.scene.views import PlannedView

PATCHES = 8
"""A lamp is summed over 8 x 8 patches; at a metre and more the sum is good to 0.2%."""
BOARD_POINTS = 9
REC709 = np.array([0.2126, 0.7152, 0.0722])
"""Weights of linear red, green and blue in luminance (ITU-R BT.709), for grey cameras."""


def lamp_pose(lamp: Lamp) -> Pose:
    """Return ``T_world_lamp``: the panel lies in its x-y plane and shines along +z.

    Raises
    ------
    InputError
        The lamp looks at its own centre.
    """
    centre, focus = np.array(lamp.centre_mm), np.array(lamp.look_at_mm)
    along = focus - centre
    up = np.array([1.0, 0.0, 0.0] if abs(along[0]) < 0.9 * np.linalg.norm(along) else [0.0, 1.0, 0.0])
    T_lamp_world = look_at(centre, focus, up)
    T_world_lamp = np.eye(4)
    T_world_lamp[:3, :3] = T_lamp_world[:3, :3].T
    T_world_lamp[:3, 3] = centre
    return T_world_lamp


def irradiance(lamp: Lamp, p: Points, normal: np.ndarray) -> np.ndarray:
    """Return the irradiance of a surface from one lamp, with nothing in between.

    Parameters
    ----------
    lamp : Lamp
    p : ndarray, shape (n, 3)
        Points of the surface, world, mm.
    normal : ndarray, shape (3,)
        Its unit normal.

    Returns
    -------
    ndarray, shape (n,)
        The integral of radiance times both cosines over distance squared, colour left out.
    """
    T_world_lamp = lamp_pose(lamp)
    steps = (np.arange(PATCHES) + 0.5) / PATCHES - 0.5
    width, height = lamp.size_mm
    x, y = np.meshgrid(steps * width, steps * height)
    patches = transform(T_world_lamp, np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=-1))
    way = patches - p[:, None, :]
    squared = (way**2).sum(axis=-1)
    at_surface = np.clip(way @ normal, 0.0, None)
    at_lamp = np.clip(-way @ T_world_lamp[:3, 2], 0.0, None)
    patch_area = width * height / PATCHES**2
    total: np.ndarray = lamp.radiance * patch_area * (at_surface * at_lamp / squared**2).sum(axis=-1)
    return total


def brightest_board(scene: Scene, views: tuple[PlannedView, ...]) -> np.ndarray:
    """Return the highest radiance that the bare board has anywhere in the views, red, green and blue.

    Parameters
    ----------
    scene : Scene
    views : tuple of PlannedView
        All views of the scene, so that a picture does not depend on which others are taken.

    Returns
    -------
    ndarray, shape (3,)
        Direct light only.
    """
    x_min, y_min, x_max, y_max = scene.target.extent_mm
    x, y = np.meshgrid(np.linspace(x_min, x_max, BOARD_POINTS), np.linspace(y_min, y_max, BOARD_POINTS))
    board = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=-1)
    brightest = np.zeros(3)
    for view in views:
        p, normal = transform(view.T_world_target, board), view.T_world_target[:3, 2].copy()
        light = sum(irradiance(lamp, p, normal)[:, None] * np.array(lamp.colour) for lamp in scene.lamps)
        radiance = np.asarray(light) * np.array(scene.board.light) / np.pi
        brightest = np.maximum(brightest, radiance.max(axis=0))
    return brightest
