"""Pictures of a catalogue's print, with a code or without."""

import cv2
import numpy as np
from photographs import photograph

from labcal.targets.artwork import ArtworkFormat, draw_artwork
from labcal.targets.catalogue import load_target

SIZE = (1280, 960)
"""Width and height of the pictures, px."""


def photographed(name: str, copy: int | None) -> np.ndarray:
    """Return a picture of the print of a target; with the code of a copy, or without a code."""
    drawn = draw_artwork(load_target(name), ArtworkFormat.PNG, dpi=203, copy=copy)
    picture = cv2.imdecode(np.frombuffer(drawn.content, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert picture is not None
    return np.asarray(photograph(picture, SIZE, fill=0.8, tilt_deg=20.0, axis_deg=10.0))
