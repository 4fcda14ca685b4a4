"""Tables and histograms of the errors of points, as parts of their page."""

import numpy as np

from labcal.correspond.boards_points import own_indices
from labcal.correspond.matching import rows_by_name
from labcal.correspond.points import Points
from labcal.correspond.points_csv import BOARD
from labcal.evaluate.against_truth import TruthErrors
from labcal.evaluate.own_lengths import LengthErrors
from labcal.evaluate.verdict.of_truth_errors import over_limit
from labcal.report.dot_words import dot_words
from labcal.report.error_histogram import error_histogram
from labcal.report.error_tables import shape_shares
from labcal.report.page.chart import Chart
from labcal.report.page.download import Download, table_download
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose
from labcal.report.page.table import Column, PageTable, Side
from labcal.report.scored_points import ScoredPoints
from labcal.targets.board_set import BoardSet
from labcal.wording import counted

_MOST_VIEWS = 60
"""In the table of views."""


def labels(points: Points, target: object) -> list[str]:
    """Return what a reader sees of each point that is pointed at."""
    rows = zip(points.view.tolist(), dot_words(points.index, target), points.flag.tolist(), strict=True)
    return [f"{view}, {dot} ({flag})" for view, dot, flag in rows]


def truth_table(errors: TruthErrors) -> PageTable:
    """Return the errors against a truth."""
    x, y, z = errors.mean_signed_mm
    rows = [
        ["points", str(errors.n)],
        ["mean error in X, Y, Z, with sign", f"{x:+.4f}, {y:+.4f}, {z:+.4f} mm"],
        ["mean length", f"{errors.mae_mm:.4f} mm"],
        ["RMS", f"{errors.rmse_mm:.4f} mm"],
        ["95th percentile", f"{errors.p95_mm:.4f} mm"],
        ["greatest", f"{errors.max_mm:.4f} mm"],
    ]
    if not np.isnan(errors.limit_mm):
        rows.append(["limit of triangulation by exact cameras (RMS)", f"{errors.limit_mm:.4f} mm"])
        rows.append(["RMS over this limit", f"{over_limit(errors):.2f}"])
    if not np.isnan(errors.coverage95):
        rows.append(["points within the stated 95% ellipsoid", f"{100 * errors.coverage95:.1f}%"])
    if not np.isnan(errors.coverage95_distances):
        rows.append(["distances within 95% by their own sigmas", f"{100 * errors.coverage95_distances:.1f}%"])
    rows += [[name, f"{100 * share:.1f}% of {count}"] for name, count, share in shape_shares(errors)]
    rows.append(["alignment", errors.alignment])
    caption = f"Errors of {errors.scored}; {counted(errors.not_scored, 'other')} not scored."
    return PageTable("figures-table", caption, [Column("figure", Side.LEFT), Column("value")], rows)


def truth_spread(errors: TruthErrors) -> Chart:
    """Return how the lengths of errors are spread."""
    marks = {"RMS": errors.rmse_mm, "95th percentile": errors.p95_mm, "limit (RMS)": errors.limit_mm}
    svg = error_histogram(np.linalg.norm(errors.error, axis=1), "length of the error (mm)", "points", marks)
    return Chart("histogram", svg, "How the lengths of the errors are spread.")


def length_table(errors: LengthErrors) -> PageTable:
    """Return the errors of lengths."""
    rows = [
        ["lengths", str(errors.n)],
        ["RMS", f"{errors.length_error_mm.rms:.4f} mm"],
        ["greatest", f"{errors.length_error_mm.max:.4f} mm"],
        ["scale", f"{errors.scale_ppm:+.1f} ppm"],
    ]
    caption = "Errors of the lengths between all pairs of dots of a view (VDI/VDE 2634 part 1)."
    return PageTable("figures-table", caption, [Column("figure", Side.LEFT), Column("value")], rows)


def length_spread(errors: LengthErrors) -> Chart:
    """Return how the errors of lengths are spread."""
    rms = errors.length_error_mm.rms
    marks = {"RMS": rms, "minus RMS": -rms}
    svg = error_histogram(errors.error, "measured minus nominal length (mm)", "lengths", marks)
    return Chart("histogram", svg, "How the errors of lengths are spread.")


def view_table(scored: ScoredPoints) -> Part:
    """Return the errors by view."""
    length = np.linalg.norm(scored.error, axis=1)
    rows = []
    for view, lines in rows_by_name(scored.points.view).items():
        x, y, z = scored.error[lines].mean(axis=0)
        rms, most = float(np.sqrt((length[lines] ** 2).mean())), float(length[lines].max())
        rows.append(
            [view, str(len(lines)), f"{rms:.4f}", f"{most:.4f}", f"{x:+.4f}", f"{y:+.4f}", f"{z:+.4f}"]
        )
    if not rows:
        return Prose(("No view has three points that its target could be laid onto.",))
    headings = ("points", "RMS, mm", "greatest, mm", "mean in X, mm", "mean in Y, mm", "mean in Z, mm")
    columns = [Column("view", Side.LEFT), *map(Column, headings)]
    caption = "Errors by view."
    if len(rows) > _MOST_VIEWS:
        caption = f"Errors by view: the {_MOST_VIEWS} views with the largest errors of {len(rows)}."
        rows = sorted(rows, key=lambda row: -float(row[2]))[:_MOST_VIEWS]
    return PageTable("views-table", caption, columns, rows)


def error_file(scored: ScoredPoints, target: object) -> Download:
    """Return every error as a table; of several boards, with the board of each dot."""
    points = scored.points
    figures = np.round(np.concatenate([scored.places, scored.error], axis=1).T, 5).tolist()
    header = ("view", "col", "row", "X_mm", "Y_mm", "Z_mm", "X_error_mm", "Y_error_mm", "Z_error_mm", "flag")
    if not isinstance(target, BoardSet):
        columns = (points.view.tolist(), *points.index.T.tolist(), *figures, points.flag.tolist())
        return table_download("errors.csv", header, columns)
    own, boards = own_indices(points.index, target)
    columns = (points.view.tolist(), *own.T.tolist(), *figures, points.flag.tolist(), boards.tolist())
    return table_download("errors.csv", (*header, BOARD), columns)
