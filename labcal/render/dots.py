"""The target's print as an analytic Mitsuba texture: exact edges at any magnification, and no bitmap."""

from functools import cache

from labcal.render.variant import Jit
from labcal.scene.print import TruePrint


@cache
def dots_plugin(variant: str) -> str:
    """Register the texture with the variant in use and return its plugin name.

    Parameters
    ----------
    variant : str
        The variant in use.
    """
    import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm
    import mitsuba as mi  # noqa: PLC0415 -- names resolve to the variant in use

    from labcal.render.print_ink import ink_of  # noqa: PLC0415 -- imports Dr.Jit

    class DotTexture(mi.Texture):
        """Reflectance of a print over its board; uv runs from 0 to 1 along the board's edges."""

        def __init__(self, props: Jit) -> None:
            super().__init__(props)

        def show(self, made: TruePrint, dark: tuple[float, ...], light: tuple[float, ...]) -> None:
            """Set the print, with reflectances in the number of channels of the variant."""
            self.ink = ink_of(made, mi.Float)
            self.is_even = made.amplitude == 0.0
            self.dark, self.light = mi.Spectrum(*dark), mi.Spectrum(*light)

        def eval(self, si: Jit, active: Jit = True) -> Jit:  # noqa: FBT002 -- the signature is Mitsuba's
            """Return the reflectance at surface points."""
            reflectance = dr.select(self.ink.is_dark(si.uv) & active, self.dark, self.light)
            if self.is_even:
                return reflectance
            return dr.clip(reflectance * self.ink.paper.evenness(si.uv), 0.0, 1.0)

        def mean(self) -> Jit:
            """Return the reflectance of the bare board, roughly the mean."""
            return dr.mean(self.light)

        def is_spatially_varying(self) -> bool:
            """Return True."""
            return True

        def to_string(self) -> str:
            """Return its name."""
            return "DotTexture[]"

    name = f"labcal-dots-{variant}"
    mi.register_texture(name, DotTexture)
    return name
