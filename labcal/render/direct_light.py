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
    lamp, irradiance = scene.sample_emitter_direction(si, samples.square(LAMP), False, si.is_valid())
    lit_up = si.is_valid() & (dr.max(irradiance) > 0.0)
    way = si.spawn_ray_to(lamp.p)
    lit_up &= ~(scene.ray_test(way, lit_up) if lit.panels is None else lit.panels.blocked(way))
    reflected = si.bsdf().eval(mi.BSDFContext(), si, si.to_local(lamp.d), lit_up)
    return dr.select(lit_up, reflected * irradiance, 0.0) + si.emitter(scene).eval(si)
