"""The study of neurons and layers, as ``results.json`` holds it."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from labcal.bounds import Amount
from labcal.report.values import Measured, Words

_Count = Annotated[int, Field(ge=0, le=10**9)]


class StudyCell(BaseModel):
    """One network on one kind of data; medians over the seeds, on points that were not trained on."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    exp: Words
    """The row of the paper whose points, noise and goal these are."""
    data: Words
    points: _Count
    goal: Amount
    layers: _Count
    """Hidden ones."""
    neurons: _Count
    """Of all hidden layers together."""
    network: Words
    """Neurons of every hidden layer, and outputs: ``20-30-3``."""
    parameters: _Count
    seeds: _Count
    reached: _Count
    """Seeds that reached the goal."""
    rmse_mm: Measured
    """RMS length of the 3-D error."""
    rmse_range_mm: tuple[Measured, Measured]
    """Least and greatest of the seeds; the other ranges, too."""
    mean_signed_m: Measured
    mean_signed_range_m: tuple[Measured, Measured]
    epochs: Amount
    """Accepted training steps."""
    epochs_range: tuple[Amount, Amount]
    seconds: Amount
    """Of training."""
    seconds_range: tuple[Amount, Amount]
