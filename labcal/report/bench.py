"""The document of ``labcal bench``: figures against their limits."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict
from rich.table import Table
from rich.text import Text

from labcal.errors import InputError
from labcal.extras import optional_module
from labcal.public_object import HtmlTable, PublicObject
from labcal.report.values import Measured
from labcal.run.file_reading import MOST_OF_A_DOCUMENT, read_text
from labcal.run.json_reading import json_content

if TYPE_CHECKING:
    import pandas


class Check(BaseModel):
    """One measured figure."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    value: Measured
    limit: float
    """Largest value that is good."""
    ok: bool


def at_most(name: str, value: float, limit: float) -> Check:
    """Return the check that a figure does not exceed its limit; NaN does."""
    return Check(name=name, value=float(value), limit=limit, ok=bool(value <= limit))


class Figure(BaseModel):
    """A figure for comparison: of other software, or without a limit."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    value: Measured


class BenchResult(PublicObject, BaseModel):
    """All checks of one benchmark."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    bench: str
    quick: bool
    checks: tuple[Check, ...]
    beside: tuple[Figure, ...] = ()
    """For comparison; without a limit."""
    notes: tuple[str, ...] = ()
    """Notes on checks that were left out, with the reason."""

    @property
    def failed(self) -> int:
        """Number of failed checks."""
        return sum(not check.ok for check in self.checks)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line for each check: ``name``, ``value``, ``limit`` and ``ok``.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(
            [check.model_dump() for check in self.checks], columns=list(Check.model_fields)
        )
        return frame

    def _summary(self) -> Mapping[str, object]:
        return {"bench": self.bench, "checks": len(self.checks), "failed": self.failed, "quick": self.quick}

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [
            [check.name, f"{check.value:.4g}", f"{check.limit:g}", "ok" if check.ok else "missed"]
            for check in self.checks
        ]
        return [HtmlTable(("check", "value", "limit", ""), rows)]


def bench_of(path: Path) -> str | None:
    """Return the benchmark whose ``results.json`` a file is; None if it is none, or cannot be read.

    Parameters
    ----------
    path : Path
    """
    try:
        content = json_content(read_text(path, "document of results", MOST_OF_A_DOCUMENT), str(path))
    except InputError:
        return None
    bench = content.get("bench") if isinstance(content, dict) else None
    return bench if isinstance(bench, str) else None


def bench_table(result: BenchResult) -> Table:
    """Return the checks for people."""
    done = len(result.checks) - result.failed
    quick = " --quick" if result.quick else ""
    table = Table(title=f"labcal bench {result.bench}{quick}: {done} of {len(result.checks)} good")
    for column, side in (("check", "left"), ("value", "right"), ("limit", "right"), ("", "left")):
        table.add_column(column, justify="right" if side == "right" else "left")
    for check in result.checks:
        verdict = Text("ok", "green") if check.ok else Text("missed", "bold red")
        table.add_row(check.name, f"{check.value:.4g}", f"{check.limit:g}", verdict)
    for figure in result.beside:
        table.add_row(figure.name, f"{figure.value:.4g}", "", Text("beside"), style="dim")
    table.caption = "\n".join(result.notes) or None
    return table
