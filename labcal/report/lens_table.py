"""Comparison of lens models, for people."""

from rich.table import Table

from labcal.calibrate.lens_choice import LensChoice
from labcal.report.columns import name_column


def lens_table(choice: LensChoice) -> Table:
    """Return the table of the models that were tried, the chosen one marked."""
    worse_by = "worse than the best by [px\u00b2]"
    table = Table(name_column("lens"), "RMS held out [px]", worse_by, "", title="lens models")
    for trial in choice.trials:
        if trial.refused is not None:
            table.add_row(trial.lens, "", "", trial.refused, style="dim")
            continue
        worse = f"{trial.worse_px2:.2g} \u00b1 {trial.chance_px2:.1g}"
        verdict = "chosen" if trial.lens == choice.lens else "as good" if trial.as_good else ""
        table.add_row(trial.lens, f"{trial.held_out_px:.4f}", worse, verdict)
    return table
