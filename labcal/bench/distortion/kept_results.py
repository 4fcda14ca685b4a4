"""Results of a benchmark of distortion that were written before: the findings of a folder."""

from collections import Counter
from collections.abc import Iterator
from itertools import product
from pathlib import Path

from pydantic import ValidationError

from labcal.bench.distortion.case import Cell, Layout, Source
from labcal.bench.distortion.cell_summary import summarised
from labcal.bench.distortion.figures import RegionFigures
from labcal.bench.distortion.lines import HEADER, Line, line_cells
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.result import DistortionResult
from labcal.errors import InputError
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
        A file is missing, damaged, edited, or of another version or another run than the other one.
    """
    result = read_document(DistortionResult, "document of results", folder / RESULTS)
    lines = read_lines(folder / TABLE)
    _require_of_one_run(result, lines, folder)
    return Findings(result, summarised(lines), (folder / TABLE).read_text(encoding="utf-8"))


def read_lines(path: Path) -> list[Line]:
    """Return the lines of ``results.csv`` but those of detections of one's own, which are of no cell.

    Raises
    ------
    InputError
        It cannot be read, or a line is damaged or edited.
    """
    return list(_lines(path))


_Place = tuple[str, Cell, str, int]
"""Method, cell, region and seed."""


def _require_of_one_run(result: DistortionResult, lines: list[Line], folder: Path) -> None:
    """Raise unless a table has each line that a plan asks for, and no other one."""
    plan = result.plan
    cases = plan.model_copy(update={"methods": ()}).cases(result.first_seed)  # imports no method of one's own
    asked: Counter[_Place] = Counter(
        (method, case.cell, str(region), case.seed)
        for case in cases
        for method, region in product(plan.methods, case.regions)
    )
    there: Counter[_Place] = Counter((line.method, line.cell, line.measured, line.seed) for line in lines)
    if asked != there:
        missing, strange = (asked - there).total(), (there - asked).total()
        raise InputError(
            f"{TABLE} and {RESULTS} in {folder} are not of one run, or edited: of the lines that the plan "
            f"asks for {missing} are missing, and {strange} are there besides. Give the folder as it was "
            "made, or measure again."
        )


def _lines(path: Path) -> Iterator[Line]:
    for number, cells in enumerate(read_table(HEADER, "results", path)):
        row = dict(zip(HEADER, cells, strict=True))
        if row["source"] == Source.DETECTIONS:
            continue
        try:
            line = _line(row)
            as_made = [repr(one) if isinstance(one, float) else str(one) for one in line_cells(line)]
        except (KeyError, ValueError, ValidationError, ZeroDivisionError) as error:
            raise damaged_line(path, number, cells) from error
        if as_made != cells:
            other = next(name for name, one, now in zip(HEADER, as_made, cells, strict=True) if one != now)
            raise damaged_line(path, number, cells, f"its {other} does not follow from the other cells")
        yield line


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
