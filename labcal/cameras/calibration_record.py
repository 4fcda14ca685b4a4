"""Agreement of cameras when they were calibrated, as ``rig.json`` and model files keep it."""

from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_serializer

from labcal.cameras.support import CalibrationSupport

Pixel = Annotated[float, Field(ge=0, allow_inf_nan=False)]
"""A length in px."""


class CalibrationRecord(BaseModel):
    """Agreement of cameras when they were calibrated; what is not known is left out of files."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    triangulation_rms_px: Pixel | None = None
    """RMS triangulation residual of the dots that they were calibrated from."""
    scatter_px: Pixel | None = None
    """Variance component beyond the dots' covariances, as a standard deviation of pixels along each axis."""
    systematic_px: Pixel | None = None
    """RMS of what shifts, rotations and changes of scale of whole pictures explain of these residuals."""
    inconsistent: tuple[str, ...] = ()
    """Causes of contradictions between the views, the likeliest first; empty if there are none."""
    dot_places: Literal["freed"] | None = None
    """``freed`` where places of dots were estimated with the cameras; left out where they are as declared."""
    support: CalibrationSupport | None = None
    """Hulls of the dots that they were calibrated from; left out of files if not known."""

    @model_serializer(mode="wrap")
    def _without_what_is_not_known(self, dump: Callable[[BaseModel], dict[str, object]]) -> dict[str, object]:
        """Leave out what older files do not have, so that they keep their bytes."""
        newer = ("systematic_px", "dot_places", "support")
        return {key: value for key, value in dump(self).items() if key not in newer or value is not None}
