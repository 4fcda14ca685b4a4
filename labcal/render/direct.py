"""Direct light, and light from everywhere: what a ray brings back."""

from functools import cache

from labcal.render.variant import Jit


@cache
def direct_plugin(variant: str) -> str:
    """Register the integrator with the variant in use and return its plugin name.

    Parameters
    ----------
    variant : str
        The variant in use.
    """
    import drjit as dr  # noqa: PLC0415 -- only once Dr.Jit was told where LLVM is
    import mitsuba as mi  # noqa: PLC0415 -- names resolve to the variant in use

    class DirectLight(mi.SamplingIntegrator):
        """Light of one lamp drawn at random, and light from everywhere that nothing shades."""

        def __init__(self, props: Jit) -> None:
            super().__init__(props)

        def shine(self, ambient: tuple[float, ...], *, lamps: bool) -> None:
            """Set the radiance from everywhere, and whether there are lamps besides."""
            self.ambient, self.lamps = mi.Spectrum(*ambient), lamps
            self.any_ambient = any(value > 0.0 for value in ambient)

        def sample(
            self,
            scene: Jit,
            sampler: Jit,
            ray: Jit,
            _medium: Jit = None,
            active: Jit = True,  # noqa: FBT002 -- the signature is Mitsuba's
        ) -> tuple[Jit, Jit, list[Jit]]:
            """Return the radiance along rays."""
            si = scene.ray_intersect(ray, mi.RayFlags.All, coherent=True, active=active)
            hit = active & si.is_valid()
            radiance = si.emitter(scene).eval(si, active) if self.lamps else mi.Spectrum(0.0)
            bsdf = si.bsdf(ray)
            if self.any_ambient:
                radiance += dr.select(hit, self.ambient * bsdf.eval_diffuse_reflectance(si, hit), 0.0)
            if self.lamps:
                light, weight = scene.sample_emitter_direction(si, sampler.next_2d(active), True, hit)
                towards = hit & (light.pdf != 0.0)
                radiance += weight * bsdf.eval(mi.BSDFContext(), si, si.to_local(light.d), towards)
            return radiance, hit, []

    name = f"labcal-direct-{variant}"
    mi.register_integrator(name, DirectLight)
    return name
