"""The target's print as an analytic Mitsuba texture: exact edges at any magnification, and no bitmap."""

from functools import cache

from labcal.render.variant import Jit
from labcal.targets.grid import DotGrid, Polarity


@cache
def dots_plugin(variant: str) -> str:
    """Register the texture with the variant in use and return its plugin name.

    Parameters
    ----------
    variant : str
        The variant in use.
    """
    import drjit as dr  # noqa: PLC0415 -- only once Dr.Jit was told where LLVM is
    import mitsuba as mi  # noqa: PLC0415 -- names resolve to the variant in use

    class DotTexture(mi.Texture):
        """Reflectance of a dot grid over its board; uv runs from 0 to 1 along the board's edges."""

        def __init__(self, props: Jit) -> None:
            super().__init__(props)

        def show(self, target: DotGrid, dark: tuple[float, ...], light: tuple[float, ...]) -> None:
            """Become the print of a target, with reflectances in the variant's number of channels."""
            self.target = target
            self.dark, self.light = mi.Spectrum(*dark), mi.Spectrum(*light)

        def is_dark(self, uv: Jit) -> Jit:
            """Return where the print is dark, from the distance to the nearest dot's centre in mm."""
            target = self.target
            x_min, y_min, x_max, y_max = target.extent_mm
            x = uv.x * (x_max - x_min) + x_min
            y = uv.y * (y_max - y_min) + y_min
            col = dr.clip(dr.round(x / target.pitch_x_mm), 0, target.cols - 1)
            row = dr.clip(dr.round(y / target.pitch_y_mm), 0, target.rows - 1)
            dx, dy = x - col * target.pitch_x_mm, y - row * target.pitch_y_mm
            r2 = dx * dx + dy * dy
            ring = mi.Bool(False)
            for ring_col, ring_row in target.ring_indices:
                ring |= (col == ring_col) & (row == ring_row)
            outer = dr.select(ring, target.ring_outer_diameter_mm, target.dot_diameter_mm)
            inner = dr.select(ring, target.ring_inner_diameter_mm, 0.0)
            inked = (4.0 * r2 <= outer * outer) & (4.0 * r2 >= inner * inner)
            return inked if target.polarity is Polarity.BLACK_ON_WHITE else ~inked

        def eval(self, si: Jit, active: Jit = True) -> Jit:  # noqa: FBT002 -- the signature is Mitsuba's
            """Return the reflectance at surface points."""
            dark = self.is_dark(si.uv) & active
            return dr.select(dark, self.dark, self.light)

        def mean(self) -> Jit:
            """Return the reflectance of the bare board, roughly the mean."""
            return dr.mean(self.light)

        def is_spatially_varying(self) -> bool:
            """Return that it varies."""
            return True

        def to_string(self) -> str:
            """Return its name."""
            return "DotTexture[]"

    name = f"labcal-dots-{variant}"
    mi.register_texture(name, DotTexture)
    return name
