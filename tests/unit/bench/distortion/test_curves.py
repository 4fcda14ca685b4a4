"""Figures: axes that have a scale, and labels that nothing hides."""

from made_up_distortion import made_up_findings

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.curves import coverage_figure, error_figure, with_figures
from labcal.bench.distortion.sensitivity_figures import sensitivity_figure

FEW = ("methods=dlt,bundle", "families=brown", "noise_px=0.1", "points=140")


def test_a_single_strength_stands_on_an_axis_of_all_strengths() -> None:
    findings = made_up_findings("quick", (*FEW, "strengths=0.6", "faults=none"), 1)
    cells = with_figures(findings.summaries, Measured.WITHIN)
    for draw in (error_figure, coverage_figure):
        low, high = draw(cells, "brown").axes[0].get_xlim()
        assert low < 0.0
        assert high > 1.0


def test_the_legend_of_sensitivities_leaves_the_label_of_the_axis_free() -> None:
    found = made_up_findings("quick", (*FEW, "strengths=0.6", "faults=pitch-0.001"), 1).result.sensitivity
    figure = sensitivity_figure(found, "brown")
    figure.draw_without_rendering()
    label = figure.axes[0].xaxis.label.get_window_extent()
    assert label.width > 0.0
    assert not label.overlaps(figure.legends[0].get_window_extent())
