"""The noise at edges of photographs that are renderings themselves, by their finitely many rays.

A camera has no such noise; a shoot of the rendered laboratory has it where a pixel shows an edge, and says in
``run.json`` how many rays a pixel had.
"""

import json
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from labcal.guide.twin.dot_windows import blurred
from labcal.render.paper_share import PaperShare
from labcal.run.made import PROVENANCE

_MOST = 65536


def rays_of_shoot(folder: Path) -> int | None:
    """Return the rays a pixel of a rendered shoot; None where it does not say, or was not rendered."""
    path = folder / PROVENANCE
    if not path.is_file():
        return None
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    spp = record.get("spp") if isinstance(record, dict) else None
    return spp if isinstance(spp, int) and 1 <= spp <= _MOST else None


def ray_variance(made: PaperShare, blur_px: float) -> Float32[np.ndarray, "h w"]:
    """Return the variance of the blurred share by the rays of the photograph; zeros where it was taken.

    Parameters
    ----------
    made : PaperShare
        With a rough share of as many rays as the photograph had.
    blur_px : float

    Notes
    -----
    Rays are independent from pixel to pixel, so that the variance behind a blur is a constant times the edges
    behind the square of the blur's weights; the rough share tells the constant.
    """
    if not made.rough:
        return np.zeros_like(made.share)
    off = blurred(made.rough[0], blur_px) - blurred(made.share, blur_px)
    partly = made.edges & (made.share > 0.0) & (made.share < 1.0)
    near = blurred(partly.astype(np.float32), max(blur_px / np.sqrt(2.0), 0.1))
    total = float(near.sum())
    level = float((off.astype(np.float64) ** 2).sum()) / total if total > 0.0 else 0.0
    return np.asarray(near * np.float32(level))
