"""Two pictures on top of each other, one of which is drawn aside; and a third beside them."""

import base64
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Shaped
from markupsafe import Markup

from labcal.report.page.part import Part
from labcal.report.page.templates import rendered
from labcal.report.thumbnail import thumbnail

_WIDTH = 900
_JPEG_QUALITY = 80


@dataclass(frozen=True)
class Wiped(Part):
    """A photograph over its rendering, and their difference. No script: the browser's own handle wipes.

    Attributes
    ----------
    name : str
        Its id in the page.
    over, under, beside : ndarray
        Pictures of one size, as they are read.
    titles : (str, str, str)
        What they are.
    caption : str
    """

    name: str
    over: np.ndarray
    under: np.ndarray
    beside: np.ndarray
    titles: tuple[str, str, str]
    caption: str

    def html(self) -> Markup:
        """Return the pictures."""
        small = [thumbnail(one, _WIDTH, _WIDTH) for one in (self.over, self.under, self.beside)]
        height, width = small[0].shape[:2]
        return rendered(
            "wiped.html.jinja",
            {"wiped": self, "pictures": [_jpeg(one) for one in small], "width": width, "height": height},
        )


def _jpeg(picture: Shaped[np.ndarray, "h w 3"]) -> str:
    """Return a picture as base64 of a JPEG."""
    _, data = cv2.imencode(".jpg", picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    return base64.b64encode(data.tobytes()).decode()
