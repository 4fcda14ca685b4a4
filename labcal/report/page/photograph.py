"""A picture in a page, with what was found in it drawn on top."""

import base64
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64
from markupsafe import Markup

from labcal.arrays import Pixels
from labcal.errors import InputError
from labcal.geometry.magnification import round_magnification
from labcal.paths import AnyPath
from labcal.report.page.part import Part
from labcal.report.page.templates import rendered
from labcal.report.thumbnail import thumbnail
from labcal.shoot.picture_to_show import read_picture_to_show

_WIDTH = 900
_JPEG_QUALITY = 80
_LONG = 0.05
"""Of the picture's width: the arrow of a large residual."""
_LARGE = 90.0


@dataclass(frozen=True)
class Photograph(Part):
    """A picture with its dots, and their residuals as arrows.

    Attributes
    ----------
    name : str
        Its id in the page.
    path : path
        Where the picture is; one that cannot be read is said to be missing.
    q : float64 array, (n, 2)
        Dots, px.
    residual : float64 array, (n, 2)
        Of each, px; NaN where there is none.
    title : str
        Which picture it is.
    size : (int, int), optional
        Width and height, px; needed of files without a header.
    """

    name: str
    path: AnyPath
    q: Pixels
    residual: Float64[np.ndarray, "n 2"]
    title: str
    size: tuple[int, int] | None = None

    def html(self) -> Markup:
        """Return the picture as a JPEG inside an SVG, or why it is not here."""
        try:
            picture = read_picture_to_show(self.path, self.size)
        except InputError as error:
            missing = {"photograph": self, "svg": None, "absent": str(error), "caption": self.title}
            return rendered("photograph.html.jinja", missing)
        height, width = picture.shape[:2]
        times = self._magnification(width)
        small = thumbnail(picture, _WIDTH, _WIDTH)
        _, data = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
        values: dict[str, object] = {
            "photograph": self,
            "caption": self._caption(times),
            "picture": base64.b64encode(data.tobytes()).decode(),
            "size": (width, height),
            "stroke": f"{width / 500:.2f}",
            "radius": f"{width / 220:.2f}",
            "dots": np.round(self.q, 1).tolist(),
            "arrows": _path(self.q, times * self.residual),
        }
        svg = rendered("photograph.svg.jinja", values)
        return rendered("photograph.html.jinja", {**values, "svg": svg, "absent": ""})

    def _magnification(self, width: int) -> float:
        length = np.linalg.norm(self.residual, axis=1)
        length = length[np.isfinite(length)]
        large = float(np.percentile(length, _LARGE)) if len(length) else 0.0
        return round_magnification(_LONG * width / max(large, 1e-9))

    def _caption(self, times: float) -> str:
        if not np.isfinite(self.residual).any():
            return f"{self.title}: {len(self.q)} dots."
        rms = float(np.sqrt(np.nanmean((self.residual**2).sum(axis=1))))
        drawn = f"drawn {times:g} times as long"
        return f"{self.title}: {len(self.q)} dots; residuals of {rms:.3f} px (RMS), {drawn}."


def _path(q: np.ndarray, arrow: np.ndarray) -> str:
    """Return lines from dots as the data of an SVG path."""
    lines = np.concatenate([q, arrow], axis=1)
    lines = lines[np.isfinite(lines).all(axis=1)]
    return "".join(f"M{x:.1f} {y:.1f}l{u:.1f} {v:.1f}" for x, y, u, v in lines.tolist())
