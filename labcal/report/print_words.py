"""The shape of a print in words."""

from math import isnan

from labcal.evaluate.print_shape import Figure, PrintShape

_CLEAR = 3.0
"""Number of standard deviations beyond which a figure is a finding."""


def print_words(shape: PrintShape) -> str:
    """Return what the freed dots say about a print, a line each."""
    lines = [
        "scale: the mean is that of the declared pitch; pictures alone determine no length",
        _described("stretch, x over y", shape.stretch_ppm, "ppm", ".0f"),
        _described("shear", shape.shear_mrad, "mrad", ".3f"),
        _described("bow along x", shape.bow_x_mm, "mm", ".4f"),
        _described("bow along y", shape.bow_y_mm, "mm", ".4f"),
        _described("twist", shape.twist_mm, "mm", ".4f"),
        (
            f"deviations from the declared places: RMS {shape.rms_in_plane_mm:.4f} mm in the plane (standard "
            f"deviation of one dot {shape.sigma_in_plane_mm:.4f} mm), {shape.rms_unexplained_mm:.4f} mm "
            f"without stretch and shear, {shape.rms_height_mm:.4f} mm in height"
        ),
    ]
    lines += [
        f"  dot ({dot.col}, {dot.row}): {dot.dx_mm:+.4f}, {dot.dy_mm:+.4f}, {dot.dz_mm:+.4f} mm"
        for dot in shape.worst
    ]
    if shape.held:
        lines.append(f"kept as declared, since the views do not determine them: {', '.join(shape.held)}")
    if shape.kept:
        named = ", ".join(f"({col}, {row})" for col, row in shape.kept)
        lines.append(f"kept where declared, in too few pictures: {named}")
    return "\n".join(lines)


def _described(what: str, figure: Figure, unit: str, form: str) -> str:
    if isnan(figure.value):
        return f"{what}: not determined by these views"
    clear = "" if abs(figure.value) >= _CLEAR * figure.sigma else ", no more than its uncertainty allows"
    return f"{what}: {figure.value:+{form}} ± {figure.sigma:{form}} {unit}{clear}"
