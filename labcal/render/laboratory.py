"""A scene compiled for Mitsuba once, in which the target then moves from view to view."""

from types import ModuleType

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.render.contents import contents
from labcal.render.direct import direct_plugin
from labcal.render.dots import dots_plugin
from labcal.render.forms import Flat, forms
from labcal.render.paint import Paint
from labcal.render.sensor import sensor_plugin
from labcal.scene.lamps import Ambient
from labcal.scene.lighting import ambient_radiance
from labcal.scene.model import Scene, samples_per_pass
from labcal.scene.print import TruePrint

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
    seed : int
        Seed of the run; misplaced dots are drawn from it.
    """

    def __init__(self, mi: ModuleType, scene: Scene, size: tuple[int, int], seed: int) -> None:
        self.mi, self.description, self.size = mi, scene, size
        self.colour = scene.photometry.bayer
        width, height = size
        samples = samples_per_pass(scene.spp)
        self.band_rows = min(height, max(1, RAYS_PER_BAND // (width * samples)))
        paint = Paint(colour=self.colour)
        made = TruePrint.of(scene.target, scene.board, seed)
        self.dots = mi.load_dict({"type": dots_plugin(mi.variant())})
        self.dots.show(made, paint.channels(scene.board.dark), paint.channels(scene.board.light))
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
        red, green, blue = ambient_radiance(scene).tolist()
        self.ambient = paint.channels((red, green, blue))
        self.integrator = mi.load_dict({"type": direct_plugin(mi.variant())})
        self.integrator.shine(self.ambient, lamps=not self.uniform)
        # Optimised, a scene has its lamps in another order, and so another noise, at every run.
        self.scene = mi.load_dict(contents(mi, scene, paint, self.dots), parallel=False, optimize=False)
        self.parameters = mi.traverse(self.scene)

    @property
    def uniform(self) -> bool:
        """Whether all light is ambient: a radiance is a reflectance times :attr:`ambient`."""
        return all(isinstance(lamp, Ambient) for lamp in self.description.lamps)

    @property
    def matt(self) -> bool:
        """Whether every surface is diffuse, so that its reflectance says all about it."""
        return self.description.board.gloss_roughness is None

    def place(self, T_world_target: Pose) -> None:
        """Move the target, and what carries it, to a pose (mm)."""
        for name, form in forms(self.description, T_world_target).items():
            if isinstance(form, Flat):
                self.parameters[f"{name}.to_world"] = self.mi.Transform4f(form.T_world_panel)
            else:
                for key, values in form.facets.at(form.T_world_body).items():
                    self.parameters[f"{name}.{key}"] = self.mi.Float(values)
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
