"""The photometry of a camera in a scene: its sensor, in the terms of EMVA 1288, and its development."""

from enum import StrEnum
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.bounds import Amount, Quantity
from labcal.scene.sensor_presets import expanded
from labcal.shoot.tone_curve import ToneCurve


class PictureFormat(StrEnum):
    """The format of picture files, and their ending."""

    PNG = "png"
    JPEG = "jpg"
    TIFF = "tif"
    EXR = "exr"
    """Linear light on the sensor before any noise, float32; 1.0 is the full scale of the sensor."""


class Stage(StrEnum):
    """The stage of development that the camera delivers."""

    PICTURE = "picture"
    """Developed: black level, white balance, colour, tone curve."""
    RAW = "raw"
    """The converter's codes as they are, the mosaic undeveloped, in 16 bits a pixel."""


class Photometry(BaseModel):
    """A sensor, and the development of its readings.

    In a file the name of a preset may stand for it (``photometry: phone``), or a preset and what differs
    from it (``photometry: {preset: phone, jpeg_quality: 80}``). What is left out is a sensor with photon and
    read noise and no other defect.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    bayer: bool = False
    """Colour through a mosaic of red, green and blue (rows RG, GB); else grey."""
    fall_off: bool = False
    """The lens's natural fall-off: light goes with the fourth power of the cosine of the ray's angle."""
    vignetting: Annotated[float, Field(ge=0, lt=1)] = 0.0
    """Share of the light lost at the picture's corner besides; it grows with the radius squared."""
    blur_px: Annotated[float, Field(ge=0, le=20)] = 0.6
    """Standard deviation of the point spread of lens and low-pass filter (a Gauss function)."""
    exposure_ms: Quantity = 10.0
    """Exposure time. Lamps and aperture are thought to be such that it is the right one: see `white`."""
    exposure_stops: Annotated[float, Field(ge=-10, le=10)] = 0.0
    """Over-exposure in factors of two, from the exposure at which the board reaches `white`."""
    full_well_e: Quantity = 20000.0
    """Electrons that a pixel holds."""
    prnu: Annotated[float, Field(ge=0, le=0.2)] = 0.0
    """Photo response non-uniformity: standard deviation of the pixels' sensitivity, share of its mean."""
    dark_current_e_per_s: Amount = 0.0
    """Electrons that a pixel gathers without light, a second."""
    dsnu_e: Amount = 0.0
    """Dark signal non-uniformity: standard deviation of the pixels' fixed offsets, electrons."""
    read_noise_e: Amount = 6.0
    """Temporal dark noise without dark current: standard deviation of the reading, electrons."""
    gain_dn_per_e: Quantity | None = None
    """System gain, codes per electron; where left out, a full well reads as the highest code."""
    black_level_dn: Amount = 0.0
    """Code at which no electrons read."""
    adc_bits: Annotated[int, Field(ge=8, le=16)] = 12
    """Bits of the analogue-to-digital converter."""
    white: Annotated[float, Field(gt=0, le=0.95)] = 0.75
    """Share of the saturation that the brightest part of a bare board reaches in any view."""
    tone_curve: ToneCurve = ToneCurve.SRGB
    """Curve from light to the values of the picture; `linear` is none."""
    stage: Stage = Stage.PICTURE
    """Delivered data: a developed picture, or the converter's raw codes."""
    bits: Literal[8, 16] = 8
    """Bits of a delivered value; a raw picture always has 16."""
    format: PictureFormat = PictureFormat.JPEG
    """Format of the picture file."""
    jpeg_quality: Annotated[int, Field(ge=1, le=100)] = 95
    """Quality of JPEG files, 1 to 100."""

    @model_validator(mode="before")
    @classmethod
    def _preset_written_out(cls, value: object) -> object:
        return expanded(value)

    @model_validator(mode="after")
    def _possible(self) -> "Photometry":
        if self.black_level_dn >= self.highest_code:
            raise ValueError(
                f"black_level_dn should be below the highest code of {self.adc_bits} bits, "
                f"{self.highest_code}, but is {self.black_level_dn:g}"
            )
        if self.bits == 16 and self.format is PictureFormat.JPEG:  # noqa: PLR2004 -- bits
            raise ValueError("JPEG holds 8 bits, so bits: 16 needs the format png or tif")
        if self.stage is Stage.RAW and self.format in {PictureFormat.JPEG, PictureFormat.EXR}:
            raise ValueError(
                f"stage: raw holds the converter's codes, which need the format png or tif, not {self.format}"
            )
        return self

    @property
    def highest_code(self) -> int:
        """Highest code of the converter, DN."""
        return int(2**self.adc_bits - 1)

    @property
    def gain(self) -> float:
        """System gain K of EMVA 1288, DN per electron."""
        if self.gain_dn_per_e is not None:
            return self.gain_dn_per_e
        return (self.highest_code - self.black_level_dn) / self.full_well_e

    @property
    def saturation_e(self) -> float:
        """Saturation capacity of EMVA 1288: electrons at which the well is full or the codes end."""
        return min(self.full_well_e, (self.highest_code - self.black_level_dn) / self.gain)

    @property
    def dark_e(self) -> float:
        """Mean dark charge of one exposure, electrons."""
        return self.dark_current_e_per_s * 1e-3 * self.exposure_ms
