"""The page of ``labcal diagnose``: what is wrong, how to mend it, and the pictures that show it."""

from math import isfinite

import numpy as np

from labcal.evaluate.verdict.amounts import millimetres
from labcal.evaluate.verdict.verdict import Belief, Verdict
from labcal.guide.diagnosis.diagnosis import Diagnosis
from labcal.guide.diagnosis.finding import Finding
from labcal.report.diagnose_result import harm_words, refused_words
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Section
from labcal.report.page.part import Part
from labcal.report.page.photograph import Photograph
from labcal.report.page.prose import Prose
from labcal.report.page.statement import Statement
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.page_maker import PageMaker
from labcal.report.view_misfits import view_misfits
from labcal.wording import counted

_ORDER = (
    "The mistakes are in the order of what they cost. The cost is the RMS 3-D error, over the volume where "
    "the target was, that a rig calibrated from these pictures has by the mistake; per cent are of the error "
    "that noise and number of views leave anyway. It is an order of size: of large mistakes it is off by up "
    "to several times."
)
_ARROWS = "Arrows are residuals of the dots, predicted minus measured, where all views share one rig."
_MISFIT = "RMS residuals of each view in units of their expected size, where all views share one rig."
_MOST_PICTURES = 2
_SHOWN_CHANCE = 1e-99


def diagnosis_page(found: Diagnosis, maker: PageMaker) -> Page:
    """Return the page of a diagnosis.

    Parameters
    ----------
    found : Diagnosis
    maker : PageMaker
    """
    evidence = found.evidence
    sections = []
    if found.findings:
        sections.append(Section("What is wrong", [Prose((_ORDER,)), _table(found, maker)]))
    sections += [
        Section(f"{number}. {one.check.value}", _evidence(found, one, number, maker))
        for number, one in enumerate(found.findings, start=1)
    ]
    if found.explained:
        words = [f"{one.check.value}: explained by {one.explained_by}." for one in found.explained]
        sections.append(Section("Explained by these", [Prose(tuple(words))]))
    if found.refused:
        sections.append(Section("Pictures left out", [Prose((maker.phrase(refused_words(found)),))]))
    if found.warnings:
        words = [maker.phrase(one) for one in found.warnings]
        sections.append(Section("Warnings of the calibration", [Prose(tuple(words))]))
    if found.not_judged:
        columns = [Column("check", Side.LEFT), Column("why", Side.WIDE)]
        rows = [[one.check.value, maker.phrase(one.why)] for one in found.not_judged]
        table = PageTable("not-judged", "Checks that could not be made.", columns, rows)
        sections.append(Section("Not judged", [table]))
    views = len(evidence.detections.views)
    return Page(
        title=f"Diagnosis of {', '.join(evidence.cameras)}",
        heading=f"Diagnosis of a shoot with {', '.join(evidence.cameras)}",
        lead=f"{counted(views, 'view')}, {counted(int(evidence.detections.ok.sum()), 'dot')}, target "
        f"'{evidence.target.name}'.",
        sections=sections,
        provenance=maker.provenance,
        opening=[Statement(_verdict(found), maker.phrase)],
    )


def _verdict(found: Diagnosis) -> Verdict:
    """Return the verdict as pages state them."""
    expected = found.evidence.expected_mm
    usual = millimetres(float("nan") if expected is None else expected)
    leaves_out = ("a print that is too large as a whole, of which no view tells",)
    if not found.findings:
        return Verdict(
            expectation=f"errors of about {usual} (RMS, in 3-D) by noise and number of views",
            belief=Belief.YES,
            reasons=(
                f"{counted(len(found.not_judged), 'check')} could not be made, all others find nothing",
            ),
            limit="noise and number of views",
            advice="calibrate",
            leaves_out=leaves_out,
        )
    worst = found.findings[0]
    adds = "no usable rig"
    if worst.harm_mm is not None and isfinite(worst.harm_mm):
        by = f"by {worst.check.value}, beside {usual}"
        adds = f"errors of about {millimetres(worst.harm_mm)} (RMS, in 3-D) {by}"
    return Verdict(
        expectation=adds,
        belief=Belief.NO,
        reasons=(worst.words.rstrip("."),),
        limit=f"{worst.check.value}",
        advice=f"mend {worst.check.value} first",
        leaves_out=leaves_out,
    )


def _table(found: Diagnosis, maker: PageMaker) -> PageTable:
    columns = [
        Column("mistake", Side.LEFT), Column("what is wrong", Side.WIDE), Column("how to mend it", Side.WIDE),
        Column("adds about (mm)"), Column("adds about (%)"), Column("p-value"),
    ]  # fmt: skip
    rows = [
        [
            one.check.value, maker.phrase(one.words), maker.phrase(one.mend),
            _number(one.harm_mm), _percent(one.harm_percent),
            _chance(one.p_value),
        ]
        for one in found.findings
    ]  # fmt: skip
    return PageTable("findings", f"{counted(len(rows), 'mistake')}, the most harmful first.", columns, rows)


def _evidence(found: Diagnosis, one: Finding, number: int, maker: PageMaker) -> list[Part]:
    """Return what shows a mistake: words, the views over time, pictures with their residuals."""
    harm = harm_words(one)
    parts: list[Part] = [Prose(tuple(maker.phrase(words) for words in (one.words, harm, one.mend) if words))]
    model = found.evidence.model
    if model is not None and one.views and set(one.views) <= set(model.views) and one.p_value is not None:
        misfit = np.sqrt(model.view_misfits / 2.0)
        name = f"views-{number}"
        drawn = view_misfits(model.views, misfit, frozenset(one.views), name)
        parts.append(Chart(name, drawn, _MISFIT))
    pictures = _photographs(found, one, number)
    if pictures:
        parts += [Prose((_ARROWS,)), *pictures]
    return parts


def _photographs(found: Diagnosis, one: Finding, number: int) -> list[Part]:
    evidence = found.evidence
    dots, rig = evidence.detections, evidence.calibration
    parts: list[Part] = []
    for at, path in enumerate(one.pictures[:_MOST_PICTURES]):
        own = np.flatnonzero((dots.image == path) & dots.ok)
        q, residual = dots.position[own], np.full((len(own), 2), np.nan)
        title, size = path, None
        if len(own):
            width, height = dots.size[own[0]].tolist()
            size = (width, height)
            view, camera = str(dots.view[own[0]]), str(dots.camera[own[0]])
            title = f"{view}, camera {camera}"
            if rig is not None and view in rig.views and camera in rig.rig.cameras:
                of = rig.residuals
                rows = (of.view == rig.views.index(view)) & (of.camera == list(rig.rig.cameras).index(camera))
                if rows.any():
                    q, residual = of.q[rows], of.residual[rows]
        parts.append(Photograph(f"picture-{number}-{at}", path, q, residual, title, size))
    return parts


def _chance(p_value: float | None) -> str:
    if p_value is None:
        return MISSING
    return f"{p_value:.1g}" if p_value > _SHOWN_CHANCE else f"< {_SHOWN_CHANCE:.0e}"


def _percent(value: float | None) -> str:
    """Return a number of two digits, written out: 310, not 3.1e+02."""
    text = _number(value)
    return f"{float(text):.0f}" if "e+" in text else text


def _number(value: float | None) -> str:
    if value is None:
        return MISSING
    return f"{value:.2g}" if isfinite(value) else "no rig"
