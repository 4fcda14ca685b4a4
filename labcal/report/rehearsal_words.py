"""Result of ``labcal rehearse`` in words and as a table, for people."""

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from labcal.calibrate.dot_treatment import DotTreatment
from labcal.evaluate.verdict.amounts import millimetres
from labcal.report.rehearsal_result import ConfirmationResult, RehearseResult
from labcal.wording import counted


def rehearse_table(result: RehearseResult) -> Group:
    """Return the document for people."""
    head = " ".join([f"{result.plan}.", *expected_words(result)])
    table = Table("what helps", "RMS error after it (mm)", "gain")
    for limit in result.limits:
        gain = "-" if limit.why_not else f"{100.0 * limit.gain:.0f}%"
        table.add_row(limit.change, "-" if limit.why_not else f"{limit.after_mm:.3g}", gain)
    parts: list[RenderableType] = [Text(head), table]
    parts += [Text(words) for words in (*print_words(result), *poses_words(result))]
    parts += [Text(views_words(result)), Text(board_words(result))]
    if result.confirmation is not None:
        parts.append(Text(confirmation_words(result.confirmation)))
    files = "index.html, rehearsal.json, map.csv, poses.csv, scene.yaml, rig.json"
    parts.append(Text(f"{result.folder}: {files}."))
    return Group(*parts)


def expected_words(result: RehearseResult) -> list[str]:
    """Return the expected errors in words, sentence by sentence."""
    low, high = result.range_mm
    least, most = result.shape_range_mm
    return [
        (
            f"Expect errors of shape and size of {millimetres(result.shape_mm)} (RMS, in 3-D) "
            f"over the working volume, in whatever frame ({least:.2g} to {most:.2g} mm after a single "
            "calibration, in 95 of 100)."
        ),
        (
            f"In the frame of the first camera expect {millimetres(result.rms_mm)} over many calibrations "
            f"({low:.2g} to {high:.2g} mm after a single one, half of them below {result.median_mm:.2g} mm): "
            f"{result.noise_mm:.2g} mm by the points' pixels, {result.calibration_mm:.2g} mm by the "
            f"calibration; {result.depth_mm:.2g} mm in depth, {result.sideways_mm:.2g} mm sideways."
        ),
    ]


def print_words(result: RehearseResult) -> list[str]:
    """Return what the calibration makes of an uneven print, in words; nothing for an exact print."""
    freed, kept = result.free_dots_mm, result.keep_dots_mm
    if kept is None:
        return []
    if result.dot_places == DotTreatment.FREED.value:
        other = f"with the dots as declared the error would be {millimetres(kept)}"
        return [f"Print: the calibration estimates the places of the dots, too (freed); {other}."]
    if freed is None:
        return ["Print: the places of this target's dots cannot be estimated, too."]
    other = f"with their places estimated, too, the error would be {millimetres(freed)}"
    return [f"Print: the dots are taken as declared; {other}."]


def poses_words(result: RehearseResult) -> list[str]:
    """Return how much the forecast depends on the poses, in words."""
    if not result.other_poses_mm:
        return []
    low, high = min(result.other_poses_mm), max(result.other_poses_mm)
    others = f"{low:.3g} to {high:.3g} mm are expected in place of {result.rms_mm:.3g} mm"
    return [f"Poses: with others that cover as much, {others}."]


def views_words(result: RehearseResult) -> str:
    """Return how many views are enough, in words."""
    if result.enough_views is None:
        return f"Views: {result.views} are planned, and more help up to the largest number tried."
    return (
        f"Views: {result.views} are planned; from {result.enough_views} on, twice as many bring less than a "
        "tenth."
    )


def board_words(result: RehearseResult) -> str:
    """Return which board fits, in words."""
    best = next((one for one in result.boards if one.scale == result.best_board), None)
    if best is None:
        return "Board: no size that was tried fits; see rehearsal.json for why."
    width, height = best.size_mm
    size = f"{width:.0f} x {height:.0f} mm, dots of {best.dot_px:.1f} px radius"
    if best.scale == 1.0:
        return f"Board: the planned size fits best ({size})."
    return f"Board: printed {best.scale:g} times as large ({size}) it would give {best.rms_mm:.3g} mm."


def confirmation_words(one: ConfirmationResult) -> str:
    """Return the confirmation in words."""
    low, high = one.range_mm
    least, most = one.shape_range_mm
    shape = (
        f"Shape and size: {one.shape_rms_mm:.3g} mm found, {one.shape_expected_mm:.3g} mm foretold "
        f"({least:.2g} to {most:.2g} by chance)."
    )
    places = (
        f"In the frame of the first camera: {one.rms_mm:.3g} mm found, {one.expected_mm:.3g} mm foretold "
        f"({low:.2g} to {high:.2g} by chance)."
    )
    dots = f"Dots: {one.dot_rms_px:.2g} px found, {one.dot_expected_px:.2g} px foretold."
    rank = f"Rank correlation of the map: {one.map_rank:.2f} (at least {one.map_rank_lowest:.2f} by chance)."
    verdict, *rest = verdict_words(one)
    return " ".join([verdict, shape, places, dots, rank, *rest])


def verdict_words(one: ConfirmationResult) -> list[str]:
    """Return the verdict of a confirmation, and what to know of it, sentence by sentence."""
    words = [f"Rendered: {counted(one.sets, 'set')}, {'' if one.holds else 'NOT '}as foretold."]
    if one.sets < one.sets_needed:
        needed = counted(one.sets_needed, "set")
        words.append(f"In the frame of the first camera {needed} or more make a test to 15%.")
    alone = f"{one.renderer_px:.2g} px"
    words.append(f"The renderer's finitely many rays alone move dots by {alone} (foretold with it).")
    return words
