"""Errors of points for people."""

from math import isnan

from rich.table import Table

from labcal.evaluate.against_truth import TruthErrors
from labcal.evaluate.held_out_lengths import HeldOutLengths
from labcal.evaluate.own_lengths import LengthErrors
from labcal.evaluate.scored_views import scored_description
from labcal.wording import counted, listed


def error_table(errors: TruthErrors | LengthErrors) -> Table:
    """Return the errors of points, against the truth or of lengths."""
    return _against_truth(errors) if isinstance(errors, TruthErrors) else _of_lengths(errors)


def _against_truth(errors: TruthErrors) -> Table:
    x, y, z = errors.mean_signed_mm
    caption = (
        f"scored: {errors.scored}, {counted(errors.not_scored, 'other')} not; alignment: {errors.alignment}\n"
        f"{scored_description(len(errors.views_scored), errors.views_calibrated_on)}"
    )
    table = Table("error against truth", "mm", caption=caption, caption_justify="left")
    table.add_row("points", str(errors.n))
    table.add_row("mean signed error (x, y, z)", f"{x:+z.4f}, {y:+z.4f}, {z:+z.4f}")
    for name, value in (
        ("mean distance", errors.mae_mm),
        ("RMS", errors.rmse_mm),
        ("95th percentile", errors.p95_mm),
        ("maximum", errors.max_mm),
        ("limit: triangulation by exact cameras (RMS)", errors.limit_mm),
    ):
        if not isnan(value):  # the limit, without detections
            table.add_row(name, f"{value:.4f}")
    if not isnan(errors.coverage95):
        table.add_row("within the stated 95% ellipsoid", f"{100 * errors.coverage95:.1f} %")
    if not isnan(errors.coverage95_distances):
        table.add_row(
            "distances within 95% by their own sigmas", f"{100 * errors.coverage95_distances:.1f} %"
        )
    for name, count, share in shape_shares(errors):
        table.add_row(name, f"{100 * share:.1f} % of {count}")
    return table


def shape_shares(errors: TruthErrors) -> list[tuple[str, int, float]]:
    """Return the names of planes and motions that were scored, their number, and the share within 95%."""
    both = (
        ("planes of views within 95% (of one calibration: alike)", errors.n_planes, errors.coverage95_planes),
        ("motions from view to view within 95% (alike)", errors.n_motions, errors.coverage95_motions),
    )
    return [(name, count, share) for name, count, share in both if count]


def _of_lengths(errors: LengthErrors) -> Table:
    scored = scored_description(len(errors.views_scored), errors.views_calibrated_on)
    caption = f"{counted(errors.n, 'length')} in {scored}"
    table = Table("error of lengths on the target", "", caption=caption, caption_justify="left")
    table.add_row("maximum", f"{errors.length_error_mm.max:.4f} mm")
    table.add_row("RMS", f"{errors.length_error_mm.rms:.4f} mm")
    table.add_row("scale", f"{errors.scale_ppm:+.1f} ppm")
    if isinstance(errors, HeldOutLengths):
        table.add_section()
        for part in errors.parts:
            table.add_row(
                f"{listed(part.views)}, by {counted(part.calibrated_on, 'other')}",
                f"RMS {part.rms_mm:.4f} mm, scale {part.scale_ppm:+.1f} ppm",
            )
    return table
