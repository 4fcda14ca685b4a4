"""Results of a benchmark of distortion that were written before: the findings of a folder."""

from collections.abc import Iterator
from pathlib import Path

from pydantic import ValidationError

from labcal.bench.distortion.case import Cell, Layout, Source
from labcal.bench.distortion.cell_summary import summarised
from labcal.bench.distortion.figures import RegionFigures
from labcal.bench.distortion.lines import HEADER, Line
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.result import DistortionResult
from labcal.run.documents import read_document
from labcal.run.tables import damaged_line, read_table

RESULTS, TABLE = "results.json", "results.csv"


def read_findings(folder: Path) -> Findings:
    """Return the findings of a folder that ``labcal bench distortion`` made.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    InputError
        A file is missing, damaged, or of another version.
    """
    result = read_document(DistortionResult, "document of results", folder / RESULTS)
    lines = read_lines(folder / TABLE)
    return Findings(result, summarised(lines), (folder / TABLE).read_text(encoding="utf-8"))


def read_lines(path: Path) -> list[Line]:
    """Return the lines of ``results.csv`` but those of detections of one's own, which are of no cell.

    Raises
    ------
    InputError
        It cannot be read, or a line is damaged.
    """
    return list(_lines(path))


def _lines(path: Path) -> Iterator[Line]:
    for number, cells in enumerate(read_table(HEADER, "results", path)):
        row = dict(zip(HEADER, cells, strict=True))
        if row["source"] == Source.DETECTIONS:
            continue
        try:
            yield _line(row)
        except (ValueError, ValidationError) as error:
            raise damaged_line(path, number, cells) from error


def _line(row: dict[str, str]) -> Line:
    source = Source(row["source"])
    cell = Cell(
        row["family"],
        float(row["strength"]),
        float(row["noise_px"]) if source is Source.SIMULATED else 0.0,
        int(row["points"]),
        Layout(row["layout"]),
        source,
        row["fault"],
    )
    return Line(
        row["method"],
        cell,
        int(row["seed"]),
        row["measured"],
        _figures(row) if int(row["n"]) else None,
        int(row["trained"]),
        float(row["beyond_pinhole_px"]),
        bool(int(row["model_misfit"])) if row["model_misfit"] else None,
        float(row["expected_mm"]),
        row["reason"] or None,
        float(row["pixel_error_px"]),
    )


def _figures(row: dict[str, str]) -> RegionFigures:
    return RegionFigures(
        measured=row["measured"],
        n=int(row["n"]),
        predicted=int(row["predicted"]),
        rmse_mm=float(row["rmse_mm"]),
        oracle_mm=float(row["oracle_mm"]),
        stated=int(row["stated"]),
        covered=int(row["covered"]),
        extrapolated=int(row["extrapolated"]),
    )
