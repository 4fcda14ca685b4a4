"""The light that rays bring: what lamps shine on the first surface met, without interreflection."""

from dataclasses import dataclass

from labcal.render.panels import Panels
from labcal.render.samples import Samples
from labcal.render.variant import Jit

LAMP = 1
"""Purpose of the samples that choose a point on a lamp."""


@dataclass(frozen=True)
class LitScene:
    """A scene as rays meet it."""

    mi: Jit
    """Mitsuba with the variant in use."""
    scene: Jit
    """Mitsuba's scene."""
    shapes: Jit
    """Mitsuba's shapes, in the order of the panels."""
    panels: Panels | None
    """All shapes of the scene, where every one is a panel."""
    ambient: tuple[float, ...]
    """Radiance that comes from everywhere and that nothing shades, in every channel."""
    lamps: bool
    """Whether there are lamps at all."""


def radiance(lit: LitScene, ray: Jit, samples: Samples) -> Jit:
    """Return the radiance that each ray brings (one shadow ray each).

    Parameters
    ----------
    lit : LitScene
    ray : Ray3f
    samples : Samples
    """
    import drjit as dr  # noqa: PLC0415 -- only once Dr.Jit was told where LLVM is

    mi, scene = lit.mi, lit.scene
    if lit.panels is None:
        si = scene.ray_intersect(ray, mi.RayFlags.All, True)
    else:
        si = lit.panels.interaction(ray, lit.panels.closest(ray), lit.shapes)
    bsdf, hit = si.bsdf(), si.is_valid()
    found = mi.Spectrum(0.0)
    if any(value > 0.0 for value in lit.ambient):
        # Opaque, since the brightness of a scene is no reason for another kernel.
        ambient = mi.Spectrum(*(dr.opaque(mi.Float, value) for value in lit.ambient))
        found += dr.select(hit, ambient * bsdf.eval_diffuse_reflectance(si, hit), 0.0)
    if not lit.lamps:
        return found
    lamp, irradiance = scene.sample_emitter_direction(si, samples.square(LAMP), False, hit)
    lit_up = hit & (dr.max(irradiance) > 0.0)
    way = si.spawn_ray_to(lamp.p)
    lit_up &= ~(scene.ray_test(way, lit_up) if lit.panels is None else lit.panels.blocked(way))
    reflected = bsdf.eval(mi.BSDFContext(), si, si.to_local(lamp.d), lit_up)
    return found + dr.select(lit_up, reflected * irradiance, 0.0) + si.emitter(scene).eval(si)
