"""A Mitsuba sensor that traces a camera's own rays: distortion bends the ray, no picture is resampled."""

from functools import cache

from labcal.cameras.camera import Camera
from labcal.geometry.poses import inverse
from labcal.render.variant import Jit

FILM_SHIFT = 0.5
"""Mitsuba's film has its origin at the corner of the top-left pixel, OpenCV's picture at its centre."""


@cache
def sensor_plugin(variant: str) -> str:
    """Register the sensor with the variant in use and return its plugin name.

    Parameters
    ----------
    variant : str
        The variant in use; every variant has a class of its own.
    """
    import drjit as dr  # noqa: PLC0415 -- only once Dr.Jit was told where LLVM is
    import mitsuba as mi  # noqa: PLC0415 -- names resolve to the variant in use

    from labcal.render.drjit_mathematics import DRJIT  # noqa: PLC0415 -- imports Dr.Jit

    class TracedSensor(mi.Sensor):
        """Traces ``Camera.trace`` for a band of rows of the picture."""

        def __init__(self, props: Jit) -> None:
            super().__init__(props)
            self.m_needs_sample_2 = True
            self.m_needs_sample_3 = False

        def aim(self, camera: Camera, first_row: int) -> None:
            """Become the camera, with the film's top row at `first_row` of its picture.

            All numbers are opaque to the compiler, so that one kernel serves every camera of a lens model.
            """
            T_world_cam = inverse(camera.T_cam_world)
            self.trace = camera.trace
            self.numbers = tuple(dr.opaque(mi.Float, number) for number in camera.numbers)
            self.first_row = dr.opaque(mi.Float, first_row)
            self.T_world_cam = [[dr.opaque(mi.Float, float(n)) for n in row] for row in T_world_cam[:3]]

        def sample_ray(
            self,
            time: Jit,
            _wavelength: Jit,
            position: Jit,
            _aperture: Jit,
            _active: Jit = True,  # noqa: FBT002 -- the signature is Mitsuba's
        ) -> tuple[Jit, Jit]:
            """Return rays and their weights at positions (0 to 1) on the film; no ray weighs nothing."""
            width, height = self.film().size()
            u = position.x * width - FILM_SHIFT
            v = position.y * height - FILM_SHIFT + self.first_row
            traced = self.trace(DRJIT, self.numbers, u, v)
            origin, direction = [], []
            for r0, r1, r2, t in self.T_world_cam:
                a, b, c = traced.origin
                origin.append(r0 * a + r1 * b + r2 * c + t)
                a, b, c = traced.direction
                direction.append(r0 * a + r1 * b + r2 * c)
            ray = mi.Ray3f(mi.Point3f(*origin), dr.normalize(mi.Vector3f(*direction)), time)
            return ray, mi.Spectrum(dr.select(traced.ok, mi.Float(1.0), mi.Float(0.0)))

        def sample_ray_differential(
            self,
            time: Jit,
            wavelength: Jit,
            position: Jit,
            aperture: Jit,
            active: Jit = True,  # noqa: FBT002 -- the signature is Mitsuba's
        ) -> tuple[Jit, Jit]:
            """Return the same without differentials, which only bitmaps would use."""
            ray, weight = self.sample_ray(time, wavelength, position, aperture, active)
            return mi.RayDifferential3f(ray), weight

        def bbox(self) -> Jit:
            """Return an empty box: the sensor takes no part in the scene."""
            return mi.ScalarBoundingBox3f()

        def to_string(self) -> str:
            """Return its name."""
            return "TracedSensor[]"

    name = f"labcal-traced-{variant}"
    mi.register_sensor(name, TracedSensor)
    return name
