"""The log of checks of a rig: one JSON document a line, in the order of the checks."""

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from labcal.calibrate.validity.change import Element
from labcal.errors import InputError
from labcal.guide.rig_check import CheckVerdict, RigCheck
from labcal.paths import AnyPath, as_path
from labcal.run.file_kinds import beginning_with
from labcal.run.file_reading import MOST_OF_A_TABLE, read_text
from labcal.run.json_reading import read_json
from labcal.run.outputs import write_file
from labcal.wording import has_control, shown

KIND = beginning_with("a log of checks", b'{"format":"labcal-check"')
MOST_LETTERS = 500
"""Of a note."""
Text = Annotated[str, Field(max_length=MOST_LETTERS)]
Figure = Annotated[float, Field(ge=-1e12, le=1e12, allow_inf_nan=False)]
Temperature = Annotated[float, Field(ge=-273.15, le=1e4, allow_inf_nan=False)]


class CheckRecord(BaseModel):
    """One check of a rig, a line of the log; what does not apply is null."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-check"] = "labcal-check"
    """Kind of the line."""
    date: Text
    """Of the check, ISO 8601."""
    rig: Text
    """Name of the file of the rig; empty where none was read."""
    verdict: CheckVerdict
    p_value: Annotated[float, Field(ge=0, le=1)]
    camera: Text | None
    """The camera that changed; null if none did, or it cannot be determined which."""
    kind: Text | None
    """Kind of the most likely change; null if there is none."""
    turn_deg: Figure | None
    """Its size, of the camera that turned most."""
    shift_mm: Figure | None
    focus_percent: Figure | None
    cost_rms_mm: Figure | None
    """RMS error of points over the volume by the change."""
    budget_mm: Figure | None
    """RMS standard deviation of points there by noise and calibration."""
    views: Annotated[int, Field(ge=1)]
    sigma0: Figure
    temperature_c: Temperature | None = None
    note: Text = ""

    @field_validator("date")
    @classmethod
    def _is_a_date(cls, value: str) -> str:
        datetime.fromisoformat(value)
        return value

    @field_validator("rig", "camera", "kind", "note")
    @classmethod
    def _can_be_shown(cls, value: str | None) -> str | None:
        if value is not None and has_control(value):
            raise ValueError("the text holds control characters")
        return value

    @classmethod
    def of(
        cls, check: RigCheck, date: str, rig: str, temperature_c: float | None, note: str
    ) -> "CheckRecord":
        """Return the record of a check.

        Parameters
        ----------
        check : RigCheck
        date : str
            ISO 8601.
        rig : str
            Name of the file.
        temperature_c : float or None
            Degrees Celsius.
        note : str
        """
        found = check.changes[0] if check.verdict is CheckVerdict.CHANGED else None
        sizes: dict[str, float | None] = dict.fromkeys((one.value for one in Element), None)
        for one in () if found is None else found.amounts:
            largest = sizes[one.element]
            sizes[one.element] = one.size if largest is None or abs(one.size) > abs(largest) else largest
        return cls(
            date=date,
            rig=rig,
            verdict=check.verdict,
            p_value=check.p_value,
            camera=check.camera,
            kind=None if found is None else found.kind.value,
            turn_deg=sizes[Element.TURN.value],
            shift_mm=sizes[Element.SHIFT.value],
            focus_percent=sizes[Element.FOCUS.value],
            cost_rms_mm=None if check.cost is None else check.cost.rms_mm,
            budget_mm=check.budget_mm,
            views=len(check.views),
            sigma0=check.sigma0,
            temperature_c=temperature_c,
            note=note,
        )


def read_check_log(path: AnyPath) -> tuple[CheckRecord, ...]:
    """Read a log of checks.

    Parameters
    ----------
    path : str or os.PathLike

    Raises
    ------
    InputError
        The file cannot be read, or a line is no record of a check.
    """
    file = as_path(path)
    lines = read_text(file, "log of checks", MOST_OF_A_TABLE).splitlines()
    return tuple(
        read_json(CheckRecord, line, f"{path}, line {number}") for number, line in enumerate(lines, start=1)
    )


def write_check_log(path: Path, records: Sequence[CheckRecord]) -> None:
    """Write a log, in the place of the one that it continues.

    Raises
    ------
    OutputError
        There is another file, or it cannot be written.
    """
    text = "".join(f"{record.model_dump_json()}\n" for record in records)
    write_file(path, text, kind=KIND, force=True)


def checked_date(given: str) -> str:
    """Return a date as the log has it.

    Raises
    ------
    InputError
        It is no date.
    """
    try:
        return datetime.fromisoformat(given).isoformat()
    except ValueError as error:
        raise InputError(
            f"`date` is a date as in 2026-05-04 or 2026-05-04T09:30:00+00:00, but {shown(given)} was given."
        ) from error
