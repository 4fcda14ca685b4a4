"""Radiance of the bare board under the lamps, computed without a renderer; it sets the exposure."""

import numpy as np

from labcal.arrays import Pose, Vectors3
from labcal.geometry.poses import facing, transform
from labcal.scene.lamps import Aimed, Ambient, Lamp, Panel, Ring, Spot
from labcal.scene.model import Scene
from labcal.scene.solids import Block, Cylinder, Solid
from labcal.scene.surface import Surface
from labcal.scene.views import PlannedView

PATCHES = 8
"""A panel is summed over 8 x 8 patches, a ring over 8 x 64; at a metre and more the sum is good to 0.2%."""
PATCHES_AROUND = 64
BOARD_POINTS = 9
REC709 = np.array([0.2126, 0.7152, 0.0722])
"""Weights of linear red, green and blue in luminance (ITU-R BT.709), for grey cameras."""
BLACK = (0.0, 0.0, 0.0)


def lamp_pose(lamp: Aimed) -> Pose:
    """Return ``T_world_lamp``: a flat lamp lies in its x-y plane and shines along +z.

    Raises
    ------
    InputError
        The lamp looks at its own centre.
    """
    return facing(np.array(lamp.centre_mm), np.array(lamp.look_at_mm))


def lamp_body(name: str, lamp: Lamp) -> Solid | None:
    """Return the solid body of a lamp, a panel or ring without thickness; None if it has none."""
    if isinstance(lamp, Panel):
        return Block(name, lamp_pose(lamp), (*lamp.size_mm, 0.0), BLACK)
    if isinstance(lamp, Ring):
        return Cylinder(name, lamp_pose(lamp), 0.0, lamp.outer_diameter_mm, BLACK, lamp.inner_diameter_mm)
    return None


def irradiance(lamp: Lamp, p: Vectors3, normal: np.ndarray) -> np.ndarray:
    """Return the irradiance of a surface by one lamp, without occlusion.

    Parameters
    ----------
    lamp : Lamp
    p : ndarray, shape (n, 3)
        Points of the surface, world, mm.
    normal : ndarray, shape (3,) or (n, 3)
        Its unit normal.

    Returns
    -------
    ndarray, shape (n,)
        The integral of radiance times both cosines over distance squared, colour left out.
    """
    if isinstance(lamp, Ambient):
        return np.full(len(p), np.pi * lamp.radiance)
    return np.asarray(patch_irradiances(lamp, p, normal).sum(axis=-1))


def patch_irradiances(lamp: Panel | Ring | Spot, p: Vectors3, normal: np.ndarray) -> np.ndarray:
    """Return the parts of :func:`irradiance` by patches of a lamp, all of one area, shape (n, patches).

    Parameters
    ----------
    lamp : Panel, Ring or Spot
    p : ndarray, shape (n, 3)
        Points of the surface, world, mm.
    normal : ndarray, shape (3,) or (n, 3)
        Its unit normal.
    """
    T_world_lamp = lamp_pose(lamp)
    if isinstance(lamp, Spot):
        return _from_spot(lamp, T_world_lamp, p, normal)[:, None]
    local, area = _panel_patches(lamp) if isinstance(lamp, Panel) else _ring_patches(lamp)
    patches = transform(T_world_lamp, local)
    way = patches - p[:, None, :]
    squared = (way**2).sum(axis=-1)
    at_surface = np.clip((way * _per_point(normal)[:, None, :]).sum(axis=-1), 0.0, None)
    at_lamp = np.clip(-way @ T_world_lamp[:3, 2], 0.0, None)
    return np.asarray(lamp.radiance * area * at_surface * at_lamp / squared**2)


def _per_point(normal: np.ndarray) -> np.ndarray:
    """Return one normal a point, or one for all, shape (n or 1, 3)."""
    return normal.reshape(-1, 3)


def _panel_patches(lamp: Panel) -> tuple[Vectors3, np.ndarray]:
    """Return the middles (n, 3) and areas (n,) of a panel's patches, mm and mm2."""
    steps = (np.arange(PATCHES) + 0.5) / PATCHES - 0.5
    width, height = lamp.size_mm
    x, y = np.meshgrid(steps * width, steps * height)
    middles = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=-1)
    return middles, np.full(x.size, width * height / x.size)


def _ring_patches(lamp: Ring) -> tuple[Vectors3, np.ndarray]:
    """Return the middles and areas of a ring's patches, all of one area."""
    inner, outer = (0.5 * lamp.inner_diameter_mm) ** 2, (0.5 * lamp.outer_diameter_mm) ** 2
    radius = np.sqrt(inner + (outer - inner) * (np.arange(PATCHES) + 0.5) / PATCHES)
    angle = 2.0 * np.pi * np.arange(PATCHES_AROUND) / PATCHES_AROUND
    x, y = np.outer(radius, np.cos(angle)), np.outer(radius, np.sin(angle))
    middles = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=-1)
    return middles, np.full(x.size, np.pi * (outer - inner) / x.size)


def _from_spot(lamp: Spot, T_world_lamp: Pose, p: Vectors3, normal: np.ndarray) -> np.ndarray:
    """Return the irradiance by a spotlight; its fall-off is that of Mitsuba, linear in the angle."""
    way = T_world_lamp[:3, 3] - p
    squared = (way**2).sum(axis=-1)
    distance = np.sqrt(squared)
    angle = np.degrees(np.arccos(np.clip(-way @ T_world_lamp[:3, 2] / distance, -1.0, 1.0)))
    share = np.clip((lamp.cutoff_deg - angle) / (lamp.cutoff_deg - lamp.beam_deg), 0.0, 1.0)
    at_surface = np.clip((way * _per_point(normal)).sum(axis=-1) / distance, 0.0, None)
    return np.asarray(lamp.intensity * share * at_surface / squared)


def ambient_radiance(scene: Scene) -> np.ndarray:
    """Return the radiance of the ambient light in red, green and blue, shape (3,)."""
    total = np.zeros(3)
    for lamp in scene.lamps:
        if isinstance(lamp, Ambient):
            total += lamp.radiance * np.array(lamp.colour)
    return total


def brightest_board(scene: Scene, views: tuple[PlannedView, ...]) -> np.ndarray:
    """Return the highest radiance of the bare board in any view, in red, green and blue.

    Parameters
    ----------
    scene : Scene
    views : tuple of PlannedView
        All views of the scene, so that a picture does not depend on which others are taken.

    Returns
    -------
    ndarray, shape (3,)
        Direct light only, and without what a glossy board mirrors.
    """
    x_min, y_min, x_max, y_max = scene.target.extent_mm
    x, y = np.meshgrid(np.linspace(x_min, x_max, BOARD_POINTS), np.linspace(y_min, y_max, BOARD_POINTS))
    places = np.stack([x.ravel(), y.ravel()], axis=-1)
    surface = Surface.of_board(scene.target, scene.board)
    board, normals = surface.points(places), surface.normals(places)
    brightest = np.zeros(3)
    for view in views:
        p, normal = transform(view.T_world_target, board), normals @ view.T_world_target[:3, :3].T
        light = sum(irradiance(lamp, p, normal)[:, None] * np.array(lamp.colour) for lamp in scene.lamps)
        radiance = np.asarray(light) * np.array(scene.board.light) / np.pi
        brightest = np.maximum(brightest, radiance.max(axis=0))
    return brightest
