"""Colours in the variant of Mitsuba: red, green and blue, or one grey value."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from labcal.scene.lighting import REC709


@dataclass(frozen=True)
class Paint:
    """A converter from colours of a scene to Mitsuba's."""

    colour: bool
    """True if the variant has three channels; otherwise each colour is its luminance."""

    def channels(self, colour: tuple[float, float, float]) -> tuple[float, ...]:
        """Return a colour's value in every channel of the variant."""
        return colour if self.colour else (float(REC709 @ np.array(colour)),)

    def spectrum(self, colour: tuple[float, float, float], times: float = 1.0) -> dict[str, Any]:
        """Return Mitsuba's dictionary of a colour times a number."""
        values = tuple(times * value for value in self.channels(colour))
        return {"type": "rgb", "value": list(values if self.colour else 3 * values)}

    def matt(self, colour: tuple[float, float, float]) -> dict[str, Any]:
        """Return a diffuse surface of a colour."""
        return {"type": "diffuse", "reflectance": self.spectrum(colour)}
