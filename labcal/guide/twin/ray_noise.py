"""The noise at edges of photographs that are renderings themselves, by their finitely many rays.

A camera has no such noise; a shoot of the rendered laboratory has it where a pixel shows an edge, and says in
``run.json`` how many rays a pixel had. Each ray that meets paper chooses one lamp, so that lamps add to it;
the scene beside the truth of the shoot says which there are.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from labcal.errors import LabcalError
from labcal.guide.twin.dot_windows import blurred
from labcal.render.paper_share import PaperShare
from labcal.run.made import PROVENANCE
from labcal.scene.lamp_choice import lamp_choice_variance
from labcal.scene.model import Scene
from labcal.shoot.truth import has_truth, read_truth

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


def lamp_variances(scene: Scene, folder: Path) -> dict[str, float]:
    """Return the variance of the light of a ray by the choice of lamps, by view; none where nothing tells it.

    Parameters
    ----------
    scene : Scene
    folder : Path
        Of a shoot that was rendered of it.
    """
    if not has_truth(folder):
        return {}
    try:
        views = read_truth(folder).views
    except LabcalError:
        return {}
    return {name: lamp_choice_variance(scene, np.array(view.T_world_target)) for name, view in views.items()}


def with_lamps(made: PaperShare, variance: float, random: np.random.Generator) -> PaperShare:
    """Return a share whose rough ones have the noise of lamps, too.

    Parameters
    ----------
    made : PaperShare
    variance : float
        Of the light of a pixel, by the choice of lamps, over the square of its mean, if rays chose at random.
    random : numpy.random.Generator

    Notes
    -----
    In a pixel of paper rays choose lamps evenly. Of a share s they are as good as drawn at random without
    putting back: the variance is s (1 - s) times that at random.
    """
    if variance <= 0.0:
        return made
    sigma = np.sqrt(np.float32(variance) * made.share * (np.float32(1.0) - made.share))
    noisy = [one + sigma * random.standard_normal(one.shape, dtype=np.float32) for one in made.rough]
    return replace(made, rough=tuple(noisy))


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
