"""The rays of a picture: lens and glass are applied to the ray, no picture is resampled."""

from dataclasses import dataclass

import numpy as np

from labcal.cameras.camera import Camera
from labcal.cameras.field import FallOff
from labcal.cameras.newton_steps import newton_steps
from labcal.cameras.prescribed import PrescribedLens
from labcal.cameras.pupil import ParallelPupil, Pupil, ThinPupil, TracedPupil
from labcal.errors import InputError
from labcal.geometry.poses import inverse
from labcal.render.samples import Samples
from labcal.render.variant import Jit
from labcal.scene.camera import Aperture

APERTURE = 2
"""Purpose of the samples that choose a point of the aperture."""
_FALL_OFF_DEGREE = 10
_FALL_OFF_RADII = 64
_FALL_OFFS: dict[FallOff | None, tuple[float, ...]] = {FallOff.COS4: (1.0,), FallOff.EVEN: (1.0, 1.0)}
"""Results of :func:`_fall_off` for lenses that are not traced."""


@dataclass(frozen=True)
class Shading:
    """Fall-off of light towards the rim of the picture."""

    fall_off: bool = False
    """The lens's own, as it declares it: cos^4 of the angle to the axis, traced, or none."""
    vignetting: float = 0.0
    """Share of the light that is lost in the picture's corner on top, growing with the radius squared."""


@dataclass(frozen=True)
class Pixels:
    """Positions on the picture, and the samples that belong to them."""

    u: Jit
    v: Jit
    """float64, px; (0, 0) is the centre of the top-left pixel."""
    samples: Samples


class CameraRays:
    """A camera's rays for Mitsuba.

    All parameters are opaque to the compiler, so that one kernel serves every camera with one lens model.

    Parameters
    ----------
    mi : module
        Mitsuba with the variant in use.
    camera : Camera
    aperture : Aperture or None
        None: every ray is the chief ray of its pixel.
    shading : Shading
    """

    def __init__(self, mi: Jit, camera: Camera, aperture: Aperture | None, shading: Shading) -> None:
        import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm

        from labcal.render.drjit_mathematics import DrjitMathematics  # noqa: PLC0415 -- imports Dr.Jit

        def opaque(parameters: tuple[float, ...]) -> tuple[Jit, ...]:
            return tuple(dr.opaque(mi.Float64, float(number)) for number in parameters)

        self._mi, self._camera, self._shading = mi, camera, shading
        self._m = DrjitMathematics(newton_steps(camera))
        self._parameters = opaque(camera.parameters)
        self._T_world_cam = [opaque(tuple(row)) for row in inverse(camera.T_cam_world)[:3]]
        self._pupil = None if aperture is None else _pupil(camera, aperture)
        self._pupil_parameters = () if self._pupil is None else opaque(self._pupil.parameters)
        self._fall_off = opaque(_fall_off(camera, self._pupil)) if shading.fall_off else ()
        width, height = camera.size
        corner2 = 0.25 * (width**2 + height**2)
        middle = (0.5 * (width - 1), 0.5 * (height - 1), shading.vignetting / corner2)
        self._vignetting = opaque(middle) if shading.vignetting > 0.0 else ()

    def rays(self, pixels: Pixels) -> tuple[Jit, Jit]:
        """Return rays in the world and their weights; the weight is 0 where the lens has no ray.

        The rays of a central camera share one origin, of width 1.
        """
        mi, m, optics, parameters = self._mi, self._m, self._camera.optics, self._parameters
        x, y = optics.ideal(m, parameters, pixels.u, pixels.v)
        ray = optics.before_window(m, parameters, x, y)
        weight = self._light(x * x + y * y, ray.direction[2], pixels)
        if self._pupil is not None:
            a, b = pixels.samples.square(APERTURE)
            disc = mi.warp.square_to_uniform_disk_concentric(mi.Point2f(a, b))
            at = (x, y, mi.Float64(disc.x), mi.Float64(disc.y))
            through = self._pupil.ray(m, self._pupil_parameters, ray, at)
            ray, weight = through.ray, weight * through.weight
        ray = optics.behind_window(m, parameters, ray)
        # Where there is no ray NaN would go through the whole of the scene.
        ahead = (0.0, 0.0, 1.0)
        direction = [m.where(ray.ok, part, other) for part, other in zip(ray.direction, ahead, strict=True)]
        d = [mi.Float(self._turned(row, direction)) for row in self._T_world_cam]
        o = [mi.Float(row[3]) for row in self._T_world_cam]
        if not (optics.central and self._pupil is None):
            origin = [m.where(ray.ok, part, 0.0) for part in ray.origin]
            o = [mi.Float(self._turned(row, origin) + row[3]) for row in self._T_world_cam]
        return mi.Ray3f(mi.Point3f(*o), mi.Vector3f(*d)), mi.Float(m.where(ray.ok, weight, 0.0))

    def _turned(self, row: tuple[Jit, ...], vector: list[Jit]) -> Jit:
        """Return the product of a matrix row's first three entries and a vector."""
        m = self._m
        return m.fma(row[0], vector[0], m.fma(row[1], vector[1], row[2] * vector[2]))

    def _light(self, r2: Jit, cosine: Jit, pixels: Pixels) -> Jit:
        """Return the relative light of a pixel, from its ideal radius squared and its angle."""
        weight = 0.0 * r2 + 1.0
        if self._fall_off:
            scale, *coefficients = self._fall_off
            if coefficients:
                relative = 0.0 * r2
                for coefficient in reversed(coefficients):
                    relative = relative * (r2 * scale) + coefficient
                weight = weight * relative
            else:
                squared = cosine * cosine
                weight = weight * squared * squared
        if self._vignetting:
            cu, cv, loss = self._vignetting
            du, dv = pixels.u - cu, pixels.v - cv
            weight = weight * (1.0 - loss * (du * du + dv * dv))
        return weight


def _pupil(camera: Camera, aperture: Aperture) -> Pupil:
    """Return the open aperture of a camera."""
    model = camera.model
    if isinstance(model, PrescribedLens):
        return TracedPupil(model, aperture.diameter_mm, camera.reach)
    if model.parallel:
        return ParallelPupil(0.5 * aperture.diameter_mm, aperture.focus_mm)
    return ThinPupil(0.5 * aperture.diameter_mm, aperture.focus_mm)


def _fall_off(camera: Camera, pupil: Pupil | None) -> tuple[float, ...]:
    """Return the parameters of the fall-off: 1 for cos^4, or a polynomial in the radius squared.

    A prescription that is open loses its light on the way; one that is closed, as if it were open.

    Raises
    ------
    InputError
        The lens does not say how its light falls off.
    """
    model, reach = camera.model, camera.reach
    if not isinstance(model, PrescribedLens):
        if model.fall_off not in _FALL_OFFS:
            raise InputError(
                f"How light falls off behind the lens '{camera.lens}' is not known. Render without: "
                "`overrides='photometry.fall_off=false'`, or choose another lens."
            )
        return _FALL_OFFS[model.fall_off]
    if pupil is not None:
        return (1.0, 1.0)
    prescription = model.prescription
    stop = prescription.surfaces[prescription.stop]
    full = TracedPupil(model, stop.diameter_mm / model.paraxial.pupil_slope, reach)
    radius = np.linspace(0.0, reach, _FALL_OFF_RADII)
    light = full.relative_light(radius)
    fit = np.polynomial.Chebyshev.fit((radius / reach) ** 2, light, _FALL_OFF_DEGREE, domain=[0.0, 1.0])
    return (1.0 / reach**2, *(float(c) for c in fit.convert(kind=np.polynomial.Polynomial).coef))
