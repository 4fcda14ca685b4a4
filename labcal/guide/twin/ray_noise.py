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
from labcal.render.paper_share import PaperShare, SharpShare
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
    In a cell of paper rays choose lamps evenly. Of a share s they are as good as drawn at random without
    putting back: the variance is s (1 - s) times that at random.
    """
    if variance <= 0.0:
        return made
    return replace(made, rough=tuple(_lit(one, made.share, variance, random) for one in made.rough))


def _lit(rough: SharpShare, share: SharpShare, variance: float, random: np.random.Generator) -> SharpShare:
    """Return a rough share with the noise of lamps in its cells."""
    of_a_cell = np.float32(variance * rough.cells.finer**2)
    sigma = np.sqrt(of_a_cell * _partly(share, rough.cells.finer))
    light = rough.cells.light + sigma * random.standard_normal(sigma.shape, dtype=np.float32)
    return SharpShare.of(rough.pixels, rough.at, replace(rough.cells, light=light))


def ray_variance(made: PaperShare, blur_px: float) -> Float32[np.ndarray, "h w"]:
    """Return the variance of the blurred share by the rays of the photograph; zeros where it was taken.

    Parameters
    ----------
    made : PaperShare
        With a rough share of as many rays as the photograph had.
    blur_px : float

    Notes
    -----
    Rays are independent from cell to cell, so that the variance behind a blur is a constant times the cells
    at edges behind the square of the blur's weights; the rough share tells the constant.
    """
    if not made.rough:
        return np.zeros_like(made.share.pixels)
    rough = made.rough[0]
    off = rough.behind(blur_px) - made.share.behind(blur_px)
    partly = _partly(made.share, rough.cells.finer) > 0.0
    near = rough.variance_behind(partly.astype(np.float32), blur_px)
    total = float(near.sum())
    level = float((off.astype(np.float64) ** 2).sum()) / total if total > 0.0 else 0.0
    return np.asarray(near * np.float32(level))


def _partly(share: SharpShare, finer: int) -> Float32[np.ndarray, "n k k"]:
    """Return s (1 - s) of the shares s in cells; 0 where no ray tells the share."""
    of_cells = share.of_cells(finer)
    return np.asarray(np.nan_to_num(of_cells * (np.float32(1.0) - of_cells)))
