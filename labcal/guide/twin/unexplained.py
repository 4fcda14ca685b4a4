"""Residuals of a shoot that simulation does not explain, in words and by rank."""

from collections.abc import Sequence

import numpy as np

from labcal.guide.twin.again import BLUR
from labcal.guide.twin.causes import Explained
from labcal.guide.twin.dot_windows import CAUSES
from labcal.guide.twin.picture import TwinPicture
from labcal.guide.twin.residuals import DotResiduals
from labcal.guide.twin.unexplained_positions import Unexplained, unexplained_positions
from labcal.guide.twin.verdicts import BLUR_SHARE, LOUD, PictureVerdict, is_unusual, usual_blur
from labcal.shoot.pictures import is_lossy
from labcal.wording import listed

_SHOWN = 4


def unexplained(
    pictures: Sequence[TwinPicture],
    verdicts: Sequence[PictureVerdict],
    explanation: Explained,
    found: DotResiduals,
) -> tuple[Unexplained, ...]:
    """Return what simulation does not explain: what moves dots first, then what does not.

    Parameters
    ----------
    pictures : sequence of TwinPicture
    verdicts : sequence of PictureVerdict
    explanation : Explained
    found : DotResiduals
    """
    names = [f"{made.view}/{made.camera}" for made in pictures]
    far = [name for name, one in zip(names, verdicts, strict=True) if one.level > explanation.level]
    moving = unexplained_positions(explanation, found, names, tuple(far[:_SHOWN]))
    return (*moving, *_blurs(pictures, names), *_pixels(pictures, names))


def _blurs(pictures: Sequence[TwinPicture], names: list[str]) -> list[Unexplained]:
    """Return what edge widths show."""
    usual = usual_blur(pictures)
    off = [
        (name, made)
        for name, made in zip(names, pictures, strict=True)
        if is_unusual(made, usual[made.camera])
    ]
    found = []
    if off:
        most = max(abs(made.blur_px - usual[made.camera]) for _, made in off)
        which = tuple(name for name, _ in off)
        found.append(Unexplained(
            "blur",
            f"the edge width of {listed(which[:_SHOWN])}, up to {most:.2g} px from the usual of the camera: "
            "out of focus, or moved during the exposure",
            None, most, "px", which,
        ))  # fmt: skip
    spread = [(_blur_spread(made), name) for name, made in zip(names, pictures, strict=True)]
    wide = [(size, name) for size, name in spread if size > 0.0]
    if len(wide) > len(pictures) // 2:
        size = float(np.median([one for one, _ in wide]))
        found.append(Unexplained(
            "blur-over-picture",
            f"edge widths that differ from dot to dot by {size:.2g} px: depth of focus, or a lens that is "
            "not equally sharp everywhere",
            None, size, "px",
        ))  # fmt: skip
    return found


def _blur_spread(made: TwinPicture) -> float:
    """Return by how much edge widths differ from dot to dot beyond noise, px; 0 where that is little."""
    value, sigma = made.windows.parameters[:, BLUR], made.windows.sigma[:, BLUR]
    known = np.isfinite(value) & np.isfinite(sigma)
    if known.sum() < 8:  # noqa: PLR2004 -- a spread needs some
        return 0.0
    level = max(1.0, made.pixels.flat_variance)
    spread = 1.4826 * float(np.median(np.abs(value[known] - np.median(value[known]))))
    noise = float(np.median(sigma[known])) * np.sqrt(level)
    beyond = np.sqrt(max(0.0, spread**2 - noise**2))
    return float(beyond) if spread > 2.0 * noise and beyond > BLUR_SHARE * made.blur_px else 0.0


def _pixels(pictures: Sequence[TwinPicture], names: list[str]) -> list[Unexplained]:
    """Return what differences of pixels show."""
    found = []
    flat = np.array([made.pixels.flat_variance for made in pictures])
    edge = np.array([made.pixels.edge_variance for made in pictures])
    loud = edge > np.maximum(LOUD, LOUD * flat)
    if loud.any():
        removed = sum(made.windows.removed.sum(axis=0) for made in pictures)
        squares = sum(float(made.windows.squares.sum()) for made in pictures)
        parts = dict(zip(CAUSES, np.asarray(removed) / squares, strict=True))
        shares = [f"{name} {100.0 * share:.0f}%" for name, share in parts.items() if share > 0.01]  # noqa: PLR2004
        rest = 1.0 - sum(parts.values())
        size = float(np.sqrt(np.median(edge[loud])))
        found.append(Unexplained(
            "edges",
            f"the edges of dots, {size:.2g} times the noise (of the squares around dots: "
            f"{', '.join(shares)}{', ' if shares else ''}{100.0 * rest:.0f}% ragged ink, paper and noise)"
            f"{_compressed(pictures, loud)}",
            None, size, "times the noise", _some(names, loud),
        ))  # fmt: skip
    loud = flat > LOUD
    if loud.any():
        size = float(np.sqrt(np.median(flat[loud])))
        found.append(Unexplained(
            "paper",
            f"the brightness of paper and ink, {size:.2g} times the noise of neighbouring pixels: texture "
            "of the paper, dust, or light that is less smooth than thought",
            None, size, "times the noise", _some(names, loud),
        ))  # fmt: skip
    return found


def _compressed(pictures: Sequence[TwinPicture], which: np.ndarray) -> str:
    """Return a remark where the compression of some of the pictures is not simulated."""
    shown = [one for one, is_shown in zip(pictures, which, strict=True) if is_shown]
    lossy = sum(is_lossy(one.image) and not one.is_compressed for one in shown)
    if not lossy:
        return ""
    return (
        f"; {'they' if lossy == len(shown) else f'{lossy} of them'} are compressed with loss in a way "
        "that is not simulated: it adds to these differences"
    )


def _some(names: list[str], which: np.ndarray) -> tuple[str, ...]:
    """Return the names of some pictures; none where all show it."""
    return () if which.all() else tuple(name for name, one in zip(names, which, strict=True) if one)
