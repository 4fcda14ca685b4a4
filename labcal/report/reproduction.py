"""The document ``results.json`` of ``labcal reproduce``."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated

from pydantic import BaseModel, ConfigDict, Field

from labcal.bounds import Amount, Finite
from labcal.errors import InputError
from labcal.extras import optional_module
from labcal.paths import AnyPath, as_path
from labcal.public_object import HtmlTable, PublicObject
from labcal.report.claims import ClaimResult
from labcal.report.explanations import Explanations
from labcal.report.row_verdict import RowVerdict
from labcal.report.study import StudyCell
from labcal.report.values import Measured, Words
from labcal.run.documents import read_document

if TYPE_CHECKING:
    import pandas

RESULTS = "results.json"
Count = Annotated[int, Field(ge=0, le=10**9)]
"""Of epochs or seeds."""
_MOST = 300
"""Of rows, readings and pictures; the paper has some thirty."""


class Figures(BaseModel):
    """Errors of one reading of a row, on points that were not trained on; medians over the seeds."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    reading: Words
    """The method, and the reading of "5%" of noise if there is noise."""
    mean_signed_m: Measured
    """Mean of predicted minus true over held-out points and all three coordinates, as in the paper."""
    rel: Measured
    """`mean_signed_m` over the mean true coordinate."""
    mae_mm: Measured
    """Mean length of the 3-D error."""
    rmse_mm: Measured
    p95_mm: Measured
    max_mm: Measured
    epochs: Amount | None
    """Accepted training steps; null for least squares."""
    goal_reached: bool | None
    """True if most seeds reached the goal; null for least squares."""
    seconds: Amount
    """Of training."""
    mean_signed_range_m: tuple[Measured, Measured]
    """Least and greatest of the seeds; the other ranges, too."""
    mae_range_mm: tuple[Measured, Measured]
    rmse_range_mm: tuple[Measured, Measured]
    p95_range_mm: tuple[Measured, Measured]
    max_range_mm: tuple[Measured, Measured]
    epochs_range: tuple[Amount, Amount] | None
    """Null for least squares."""
    seconds_range: tuple[Amount, Amount]
    further_rmse: tuple[Measured, ...] = ()
    """RMS error of the outputs after X, Y and Z, mm."""


class RowResult(BaseModel):
    """One row of the paper beside ours."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    exp: Words
    solver: Words
    data: Words
    points: int
    network: Words | None
    goal: Amount | None
    seeds: Count
    reading: Words
    """The reading of the row; for least squares the one nearest to the paper."""
    epochs: Amount | None
    paper_epochs: Count | None
    goal_reached: bool | None
    mean_signed_m: Measured
    rel: Measured
    paper_abs_m: Finite
    paper_rel: Finite
    mae_mm: Measured
    rmse_mm: Measured
    p95_mm: Measured
    max_mm: Measured
    seconds: Amount
    mean_signed_range_m: tuple[Measured, Measured]
    mae_range_mm: tuple[Measured, Measured]
    rmse_range_mm: tuple[Measured, Measured]
    p95_range_mm: tuple[Measured, Measured]
    max_range_mm: tuple[Measured, Measured]
    epochs_range: tuple[Amount, Amount] | None
    seconds_range: tuple[Amount, Amount]
    verdict: RowVerdict
    contradiction: Words | None
    """The contradiction within the paper that concerns the row."""
    readings: Annotated[tuple[Figures, ...], Field(max_length=_MOST)]


class LeastSquaresReading(BaseModel):
    """One reading of "least squares", over all rows where it can be computed."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    reading: Words
    rows: tuple[Words, ...]
    decades: Amount
    """Mean over these rows of |log10| of our mean signed error over the paper's, magnitudes: 0 agrees."""
    nearest: bool
    """True for the reading that comes nearest to the paper."""


class ShownPicture(BaseModel):
    """A rendered picture for the page."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    scene: Words
    caption: Words
    file: Words
    """Relative to the folder of the results."""


class Reproduction(PublicObject, BaseModel):
    """Every row that was asked for, and under which restrictions."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    rows: Annotated[tuple[RowResult, ...], Field(max_length=_MOST)]
    not_reported: Annotated[tuple[Words, ...], Field(max_length=_MOST)]
    least_squares: Annotated[tuple[LeastSquaresReading, ...], Field(max_length=_MOST)] = ()
    """Readings of "least squares", which the paper does not define; empty without such rows."""
    claims: Annotated[tuple[ClaimResult, ...], Field(max_length=_MOST)] = ()
    claims_plan_sha256: Words | None = None
    """Of the plan that the claims were tested by; null where none was."""
    study: Annotated[tuple[StudyCell, ...], Field(max_length=_MOST)] = ()
    """Networks of other numbers of neurons and layers; empty where the study was not asked for."""
    explanations: Explanations | None = None
    """Mistakes that would give what rows 17 to 23 print; null where not asked for."""
    quick: bool
    restrictions: Annotated[tuple[Words, ...], Field(max_length=_MOST)]
    """Description of what ``--quick`` left out; empty for a full run."""
    pictures: Annotated[tuple[ShownPicture, ...], Field(max_length=_MOST)]

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line for each row of the paper, and the columns of the JSON document.

        Readings of a row and the contradiction in the paper are left out.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        columns = [name for name in RowResult.model_fields if name not in {"readings", "contradiction"}]
        frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(
            [row.model_dump(include=set(columns)) for row in self.rows], columns=columns
        )
        return frame

    def _summary(self) -> Mapping[str, object]:
        return {"rows": len(self.rows), "not_reported": len(self.not_reported), "quick": self.quick}

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [[row.exp, row.solver, f"{row.rmse_mm:.4g}", row.verdict] for row in self.rows]
        return [HtmlTable(("row", "method", "RMS error (mm)", "verdict"), rows)]


def read_reproduction(folder: AnyPath) -> Reproduction:
    """Read ``results.json`` in a folder that ``labcal reproduce`` made.

    Raises
    ------
    InputError
        There is none, or it is not one that this version reads.
    """
    folder = as_path(folder)
    path = folder / RESULTS
    if not path.is_file():
        makers = "'labcal reproduce' or 'labcal bench distortion'"
        raise InputError(
            f"{folder} holds no results: it has no {RESULTS}. Give the folder that {makers} made."
        )
    return read_document(Reproduction, "document of results", path)
