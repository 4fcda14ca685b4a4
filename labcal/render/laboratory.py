"""A scene compiled for Mitsuba once, in which the target then moves from view to view."""

from dataclasses import dataclass
from types import ModuleType
from typing import Any, Protocol, runtime_checkable

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose
from labcal.render.direct_light import LitScene, radiance
from labcal.render.dots import dots_plugin
from labcal.render.panels import Panels
from labcal.render.samples import Samples
from labcal.render.sensor import Pixels, Sensor, Shading
from labcal.render.variant import Jit
from labcal.scene.camera import Aperture
from labcal.scene.furniture import blocks
from labcal.scene.lighting import REC709, lamp_pose
from labcal.scene.model import Scene

FAR_MM = 12000.0
"""Half the size of floor and wall."""
DARKER = 0.8
"""Reflectance of every other tile of the floor."""
RAYS_AT_ONCE = 2**22
"""No more rays are traced at once, which bounds the memory."""


def _face(x: tuple[int, int, int], y: tuple[int, int, int]) -> Pose:
    """Return the face of a cube from -1 to 1 that has these edges."""
    normal = np.cross(x, y)
    return pose(np.stack([x, y, normal], axis=1).astype(np.float64), normal.astype(np.float64))


FACES = {
    "top": _face((1, 0, 0), (0, 1, 0)),
    "right": _face((0, 1, 0), (0, 0, 1)),
    "left": _face((0, -1, 0), (0, 0, 1)),
    "back": _face((-1, 0, 0), (0, 0, 1)),
    "front": _face((1, 0, 0), (0, 0, 1)),
}
"""A block's faces that may be seen; its underside never is."""
PIXEL = 0
"""Purpose of the samples that choose a point of the pixel."""


@runtime_checkable  # so that tests can check annotations
class Rays(Protocol):
    """What gives a picture's rays."""

    def rays(self, pixels: Pixels) -> tuple[Jit, Jit]:
        """Return rays in the world and their weights."""


@dataclass(frozen=True)
class Draw:
    """Some of a pixel's samples."""

    seed: int
    """Of the picture; 32 bits."""
    total: int
    """Samples a pixel altogether."""
    first: int
    """Number of the first sample wanted."""
    count: int
    """How many are wanted."""


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
        self.dots = mi.load_dict({"type": dots_plugin(mi.variant())})
        self.dots.show(scene.target, self._channels(scene.board.dark), self._channels(scene.board.light))
        # Optimised, a scene has its lamps in another order, and so another noise, at every run.
        self.scene = mi.load_dict(self._contents(), parallel=False, optimize=False)
        self.lit: LitScene | None = None

    def place(self, T_world_target: Pose) -> None:
        """Move the target, and what carries it, to a pose (mm)."""
        places = self._panels(T_world_target)
        # Mitsuba's own shapes stay where they are: it is asked for materials and lamps only.
        self.lit = LitScene(
            self.mi, self.scene, self.scene.shapes_dr(), Panels(self.mi, list(places.values()))
        )

    def sensor(self, camera: Camera, aperture: Aperture | None = None) -> Sensor:
        """Return a camera's rays, with the fall-off of light that the scene's photometry asks for."""
        photometry = self.description.photometry
        shading = Shading(fall_off=photometry.fall_off, vignetting=photometry.vignetting)
        return Sensor(self.mi, camera, aperture, shading)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a picture: (height, width), in colour (height, width, 3)."""
        width, height = self.size
        return (height, width, 3) if self.colour else (height, width)

    def rows_at_once(self, count: int) -> int:
        """Return how many rows are traced at once with `count` samples a pixel."""
        width, height = self.size
        return min(height, max(1, RAYS_AT_ONCE // (width * count)))

    def trace(self, sensor: Rays, rows: slice, draw: Draw) -> np.ndarray:
        """Return the radiance in a band of rows, the mean of some of a pixel's samples.

        Parameters
        ----------
        sensor : Rays
        rows : slice
            First row, and the one after the last.
        draw : Draw
            Which of a pixel's samples; their values do not depend on the band.

        Returns
        -------
        ndarray, shape (rows, width) or (rows, width, 3)
            float32.
        """
        import drjit as dr  # noqa: PLC0415 -- only once Dr.Jit was told where LLVM is

        mi, width, count = self.mi, self.size[0], draw.count
        lane = dr.arange(mi.UInt32, (rows.stop - rows.start) * width * count)
        # Numbers that are opaque to the compiler leave one kernel for all bands and pictures.
        each, across = dr.opaque(mi.UInt32, count), dr.opaque(mi.UInt32, width)
        pixel = lane // each + dr.opaque(mi.UInt32, rows.start * width)
        index = lane % each + dr.opaque(mi.UInt32, draw.first)
        samples = Samples(mi, pixel, index, dr.opaque(mi.UInt32, draw.seed), draw.total)
        within = samples.square(PIXEL)
        u = mi.Float64(pixel % across) + (mi.Float64(within.x) - 0.5)
        v = mi.Float64(pixel // across) + (mi.Float64(within.y) - 0.5)
        ray, weight = sensor.rays(Pixels(u, v, samples))
        light = radiance(self._placed(), ray, samples) * weight
        channels = [np.array(dr.block_sum(channel, count)) for channel in light]
        band = np.stack(channels, axis=-1).reshape(-1, width, len(channels)) / np.float32(count)
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

    def _placed(self) -> LitScene:
        """Return the scene with its target in place."""
        if self.lit is None:
            raise RuntimeError("The target has no place yet: call place() before trace().")
        return self.lit

    def _panels(self, T_world_target: Pose) -> dict[str, Pose]:
        """Return every flat rectangle by name: the affine map of the square from -1 to 1 into the world."""
        room = self.description.room
        x_min, y_min, x_max, y_max = self.description.target.extent_mm
        middle = pose(np.eye(3), np.array([0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.0]))
        board = np.diag([0.5 * (x_max - x_min), 0.5 * (y_max - y_min), 1.0, 1.0])
        far = np.diag([FAR_MM, FAR_MM, 1.0, 1.0])
        upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
        panels = {
            "print": T_world_target @ middle @ board,
            "floor": pose(np.eye(3), np.array([0.0, 0.0, room.floor_z_mm])) @ far,
            "wall": pose(upright, np.array([0.0, room.wall_y_mm, 0.0])) @ far,
        }
        for number, block in enumerate(blocks(self.description, T_world_target)):
            size = np.diag([*(0.5 * np.array(block.size_mm)), 1.0])
            for face, T_block_face in FACES.items():
                panels[f"block-{number}-{face}"] = block.T_world_block @ size @ T_block_face
        for number, lamp in enumerate(self.description.lamps):
            width, height = lamp.size_mm
            panels[f"lamp-{number}"] = lamp_pose(lamp) @ np.diag([0.5 * width, 0.5 * height, 1.0, 1.0])
        return panels

    def _contents(self) -> dict[str, Any]:
        """Return Mitsuba's dictionary of the scene, with the target at the world's origin."""
        scene, room = self.description, self.description.room
        black = self._rgb((0.0, 0.0, 0.0))
        surfaces: dict[str, dict[str, Any]] = {
            "print": {"bsdf": {"type": "diffuse", "reflectance": self.dots}},
            "floor": {"bsdf": {"type": "diffuse", "reflectance": self._tiles()}},
            "wall": {"bsdf": {"type": "diffuse", "reflectance": self._rgb(room.wall)}},
        }
        for number, block in enumerate(blocks(scene, np.eye(4))):
            for face in FACES:
                paint = {"type": "diffuse", "reflectance": self._rgb(block.reflectance)}
                surfaces[f"block-{number}-{face}"] = {"bsdf": paint}
        for number, lamp in enumerate(scene.lamps):
            red, green, blue = (lamp.radiance * share for share in lamp.colour)
            emitter = {"type": "area", "radiance": self._rgb((red, green, blue))}
            surfaces[f"lamp-{number}"] = {
                "bsdf": {"type": "diffuse", "reflectance": black},
                "emitter": emitter,
            }
        transform = self.mi.ScalarTransform4f
        contents: dict[str, Any] = {"type": "scene"}
        for name, T_world_panel in self._panels(np.eye(4)).items():
            contents[name] = {"type": "rectangle", "to_world": transform(T_world_panel), **surfaces[name]}
        return contents
