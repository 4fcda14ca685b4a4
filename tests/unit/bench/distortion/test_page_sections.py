"""The sections of the page beyond simulated points: pictures, faults, protocols and detections."""

from dataclasses import replace

import pytest
from made_up_distortion import made_up_findings

from labcal.bench.distortion.case import Source
from labcal.bench.distortion.fault_section import FaultSection
from labcal.bench.distortion.own_detections.result import OwnMethod, OwnResult
from labcal.bench.distortion.page.detections_section import detections_section
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.page import distortion_page
from labcal.bench.distortion.page.plan_rows import plan_rows
from labcal.bench.distortion.page.protocols_section import protocols_section
from labcal.bench.distortion.page.rendered_section import rendered_section
from labcal.bench.distortion.page.sensitivity_section import sensitivity_section
from labcal.bench.distortion.page.trust_section import trust_section
from labcal.bench.distortion.protocols.number_words import number_words
from labcal.bench.distortion.protocols.result import (
    ProtocolFigure,
    ProtocolMethod,
    ProtocolResult,
    PublishedFigure,
)
from labcal.bench.distortion.rendered_plan import RenderedPlan
from labcal.report.page.document import Section

ONE = ("methods=dlt,bundle", "families=brown", "strengths=0,1", "noise_px=0.1", "points=140")
NAN = float("nan")


@pytest.fixture(scope="module")
def plain() -> Findings:
    return made_up_findings("quick", (*ONE, "faults=none"), 1)


def html(section: Section | None) -> str:
    assert section is not None
    return "".join(str(part.html()) for part in section.parts)


def test_they_are_left_out_where_nothing_was_measured(plain: Findings) -> None:
    for make in (rendered_section, sensitivity_section, protocols_section, detections_section):
        assert make(plain) is None


def test_the_curve_of_pictures_is_of_pictures_alone(plain: Findings) -> None:
    pictured = [
        replace(one, cell=replace(one.cell, source=Source.RENDERED, noise_px=0.0), over_oracle=3.25)
        for one in plain.summaries
        if one.measured == "within"
    ]
    figures = [one.model_copy(update={"over_oracle": 3.25}) for one in plain.result.families]
    result = plain.result.model_copy(update={"rendered": tuple(figures)})
    faulty = [
        replace(one, cell=replace(one.cell, fault="bend-1"), over_oracle=77.5, low=77.5, high=77.5)
        for one in pictured
    ]
    section = rendered_section(Findings(result, [*plain.summaries, *pictured, *faulty]))
    assert section == rendered_section(Findings(result, [*plain.summaries, *pictured]))
    shown = html(section)
    assert shown.count('<figure class="chart"') == 1
    assert "noise of the sensor" in shown
    assert "95% ellipsoids hold at least 93% of the errors wherever no flag is raised." in shown
    wrong = [
        replace(one, unflagged_coverage95=0.917 if one.method == "dlt" else NAN)
        for one in pictured
        if one.cell.strength == 1.0
    ]
    shown_wrong = html(rendered_section(Findings(result, [*plain.summaries, *wrong])))
    assert "below 0.93, where the flag model-misfit is not raised: dlt, brown 1 (0.917)." in shown_wrong
    assert "brown, rendered: strength 1 is k1 -0.5." in shown
    assert "3.25" in shown


def test_faults_that_are_noticed_in_every_cell_are_marked() -> None:
    findings = made_up_findings("quick", (*ONE, "faults=pitch-0.001,bend-1"), 1)
    shown = html(sensitivity_section(findings))
    assert shown.count('<figure class="chart"') == 1
    assert "pitch-0.001" in shown
    assert "bend-1" in shown
    assert "excess of all distances on the board" in shown
    assert "Coverage of 95% ellipsoids, median of the cells" in shown
    found = [
        one.model_copy(update={"coverage95": 0.02, "usual_coverage95": 0.95, "misfit": 0})
        for one in findings.result.sensitivity
    ]
    result = findings.result.model_copy(update={"sensitivity": tuple(found)})
    shown = html(sensitivity_section(replace(findings, result=result)))
    assert "0.020!" in shown
    assert "nothing warns of it: pitch-0.001 (coverage 0.020, 0.950 without it)" in shown


def test_published_figures_stand_below_ours(plain: Findings) -> None:
    length = ProtocolFigure(quantity="sd of 1000 mm", unit="mm", median=0.5, low=0.4, high=0.7)
    share = ProtocolFigure(quantity="above 2.5 mm", unit="1", median=0.02, low=0.02, high=0.02)
    missing = length.model_copy(update={"median": NAN, "low": NAN, "high": NAN})
    methods = [
        ProtocolMethod(method=name, figures=figures, coverage95=0.95, flagged=0, seeds=3, reasons=())
        for name, figures in (("dlt", (length, share)), ("bundle", (missing, share)))
    ]
    published = PublishedFigure(
        method="their network", quantity="sd of 1000 mm", unit="mm", value=1.5, words="does not exceed 1.5 mm"
    )
    protocol = ProtocolResult(
        protocol="josa-volume", source="their paper", methods=tuple(methods), published=(published,),
        same=("the volume",), different=("the cameras",),
    )  # fmt: skip
    result = plain.result.model_copy(update={"protocols": (protocol,)})
    shown = html(protocols_section(replace(plain, result=result)))
    assert "0.5 (0.4 to 0.7)" in shown
    assert "2%" in shown
    assert shown.index("published: their network") > shown.index("bundle")
    for words in ("does not exceed 1.5 mm.", "The volume.", "The cameras."):
        assert words in shown


def test_own_detections_have_a_table_with_what_is_not_known(plain: Findings) -> None:
    known = OwnMethod(
        method="dlt", n=50, predicted=50, rmse_mm=0.125, over_best=1.0, stated=50, covered=40, coverage95=0.8,
        model_misfit=True, extrapolated=3, expected_mm=NAN, reasons=(),
    )  # fmt: skip
    refused = known.model_copy(
        update={"method": "affine", "predicted": 0, "rmse_mm": NAN, "model_misfit": None}
    )
    own = OwnResult(name="my-shoot", held_out=(("z-1",),), trained=390, methods=(known, refused))
    result = plain.result.model_copy(update={"detections": (own,)})
    shown = html(detections_section(replace(plain, result=result)))
    for words in ("my-shoot", "dlt*", "0.125", "0.800", "3 of 50"):
        assert words in shown
    assert "nan" not in shown
    assert "On detections of your own" in distortion_page(replace(plain, result=result)).text()


def test_sections_of_the_plan_are_in_words() -> None:
    findings = made_up_findings("quick", (*ONE, "faults=pitch-0.001,bend-1"), 1)
    rows = dict(plan_rows(findings.result))
    assert rows["faults"] == "kinds pitch-0.001, bend-1; families brown; seeds 1"
    assert (rows["rendered"], rows["protocols"]) == ("none", "none")
    pictures = RenderedPlan(families=("brown",), strengths=(0.3,), views=4, spp=8, seeds=1)
    plan = findings.result.plan.model_copy(update={"rendered": pictures, "faults": FaultSection()})
    rows = dict(plan_rows(findings.result.model_copy(update={"plan": plan})))
    assert rows["faults"] == "none"
    assert rows["rendered"] == "families brown; strengths 0.3; views 4; spp 8; seeds 1"


def test_a_share_of_all_is_a_hundred_percent() -> None:
    assert [number_words(one, "1") for one in (1.0, 0.638, 0.0994, 0.0012, 0.0)] == [
        "100%", "64%", "9.9%", "0.12%", "0%",
    ]  # fmt: skip


def test_the_error_of_the_oracle_is_given_in_millimetres(plain: Findings) -> None:
    cells = [replace(one, oracle_mm=0.4 + 0.2 * one.cell.strength) for one in plain.summaries]
    shown = html(trust_section(replace(plain, summaries=cells)))
    assert "RMS error is 0.4 to 0.6 mm at 0.1 px of noise." in shown
