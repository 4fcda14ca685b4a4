"""What a camera's sensor makes of light, in the terms of EMVA 1288, as a scene describes it."""

from enum import StrEnum
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class PictureFormat(StrEnum):
    """How pictures are delivered; the ending of their files."""

    PNG = "png"
    JPEG = "jpg"
    EXR = "exr"
    """Linear light on the sensor before any noise, float32; 1.0 is the full scale of the sensor."""


class ToneCurve(StrEnum):
    """From linear light to the delivered 8 bits."""

    LINEAR = "linear"
    SRGB = "srgb"
    """IEC 61966-2-1."""


class Photometry(BaseModel):
    """A sensor and what its camera does with the reading."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    bayer: bool = False
    """Colour through a mosaic of red, green and blue (rows RG, GB); else grey."""
    blur_px: Annotated[float, Field(ge=0, le=20)] = 0.6
    """Standard deviation of the point spread of lens and low-pass filter (a Gauss function)."""
    full_well_e: Positive = 20000.0
    """Electrons of a pixel at full scale."""
    read_noise_e: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 6.0
    """Standard deviation of the reading in the dark, electrons."""
    adc_bits: Annotated[int, Field(ge=8, le=16)] = 12
    white: Annotated[float, Field(gt=0, le=0.95)] = 0.75
    """Share of the full scale that the brightest part of a bare board reaches in any view."""
    tone_curve: ToneCurve = ToneCurve.SRGB
    format: PictureFormat = PictureFormat.JPEG
    jpeg_quality: Annotated[int, Field(ge=1, le=100)] = 95
