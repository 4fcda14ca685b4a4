"""Patterned surfaces of the room, as a Mitsuba texture."""

from functools import cache

from labcal.render.variant import Jit


@cache
def surface_plugin(variant: str) -> str:
    """Register the texture with the variant in use and return its plugin name.

    Parameters
    ----------
    variant : str
        The variant in use.
    """
    import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm
    import mitsuba as mi  # noqa: PLC0415 -- names resolve to the variant in use

    from labcal.render.patterns import Pattern  # noqa: PLC0415 -- imports Dr.Jit

    class SurfaceTexture(mi.Texture):
        """A colour that varies in a pattern."""

        def __init__(self, props: Jit) -> None:
            super().__init__(props)

        def show(self, colour: tuple[float, ...], size_mm: tuple[float, float], pattern: Pattern) -> None:
            """Set a surface of a size with uv from 0 to 1, its colour in the channels of the variant."""
            self.colour, self.pattern = mi.Spectrum(*colour), pattern
            self.size_mm = size_mm

        def eval(self, si: Jit, active: Jit = True) -> Jit:  # noqa: FBT002 -- the signature is Mitsuba's
            """Return the reflectance at surface points."""
            width, height = self.size_mm
            factor = self.pattern(si.uv.x * width, si.uv.y * height)
            return dr.select(active, dr.minimum(self.colour * factor, 1.0), 0.0)

        def mean(self) -> Jit:
            """Return the colour, roughly the mean."""
            return dr.mean(self.colour)

        def is_spatially_varying(self) -> bool:
            """Return True."""
            return True

        def to_string(self) -> str:
            """Return its name."""
            return "SurfaceTexture[]"

    name = f"labcal-surface-{variant}"
    mi.register_texture(name, SurfaceTexture)
    return name
