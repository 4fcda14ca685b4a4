"""A scene that is compiled for Mitsuba once; the target then moves from view to view."""

from dataclasses import dataclass
from types import ModuleType
from typing import Protocol, runtime_checkable

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.render.camera_rays import CameraRays, Pixels, Shading
from labcal.render.contents import contents
from labcal.render.direct_light import Light, LitScene, radiance
from labcal.render.dots import dots_plugin
from labcal.render.forms import Flat, Form, forms
from labcal.render.paint import Paint
from labcal.render.panels import Panels
from labcal.render.samples import Samples
from labcal.render.variant import Jit
from labcal.scene.camera import Aperture
from labcal.scene.lamps import Ambient
from labcal.scene.lighting import ambient_radiance
from labcal.scene.model import Scene
from labcal.scene.print import TruePrint

RAYS_AT_ONCE = 2**22
"""No more rays are traced at once, which bounds the memory."""
PIXEL = 0
"""Purpose of the samples that choose a point of the pixel."""


@runtime_checkable  # so that tests can check annotations
class Rays(Protocol):
    """The source of the rays of a picture."""

    def rays(self, pixels: Pixels) -> tuple[Jit, Jit]:
        """Return rays in the world and their weights."""


@dataclass(frozen=True)
class Draw:
    """A part of the samples of a pixel."""

    seed: int
    """Of the picture; 32 bits."""
    total: int
    """Samples a pixel altogether."""
    first: int
    """Number of the first sample wanted."""
    count: int
    """Number of samples."""


class Laboratory:
    """Mitsuba's side of a scene, for one picture size.

    Parameters
    ----------
    mi : module
        Mitsuba with the variant in use; it must stay in use as long as this lives.
    scene : Scene
    size : (int, int)
        Width and height of the pictures, px.
    seed : int
        Seed of the run; misplaced dots are drawn from it.
    """

    def __init__(self, mi: ModuleType, scene: Scene, size: tuple[int, int], seed: int) -> None:
        self.mi, self.description, self.size = mi, scene, size
        self.colour = scene.photometry.bayer
        paint = Paint(colour=self.colour)
        made = TruePrint.of(scene.target, scene.board, seed)
        self.dots = mi.load_dict({"type": dots_plugin(mi.variant())})
        self.dots.show(made, paint.channels(scene.board.dark), paint.channels(scene.board.light))
        red, green, blue = ambient_radiance(scene).tolist()
        self.ambient = paint.channels((red, green, blue))
        # Optimised, a scene has its lamps in another order, and so another noise, at every run.
        self.scene = mi.load_dict(contents(mi, scene, paint, self.dots), parallel=False, optimize=False)
        self.parameters = mi.traverse(self.scene)
        self.numbers = {shape.id(): i for i, shape in enumerate(self.scene.shapes())}
        self.lit: LitScene | None = None

    def place(self, T_world_target: Pose) -> None:
        """Move the target, and everything attached to it, to a pose (mm)."""
        found = forms(self.description, T_world_target)
        flats = [form for form in found.values() if isinstance(form, Flat)]
        shapes, panels = self.scene.shapes_dr(), None
        if len(flats) == len(found):
            # Mitsuba's own shapes stay where they are: it is asked for materials and lamps only.
            places, occludes = [form.T_world_panel for form in flats], [form.occludes for form in flats]
            panels = Panels(self.mi, places, occludes)
            shapes = panels.of_shapes(shapes, [self.numbers[name] for name in found])
        else:
            self._move(found)
        lamps = any(not isinstance(lamp, Ambient) for lamp in self.description.lamps)
        matt = self.description.board.gloss_roughness is None
        self.lit = LitScene(self.mi, self.scene, shapes, panels, Light(self.ambient, lamps=lamps, matt=matt))

    def _move(self, found: dict[str, Form]) -> None:
        """Move Mitsuba's shapes."""
        for name, form in found.items():
            if isinstance(form, Flat):
                self.parameters[f"{name}.to_world"] = self.mi.Transform4f(form.T_world_panel)
            else:
                for key, values in form.facets.at(form.T_world_body).items():
                    self.parameters[f"{name}.{key}"] = self.mi.Float(values)
        self.parameters.update()

    def rays_of(self, camera: Camera, aperture: Aperture | None = None) -> CameraRays:
        """Return the rays of a camera, with the fall-off of light of the photometry of the scene."""
        photometry = self.description.photometry
        shading = Shading(fall_off=photometry.fall_off, vignetting=photometry.vignetting)
        return CameraRays(self.mi, camera, aperture, shading)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a picture: (height, width), in colour (height, width, 3)."""
        width, height = self.size
        return (height, width, 3) if self.colour else (height, width)

    def rows_at_once(self, count: int) -> int:
        """Return the number of rows that are traced together with `count` samples per pixel."""
        width, height = self.size
        return min(height, max(1, RAYS_AT_ONCE // (width * count)))

    def trace(self, camera: Rays, rows: slice, draw: Draw) -> np.ndarray:
        """Return the radiance in a band of rows, the mean of some of the samples of each pixel.

        Parameters
        ----------
        camera : Rays
        rows : slice
            First row, and the one after the last.
        draw : Draw
            Which of a pixel's samples; their values do not depend on the band.

        Returns
        -------
        ndarray, shape (rows, width) or (rows, width, 3)
            float32.
        """
        import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm

        mi, width, count = self.mi, self.size[0], draw.count
        lane = dr.arange(mi.UInt32, (rows.stop - rows.start) * width * count)
        # Numbers that are opaque to the compiler leave one kernel for all bands and pictures.
        each = dr.opaque(mi.UInt32, count)
        pixel = lane // each + dr.opaque(mi.UInt32, rows.start * width)
        index = lane % each + dr.opaque(mi.UInt32, draw.first)
        means = self._means(camera, pixel, index, draw)
        band = means.reshape(-1, width, means.shape[-1])
        return band if self.colour else band[..., 0]

    def _means(self, camera: Rays, pixel: Jit, index: Jit, draw: Draw) -> np.ndarray:
        """Return the mean radiance of pixels over the samples of a draw, float32, shape (n, channels).

        Parameters
        ----------
        camera : Rays
        pixel : array of the variant
            Number of each sample's pixel; samples of a pixel follow each other.
        index : array of the variant
            Number of each sample in its pixel.
        draw : Draw
        """
        import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm

        samples = Samples(self.mi, pixel, index, dr.opaque(self.mi.UInt32, draw.seed), draw.total)
        across = dr.opaque(self.mi.UInt32, self.size[0])
        middle = self.mi.Float64(pixel % across), self.mi.Float64(pixel // across)
        light = self.radiance(camera, middle, samples.square(PIXEL), samples)
        dr.eval(light)  # once for all channels: else each of them would trace its own rays
        channels = [np.array(dr.block_sum(channel, draw.count)) for channel in light]
        return np.stack(channels, axis=-1) / np.float32(draw.count)

    def radiance(self, camera: Rays, middle: tuple[Jit, Jit], within: Jit, samples: Samples) -> Jit:
        """Return the radiance of samples.

        Parameters
        ----------
        camera : Rays
        middle : (array of the variant, array of the variant)
            Column and row of each sample's pixel, float64; it may lie beyond the picture.
        within : array of the variant
            Points in the pixels, 0 to 1.
        samples : Samples
            For points of lamps and of the aperture.
        """
        u, v = (
            at + (self.mi.Float64(part) - 0.5) for at, part in zip(middle, (within.x, within.y), strict=True)
        )
        ray, weight = camera.rays(Pixels(u, v, samples))
        return radiance(self._placed(), ray, samples) * weight

    def _placed(self) -> LitScene:
        """Return the scene with its target in place."""
        if self.lit is None:
            raise RuntimeError("The target has no place yet: call place() before trace().")
        return self.lit
