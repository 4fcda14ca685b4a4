"""The page of ``labcal rehearse``: what to expect, what would help most, the map, boards and poses."""

from math import isfinite

from labcal.evaluate.verdict.amounts import millimetres
from labcal.geometry.poses import transform
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Section
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.space_view import SpaceView
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.page_maker import PageMaker
from labcal.report.rehearsal_figures import map_svg, poses_svg, views_svg
from labcal.report.rehearsal_result import RehearseResult, rehearse_result
from labcal.report.rehearsal_tables import map_table, poses_table
from labcal.report.rehearsal_words import (
    board_words,
    expected_words,
    poses_words,
    print_words,
    verdict_words,
    views_words,
)
from labcal.report.space import Space
from labcal.report.target_outline import target_outline
from labcal.wording import counted


def rehearsal_page(found: Rehearsal, maker: PageMaker) -> Page:
    """Return the page of a rehearsal.

    Parameters
    ----------
    found : Rehearsal
    maker : PageMaker
    """
    result, plan = rehearse_result("", found), found.plan
    return Page(
        title=f"Rehearsal of {plan.name}",
        heading=f"Rehearsal of {plan.name}",
        lead=plan.description or f"{counted(len(plan.cameras), 'camera')}, target {plan.target.name}.",
        sections=[
            Section(
                "What would help most",
                [_limits_table(result), *_print(result), Prose((_HALVED,), Tone.QUIET)],
            ),
            Section(
                "Expected errors",
                [Chart("map", map_svg(found), _MAP, map_table(found)), *_confirmation(result)],
            ),
            Section(
                "Views",
                [
                    Prose((views_words(result), *poses_words(result))),
                    Chart("views", views_svg(found), "Expected error over the volume by number of views."),
                    Chart("poses", poses_svg(found), _POSES, poses_table(found)),
                ],
            ),
            Section("Board", [Prose((board_words(result),)), _boards_table(result)]),
            Section("In space", [SpaceView("space", _space(found), _IN_SPACE)]),
        ],
        provenance=maker.provenance,
        opening=[Prose(tuple(_opening(result))), *maker.notes(found.warnings)],
    )


_HALVED = (
    "Each row is a forecast of its own with one thing changed. Errors are RMS lengths in 3-D over the points "
    "that all cameras see before and after the change, in the frame of the first camera."
)
_MAP = (
    "Expected errors in slices across the volume, near, in the middle and far: the RMS 3-D error of a point "
    "in the frame of the first camera, its standard deviation in depth (away from the middle of the "
    "cameras), the share of the calibration, which all points have in common, and the error of shape, "
    "which a rigid alignment leaves. X points right, Y down, Z away from the cameras."
)
_POSES = (
    "The target's edge in each recommended view, as the first camera sees it; the dot is its first dot, the "
    "angle its tilt. Of random poses these cover most of the pictures and of the directions of tilts."
)
_IN_SPACE = "Cameras with their fields of view, and the target in the recommended views."


def _opening(result: RehearseResult) -> list[str]:
    best = result.limits[0]
    helps = (
        f"What would help most: {best.change}, to {millimetres(best.after_mm)} "
        f"({100.0 * best.gain:.0f}% less)."
        if isfinite(best.gain) and best.gain > 0.0
        else "Nothing that was tried would help."
    )
    return [*expected_words(result), helps]


def _limits_table(result: RehearseResult) -> PageTable:
    columns = [
        Column("limit", Side.LEFT),
        Column("halved by", Side.WIDE),
        Column("gain"),
        Column("after, mm"),
        Column("before, mm"),
    ]
    rows = [
        [
            one.name,
            one.change if one.why_not is None else f"{one.change}: {one.why_not}",
            f"{100.0 * one.gain:.0f}%" if isfinite(one.gain) else MISSING,
            f"{one.after_mm:.3g}" if isfinite(one.after_mm) else MISSING,
            f"{one.before_mm:.3g}",
        ]
        for one in result.limits
    ]
    return PageTable("limits", "What limits the rig, and what halving it brings.", columns, rows)


def _boards_table(result: RehearseResult) -> PageTable:
    columns = [
        Column("scale", Side.LEFT, "Of the planned target"),
        Column("board, mm"),
        Column("dots, px", meaning="Median minor semi-axis of the dots in the pictures"),
        Column("of the picture", meaning="Share that the dots span in the median view"),
        Column("measured", meaning="Share of the dots that the detector measures in drawn pictures"),
        Column("RMS error, mm"),
        Column("", Side.WIDE),
    ]
    rows = [
        [
            f"{one.scale:g}",
            f"{one.size_mm[0]:.0f} x {one.size_mm[1]:.0f}",
            f"{one.dot_px:.1f}" if isfinite(one.dot_px) else MISSING,
            f"{100.0 * one.coverage:.0f}%" if isfinite(one.coverage) else MISSING,
            f"{100.0 * one.found:.0f}%" if isfinite(one.found) else MISSING,
            f"{one.rms_mm:.3g}" if isfinite(one.rms_mm) else MISSING,
            one.why_not or ("planned" if one.scale == 1.0 else ""),
        ]
        for one in result.boards
    ]
    return PageTable("boards", "The planned target, printed in other sizes.", columns, rows)


def _print(result: RehearseResult) -> list[Part]:
    words = print_words(result)
    return [Prose(tuple(words))] if words else []


def _confirmation(result: RehearseResult) -> list[Part]:
    one = result.confirmation
    if one is None:
        return []
    columns = [
        Column("rendered", Side.WIDE),
        Column("found"),
        Column("foretold", meaning="With the noise of the renderer's finitely many rays"),
        Column("by chance", meaning="Range of so many calibrations, in 95 of 100"),
    ]
    ranges = [f"{low:.3g} to {high:.3g}" for low, high in (one.shape_range_mm, one.range_mm)]
    rows = [
        ["shape and size, mm", f"{one.shape_rms_mm:.3g}", f"{one.shape_expected_mm:.3g}", ranges[0]],
        ["frame of the first camera, mm", f"{one.rms_mm:.3g}", f"{one.expected_mm:.3g}", ranges[1]],
        ["dots, px", f"{one.dot_rms_px:.2g}", f"{one.dot_expected_px:.2g}", MISSING],
        ["rank correlation of the map", f"{one.map_rank:.2f}", MISSING, f"{one.map_rank_lowest:.2f} to 1"],
    ]
    title = "RMS errors in rendered pictures beside the foretold ones."
    table = PageTable("confirmation", title, columns, rows)
    return [Prose(tuple(verdict_words(one))), table]


def _space(found: Rehearsal) -> Space:
    outline = target_outline(found.plan.target)
    cameras = {name: found.rig.camera(name) for name in found.rig.cameras}
    seen = found.forecast.seen
    planned = PlannedRig.of(found.plan)
    points = transform(planned.T_first_plan, found.forecast.grid[seen])
    return Space(cameras, [transform(T, outline) for T in found.views], points)
