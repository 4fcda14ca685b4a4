"""Colours as the variant in use takes them: red, green and blue, or one grey."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from labcal.scene.lighting import REC709


@dataclass(frozen=True)
class Paint:
    """What turns a scene's colours into Mitsuba's."""

    colour: bool
    """Whether the variant has three channels; else each colour becomes its luminance."""

    def channels(self, colour: tuple[float, float, float]) -> tuple[float, ...]:
        """Return a colour's value in every channel of the variant."""
        return colour if self.colour else (float(REC709 @ np.array(colour)),)

    def spectrum(self, colour: tuple[float, float, float], times: float = 1.0) -> dict[str, Any]:
        """Return Mitsuba's dictionary of a colour times a number."""
        values = tuple(times * value for value in self.channels(colour))
        return {"type": "rgb", "value": list(values if self.colour else 3 * values)}

    def matt(self, colour: tuple[float, float, float]) -> dict[str, Any]:
        """Return a surface that reflects a colour evenly in all directions."""
        return {"type": "diffuse", "reflectance": self.spectrum(colour)}
