"""The contents of a scene for Mitsuba: shapes, materials and lamps."""

from types import ModuleType
from typing import Any

import numpy as np

from labcal.render.forms import Flat, floor_size_mm, forms, wall_size_mm
from labcal.render.paint import Paint
from labcal.render.surfaces import surface_plugin
from labcal.render.variant import Jit
from labcal.scene.board import Board
from labcal.scene.lamps import Panel, Ring, Spot
from labcal.scene.lighting import BLACK, lamp_pose
from labcal.scene.model import Scene

COAT_INDEX = 1.5
"""Refractive index of a glossy board's clear coat."""


def contents(mi: ModuleType, scene: Scene, paint: Paint, dots: Jit) -> dict[str, Any]:
    """Return Mitsuba's dictionary of a scene, with the target at the world's origin.

    Light from everywhere is no part of it.

    Parameters
    ----------
    mi : module
    scene : Scene
    paint : Paint
    dots : mitsuba.Texture
        The print.
    """
    shapes = forms(scene, np.eye(4))
    made_of: dict[str, dict[str, Any]] = {"print": {"bsdf": _paper(scene.board, dots)}}
    for name, form in shapes.items():
        if form.colour is not None:
            made_of[name] = {"bsdf": paint.matt(form.colour)}
    made_of |= _room(mi, scene, paint) | _lamps(scene, paint)
    found: dict[str, Any] = {"type": "scene"}
    for name, form in shapes.items():
        if isinstance(form, Flat):
            to_world = mi.ScalarTransform4f(form.T_world_panel)
            found[name] = {"type": "rectangle", "to_world": to_world, **made_of[name]}
        else:
            found[name] = form.facets.mesh(mi, name, form.T_world_body, made_of[name])
    for number, lamp in enumerate(scene.lamps):
        if isinstance(lamp, Spot):
            found[f"lamp-{number}"] = {
                "type": "spot",
                "to_world": mi.ScalarTransform4f(lamp_pose(lamp)),
                "intensity": paint.spectrum(lamp.colour, lamp.intensity),
                "cutoff_angle": lamp.cutoff_deg,
                "beam_width": lamp.beam_deg,
            }
    return found


def _paper(board: Board, dots: Jit) -> dict[str, Any]:
    """Return the material of the print: matt paper, or paper with a clear coat."""
    if board.gloss_roughness is None:
        return {"type": "diffuse", "reflectance": dots}
    return {
        "type": "roughplastic",
        "distribution": "ggx",
        "alpha": board.gloss_roughness,
        "int_ior": COAT_INDEX,
        "diffuse_reflectance": dots,
    }


def _room(mi: ModuleType, scene: Scene, paint: Paint) -> dict[str, dict[str, Any]]:
    """Return the materials of floor, wall and table top."""
    from labcal.render.patterns import planks, plaster, tiles  # noqa: PLC0415 -- imports Dr.Jit

    room = scene.room
    found = {}
    for name, colour, size_mm, pattern in (
        ("floor", room.floor, floor_size_mm(scene), tiles(room.tile_mm)),
        ("wall", room.wall, wall_size_mm(scene), plaster),
        ("table-top", room.table, room.table_size_mm, planks),
    ):
        texture = mi.load_dict({"type": surface_plugin(mi.variant())})
        texture.show(paint.channels(colour), size_mm, pattern)
        found[name] = {"bsdf": {"type": "diffuse", "reflectance": texture}}
    return found


def _lamps(scene: Scene, paint: Paint) -> dict[str, dict[str, Any]]:
    """Return panels and rings, which are black on the side that does not radiate."""
    return {
        f"lamp-{number}": {
            "bsdf": paint.matt(BLACK),
            "emitter": {"type": "area", "radiance": paint.spectrum(lamp.colour, lamp.radiance)},
        }
        for number, lamp in enumerate(scene.lamps)
        if isinstance(lamp, Panel | Ring)
    }
