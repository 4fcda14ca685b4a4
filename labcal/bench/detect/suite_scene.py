"""The scene of a picture of the suite: camera, target, pose and occluders."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.bench.detect.design import PictureDesign
from labcal.bench.detect.obstruction import obstruction
from labcal.bench.held_board import board_scene, still_take, tilted_pose
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.rng import generator
from labcal.scene.camera import CameraDescription
from labcal.scene.model import Scene
from labcal.scene.occluders import Occluder
from labcal.scene.take import Take
from labcal.targets.grid import DotGrid, Rings

SPP = 16
RADIUS_MM = 10.0
EYE_MM = 1000.0
"""Height of the camera over the world's origin; it looks straight down."""
FOCAL_OVER_WIDTH = {"pinhole": 1.1, "brown-k1k2": 0.8, "fisheye-kb4": 0.45}
DISTORTION = {
    "pinhole": (),
    "brown-k1k2": (-0.3, 0.09),
    "fisheye-kb4": (-0.04, 0.01, -0.006, 0.001),
}
GRIDS = ((19, 14), (16, 12), (14, 11), (13, 10), (10, 8), (9, 7), (8, 6), (7, 6), (6, 5), (5, 4))
"""Columns and rows; the first that fits into the picture is used, else the last one."""
RING_HOLE = 0.45
"""Inner diameter of a ring over its outer one."""


@dataclass(frozen=True)
class SuiteScene:
    """A scene and a take of one picture of the suite."""

    scene: Scene
    take: Take


def suite_scene(design: PictureDesign, seed: int) -> SuiteScene:
    """Return the scene of a design.

    Parameters
    ----------
    design : PictureDesign
    seed : int
        Occluders are drawn from it.
    """
    description = _camera(design)
    camera = description.camera()
    grids = (_grid(design, cols, rows) for cols, rows in GRIDS)
    for target in grids:
        T_world_target = _pose(design, target)
        if _fits(camera, target, T_world_target):
            break
    occluders: tuple[Occluder, ...] = ()
    if design.hidden > 0.0:
        random = generator(seed, "bench detect", design.name, "obstruction")
        occluders = obstruction(design, target, (camera, T_world_target), random)
    scene = board_scene(target, description, SPP, occluders)
    return SuiteScene(scene, still_take(scene, T_world_target))


def _camera(design: PictureDesign) -> CameraDescription:
    """Return the camera, which looks down."""
    return CameraDescription(
        size=design.size,
        focal_px=FOCAL_OVER_WIDTH[design.lens] * design.size[0],
        lens=design.lens,
        dist=DISTORTION[design.lens],
        eye_mm=(0.0, 0.0, EYE_MM),
        look_at_mm=(0.0, 0.0, 0.0),
    )


def _grid(design: PictureDesign, cols: int, rows: int) -> DotGrid:
    """Return a target whose rings are not near its edges."""
    pitch = design.pitch_over_radius * RADIUS_MM
    first, last = (cols // 5, rows // 5), (cols - 1 - cols // 4, rows - 1 - rows // 3)
    return DotGrid(
        name=f"bench-{cols}x{rows}",
        cols=cols,
        rows=rows,
        pitch_x_mm=pitch,
        pitch_y_mm=pitch,
        dot_diameter_mm=2.0 * RADIUS_MM,
        ring_outer_diameter_mm=2.0 * RADIUS_MM,
        ring_inner_diameter_mm=2.0 * RING_HOLE * RADIUS_MM,
        polarity=design.polarity,
        rings=Rings(origin=first, x=(last[0], first[1]), y=(first[0], last[1])),
        margin_mm=pitch,
    )


def _pose(design: PictureDesign, target: DotGrid) -> Pose:
    """Return the pose at which a dot in the middle of the board has the given radius."""
    focal_px = FOCAL_OVER_WIDTH[design.lens] * design.size[0]
    square_px = design.radius_px / np.sqrt(np.cos(np.radians(design.tilt_deg)))
    away = focal_px * RADIUS_MM / square_px
    aside = np.array(design.aside) * design.size * away / focal_px
    at = np.array([aside[0], aside[1], EYE_MM - away])
    return tilted_pose(target, design.tilt_deg, design.azimuth, design.roll, at)


def _fits(camera: Camera, target: DotGrid, T_world_target: Pose) -> bool:
    """Tell whether all dots are in the picture."""
    images = dot_images(camera, T_world_target, target.points(), 0.5 * target.outer_diameters_mm())
    return bool(images.ok.all() and camera.in_picture(images.outline).all())
