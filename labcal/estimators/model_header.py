"""The JSON header of a model file, and the digest that shows damage."""

import hashlib
import json
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from labcal.bounds import MOST_PICTURES, Side
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig_covariance import RigCovariance
from labcal.errors import InputError
from labcal.estimators.stage_errors import StageErrors
from labcal.run.json_reading import json_content, read_json
from labcal.run.names import Name

OLDEST, VERSION = 4, 7
"""Of the files that are read, and of those that are written.

Before 5, waves of a field had no directions; before 6, a model did not tell the covariance of the cameras
that placed a target held in the hand; before 7, none of errors of a stage.
"""

_MOST_COLUMNS = 2000
Value = bool | int | float | str | tuple[int, ...] | tuple[tuple[int, int], ...] | None
"""A constructor argument or a fitted fact."""


class ModelHeader(BaseModel):
    """Everything in a model file but the arrays.

    Attributes
    ----------
    format, version
        What the file is.
    method : str
        The method's name.
    parameters : mapping
        The estimator's constructor arguments.
    facts : mapping
        Its fitted attributes that are a number or a text.
    inputs, outputs : int
        Columns of X and of Y.
    cameras : tuple of str
        Names in the order of the columns.
    image_sizes : tuple
        Width and height, px, of each camera.
    planar : bool
        Whether all points were trained at one Z; for readers other than this program.
    resected : tuple of CameraRecord, optional
        The cameras that the eccentricity is computed with; left out where there are none.
    rehearsed : mapping, optional
        The figures of a `ExpectedError`, null for NaN; left out where there are none.
    calibration : CalibrationRecord, optional
        How well the resected cameras agreed on the training data; left out where that is not known.
    covariance : RigCovariance, optional
        Joint covariance of the resected cameras where they placed the target; left out where a stage did.
    stage : StageErrors, optional
        Errors of the resected cameras by those of the stage; left out where they are not stated.
    calibrated_on : tuple of str, optional
        Names of the views that it was fitted to; left out where they are not known, as in older files.
    held_out : tuple of str, optional
        Names of the views that were kept to test on; left out where there were none.
    digest : str
        SHA-256 over this header, with an empty digest, and all arrays.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    format: Literal["labcal-model"]
    version: int
    method: str
    parameters: dict[str, Value]
    facts: dict[str, Value]
    inputs: Annotated[int, Field(ge=2, le=_MOST_COLUMNS)]
    outputs: Annotated[int, Field(ge=3, le=_MOST_COLUMNS)]
    cameras: tuple[Name, ...]
    image_sizes: tuple[tuple[Side, Side], ...]
    planar: bool
    digest: str
    resected: tuple[CameraRecord, ...] | None = None
    rehearsed: dict[str, Annotated[float, Field(ge=0)] | None] | None = None
    calibration: CalibrationRecord | None = None
    covariance: RigCovariance | None = None
    stage: StageErrors | None = None
    calibrated_on: Annotated[tuple[str, ...], Field(max_length=MOST_PICTURES)] | None = None
    held_out: Annotated[tuple[str, ...], Field(max_length=MOST_PICTURES)] | None = None

    def text(self) -> str:
        """Return the header as JSON, always the same for the same content."""
        return json.dumps(self.model_dump(exclude_none=True), sort_keys=True, allow_nan=False)

    def signed(self, arrays: dict[str, np.ndarray]) -> "ModelHeader":
        """Return the header with the digest of itself and these arrays."""
        blank = self.model_copy(update={"digest": ""})
        digest = hashlib.sha256(blank.text().encode())
        for name in sorted(arrays):
            array = arrays[name]
            digest.update(f"{name} {array.dtype.str} {array.shape}".encode())
            digest.update(np.ascontiguousarray(array).tobytes())
        return blank.model_copy(update={"digest": digest.hexdigest()})


def header_of(path: Path, text: str | None) -> ModelHeader:
    """Return the checked header of a file, its version before all else.

    Raises
    ------
    InputError
        There is none, it is of another version, or a value in it is not allowed.
    """
    if text is None:
        raise InputError(f"{path} is a safetensors file, but no model of labcal.")
    content = json_content(text, f"The header of the model {path}")
    version = content.get("version") if isinstance(content, dict) else None
    if isinstance(version, int) and version > VERSION:
        raise InputError(
            f"The model {path} is of version {version}, but this labcal reads up to {VERSION}. Install a "
            "newer labcal."
        )
    if isinstance(version, int) and version < OLDEST:
        raise InputError(
            f"The model {path} is of version {version}, which is not read any more. Fit it again."
        )
    return read_json(ModelHeader, text, f"The header of the model {path}")
