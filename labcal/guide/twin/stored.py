"""Values of a picture and the light that they stand for."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from labcal.guide.twin.jpeg_coding import JpegCoding
from labcal.shoot.tone_curve import ToneCurve, tone, undone
from labcal.shoot.tone_curve import light as light_of


@dataclass(frozen=True)
class StoredValues:
    """The storage of light in a picture.

    Attributes
    ----------
    kind : str
        ``uint8``, ``uint16``, or ``float32`` for linear light.
    curve : ToneCurve
    coding : JpegCoding or None
        Compression with loss; None for none.
    """

    kind: str
    curve: ToneCurve
    coding: JpegCoding | None = None

    @classmethod
    def of(cls, picture: np.ndarray, curve: ToneCurve, coding: JpegCoding | None = None) -> "StoredValues":
        """Return that of a picture under a tone curve; what is no whole number is light already."""
        if picture.dtype in (np.uint8, np.uint16):
            channels = int(np.prod(picture.shape[2:]))  # 1 of a grey picture
            fits = coding is not None and picture.dtype == np.uint8 and coding.channels == channels
            return cls(str(picture.dtype), curve, coding if fits else None)
        return cls("float32", ToneCurve.LINEAR)

    @property
    def top(self) -> float:
        """The largest value."""
        return 1.0 if self.kind == "float32" else float(np.iinfo(self.kind).max)

    def channels(self, picture: np.ndarray) -> list[Float32[np.ndarray, "h w"]]:
        """Return the light of each channel of a picture, from 0 to the largest value."""
        light = undone(picture, self.curve).astype(np.float32)
        return [light] if light.ndim == 2 else [light[..., k] for k in range(light.shape[2])]  # noqa: PLR2004

    def values(self, light: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        """Return light as values before they are rounded."""
        share = np.clip(light / np.float32(self.top), 0.0, 1.0)
        return np.asarray((self.top * tone(share, self.curve)).astype(np.float32))

    def picture(self, channels: list[Float32[np.ndarray, "h w"]]) -> np.ndarray:
        """Return a picture of light, as it is read from its file; linear light in 16 bits."""
        kind = "uint16" if self.kind == "float32" else self.kind
        times = np.iinfo(kind).max / self.top
        stored = [np.rint(times * self.values(light)).astype(kind) for light in channels]
        picture = stored[0] if len(stored) == 1 else np.stack(stored, axis=-1)
        return picture if self.coding is None else self.coding.coded(picture)

    def sampled(self, channels: list[Float32[np.ndarray, "h w"]]) -> list[Float32[np.ndarray, "h w"]]:
        """Return light of which compression stored colours at fewer pixels; the same where it did not."""
        if self.coding is None or self.coding.sampling == 0:
            return channels
        values = self.coding.sampled(np.stack([self.values(light) for light in channels], axis=-1))
        shone = self.top * light_of(np.clip(values / np.float32(self.top), 0.0, 1.0), self.curve)
        return list(np.moveaxis(shone, -1, 0).astype(np.float32))

    def step_variance(self, light: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        """Return the variance of light by the rounding of its value."""
        if self.kind == "float32":
            return np.zeros_like(light)
        return np.asarray(self.light_of_step(light) ** 2 / np.float32(12.0))

    def light_of_step(self, light: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        """Return by how much light differs between a value and the next one."""
        every = np.arange(int(self.top) + 1, dtype=self.kind)
        slope = np.gradient(undone(every, self.curve).astype(np.float64))
        at = np.rint(self.values(light)).astype(np.int64)
        return np.asarray(slope[at].astype(np.float32))
