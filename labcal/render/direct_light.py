"""Direct light: the radiance of the first surface that a ray meets, without interreflection."""

from dataclasses import dataclass

from labcal.render.panels import Panels
from labcal.render.samples import Samples
from labcal.render.variant import Jit

LAMP = 1
"""Purpose of the samples that choose a point on a lamp."""


@dataclass(frozen=True)
class Light:
    """The kinds of light and surfaces in a scene."""

    ambient: tuple[float, ...]
    """Radiance that comes from everywhere and that nothing shades, in every channel."""
    lamps: bool
    """True if there are lamps."""
    matt: bool
    """True if every surface is diffuse, so that its reflectance is all that is needed."""


@dataclass(frozen=True)
class LitScene:
    """A scene for tracing rays."""

    mi: Jit
    """Mitsuba with the variant in use."""
    scene: Jit
    """Mitsuba's scene."""
    shapes: Jit
    """Mitsuba's shapes, in the order of the panels."""
    panels: Panels | None
    """All shapes of the scene, where every one is a panel."""
    light: Light


def radiance(lit: LitScene, ray: Jit, samples: Samples) -> Jit:
    """Return the radiance along each ray (one shadow ray each).

    Parameters
    ----------
    lit : LitScene
    ray : Ray3f
    samples : Samples
    """
    import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm

    mi, scene, light = lit.mi, lit.scene, lit.light
    if lit.panels is None:
        si = scene.ray_intersect(ray, mi.RayFlags.All, True)
    else:
        si = lit.panels.interaction(ray, lit.panels.closest(ray), lit.shapes)
    bsdf, hit = si.bsdf(), si.is_valid()
    reflectance = bsdf.eval_diffuse_reflectance(si, hit)
    # Opaque, since the brightness of a scene is no reason for another kernel.
    from_everywhere = mi.Spectrum(*(dr.opaque(mi.Float, value) for value in light.ambient))
    if not light.lamps:
        return dr.select(hit, reflectance * from_everywhere, 0.0)
    lamp, irradiance = scene.sample_emitter_direction(si, samples.square(LAMP), False, hit)
    lit_up = hit & (dr.max(irradiance) > 0.0)
    way = si.spawn_ray_to(lamp.p)
    lit_up &= ~(scene.ray_test(way, lit_up) if lit.panels is None else lit.panels.blocked(way))
    if light.matt:  # spares a second call of every material
        cosine = dr.select(si.wi.z > 0.0, dr.maximum(dr.dot(si.sh_frame.n, lamp.d), 0.0), 0.0)
        reflected = reflectance * (cosine * dr.inv_pi)
    else:
        reflected = bsdf.eval(mi.BSDFContext(), si, si.to_local(lamp.d), lit_up)
    direct = dr.select(lit_up, reflected * irradiance, 0.0)
    return dr.select(hit, reflectance * from_everywhere, 0.0) + direct + si.emitter(scene).eval(si)
