"""A scene compiled for Mitsuba once, in which the target then moves from view to view."""

from types import ModuleType
from typing import Any

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose
from labcal.render.dots import dots_plugin
from labcal.render.sensor import sensor_plugin
from labcal.scene.furniture import blocks
from labcal.scene.lighting import REC709, lamp_pose
from labcal.scene.model import Scene, samples_per_pass

FAR_MM = 12000.0
"""Half the size of floor and wall."""
DARKER = 0.8
"""Reflectance of every other tile of the floor."""
RAYS_PER_BAND = 2**21
"""A band of rows holds no more rays of one pass than this, which bounds the memory."""


class Laboratory:
    """Mitsuba's side of a scene, for one picture size.

    Parameters
    ----------
    mi : module
        Mitsuba with the variant in use; it must stay in use as long as this lives.
    scene : Scene
    size : (int, int)
        Width and height of the pictures, px.
    """

    def __init__(self, mi: ModuleType, scene: Scene, size: tuple[int, int]) -> None:
        self.mi, self.description, self.size = mi, scene, size
        self.colour = scene.photometry.bayer
        width, height = size
        samples = samples_per_pass(scene.spp)
        self.band_rows = min(height, max(1, RAYS_PER_BAND // (width * samples)))
        self.dots = mi.load_dict({"type": dots_plugin(mi.variant())})
        self.dots.show(scene.target, self._channels(scene.board.dark), self._channels(scene.board.light))
        self.sensor = mi.load_dict(
            {
                "type": sensor_plugin(mi.variant()),
                "film": {
                    "type": "hdrfilm",
                    "width": width,
                    "height": self.band_rows,
                    "rfilter": {"type": "box"},  # the default filter gives other bytes at every run
                    "component_format": "float32",
                    "pixel_format": "rgb" if self.colour else "luminance",
                },
                "sampler": {"type": "multijitter", "sample_count": samples},
            }
        )
        self.integrator = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0})
        # Optimised, a scene has its lamps in another order, and so another noise, at every run.
        self.scene = mi.load_dict(self._contents(), parallel=False, optimize=False)
        self.parameters = mi.traverse(self.scene)
        self.unit_cube = np.array(self.parameters["block-0.vertex_positions"]).reshape(-1, 3)

    def place(self, T_world_target: Pose) -> None:
        """Move the target, and what carries it, to a pose (mm)."""
        mi = self.mi
        self.parameters["print.to_world"] = mi.Transform4f(self._print_pose(T_world_target))
        for number, block in enumerate(blocks(self.description, T_world_target)):
            vertices = 0.5 * np.array(block.size_mm) * self.unit_cube
            vertices = vertices @ block.T_world_block[:3, :3].T + block.T_world_block[:3, 3]
            self.parameters[f"block-{number}.vertex_positions"] = mi.Float(
                vertices.ravel().astype(np.float32)
            )
        self.parameters.update()

    def trace(self, camera: Camera, first_row: int, samples: int, seed: int) -> np.ndarray:
        """Return the radiance in a band of rows, one pass.

        Returns
        -------
        ndarray, shape (band_rows, width) or (band_rows, width, 3)
            float32; rows below the picture's end are there too.
        """
        self.sensor.aim(camera, first_row)
        picture = self.integrator.render(self.scene, self.sensor, seed=seed, spp=samples)
        band = np.array(picture, dtype=np.float32)
        return band if self.colour else band[..., 0]

    def _rgb(self, colour: tuple[float, float, float]) -> dict[str, Any]:
        """Return Mitsuba's dictionary of a colour, or of its luminance for a grey camera."""
        channels = self._channels(colour)
        return {"type": "rgb", "value": list(channels if self.colour else 3 * channels)}

    def _channels(self, colour: tuple[float, float, float]) -> tuple[float, ...]:
        """Return a colour, or its luminance alone for a grey camera."""
        return colour if self.colour else (float(REC709 @ np.array(colour)),)

    def _tiles(self) -> dict[str, Any]:
        """Return the floor's pattern."""
        room = self.description.room
        red, green, blue = room.floor
        return {
            "type": "checkerboard",
            "color0": self._rgb(room.floor),
            "color1": self._rgb((DARKER * red, DARKER * green, DARKER * blue)),
            "to_uv": self.mi.ScalarTransform4f().scale(FAR_MM / room.tile_mm),
        }

    def _print_pose(self, T_world_target: Pose) -> np.ndarray:
        """Return the matrix that takes Mitsuba's rectangle (-1 to 1) to the board."""
        x_min, y_min, x_max, y_max = self.description.target.extent_mm
        middle = pose(np.eye(3), np.array([0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.0]))
        scale = np.diag([0.5 * (x_max - x_min), 0.5 * (y_max - y_min), 1.0, 1.0])
        matrix: np.ndarray = T_world_target @ middle @ scale
        return matrix

    def _contents(self) -> dict[str, Any]:
        """Return Mitsuba's dictionary of the scene, with the target at the world's origin."""
        mi, scene, room = self.mi, self.description, self.description.room
        transform = mi.ScalarTransform4f
        contents: dict[str, Any] = {
            "type": "scene",
            "print": {
                "type": "rectangle",
                "to_world": transform(self._print_pose(np.eye(4))),
                "bsdf": {"type": "diffuse", "reflectance": self.dots},
            },
            "floor": {
                "type": "rectangle",
                "to_world": transform().translate([0, 0, room.floor_z_mm]).scale(FAR_MM),
                "bsdf": {"type": "diffuse", "reflectance": self._tiles()},
            },
            "wall": {
                "type": "rectangle",
                "to_world": transform().translate([0, room.wall_y_mm, 0]).rotate([1, 0, 0], 90).scale(FAR_MM),
                "bsdf": {"type": "diffuse", "reflectance": self._rgb(room.wall)},
            },
        }
        for number, block in enumerate(blocks(scene, np.eye(4))):
            contents[f"block-{number}"] = {
                "type": "cube",
                "face_normals": True,
                "bsdf": {"type": "diffuse", "reflectance": self._rgb(block.reflectance)},
            }
        for number, lamp in enumerate(scene.lamps):
            width, height = lamp.size_mm
            colour = tuple(lamp.radiance * share for share in lamp.colour)
            matrix = lamp_pose(lamp) @ np.diag([0.5 * width, 0.5 * height, 1.0, 1.0])
            contents[f"lamp-{number}"] = {
                "type": "rectangle",
                "to_world": transform(matrix),
                "bsdf": {"type": "diffuse", "reflectance": self._rgb((0.0, 0.0, 0.0))},
                "emitter": {"type": "area", "radiance": self._rgb((colour[0], colour[1], colour[2]))},
            }
        return contents
