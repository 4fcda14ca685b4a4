"""Residuals of a shoot that simulation does not explain, in words and by rank."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.guide.twin.again import BLUR
from labcal.guide.twin.cause_designs import CauseKind
from labcal.guide.twin.causes import Cause, Explained
from labcal.guide.twin.dot_windows import CAUSES
from labcal.guide.twin.picture import TwinPicture
from labcal.guide.twin.residuals import DotResiduals
from labcal.wording import listed

_SIGMAS = 4.0
"""A figure of one picture is named where it is farther off than chance lets one in ten thousand be."""
_BLUR_SHARE = 0.15
"""Of the usual blur of a camera; less changes no measurement."""
_REST_SHARE = 0.1
_LOUD = 1.25
"""Mean squared difference of pixels, in units of the noise, from which on a picture is not at noise level."""
_SHOWN = 4
_SHORT = {
    CauseKind.PRINT: "the places of the dots on the print",
    CauseKind.BEND: "a bend of the board",
    CauseKind.LENS: "the lens",
    CauseKind.PICTURES: "single pictures",
}


@dataclass(frozen=True)
class PictureVerdict:
    """The verdict on one picture.

    Attributes
    ----------
    view, camera : str
    rms_px, noise_px : float
        RMS residual of dots, photograph minus rendering, and that of noise alone; 2-D.
    level : float
        Mean squared residual in units of noise; 1 is noise alone.
    findings : tuple of str
        What is not at noise level, for people; empty where all is.
    """

    view: str
    camera: str
    rms_px: float
    noise_px: float
    level: float
    findings: tuple[str, ...]


@dataclass(frozen=True)
class Unexplained:
    """Something that simulation does not explain.

    Attributes
    ----------
    kind : str
        ``print``, ``bend``, ``lens``, ``pictures``, ``positions`` (of no known pattern), ``blur``,
        ``blur-over-picture``, ``edges``, ``paper``, or ``undecided`` (one of several causes).
    words : str
    share : float or None
        Of the squares of residuals of dots; None of what does not move dots.
    size : float
    unit : str
    pictures : tuple of str
        That show it, where it is not all.
    """

    kind: str
    words: str
    share: float | None
    size: float
    unit: str
    pictures: tuple[str, ...] = ()


def picture_verdicts(
    pictures: Sequence[TwinPicture], found: DotResiduals, freedom_share: float
) -> tuple[PictureVerdict, ...]:
    """Return the verdict on every picture.

    Parameters
    ----------
    pictures : sequence of TwinPicture
    found : DotResiduals
    freedom_share : float
        Degrees of freedom of residuals over their number: the rest went into what was fitted to them.
    """
    usual = usual_blur(pictures)
    square = found.squares()
    verdicts = []
    for number, made in enumerate(pictures):
        mine = found.picture == number
        freedom = max(1.0, 2.0 * float(mine.sum()) * freedom_share)
        level = float(square[mine].sum()) / freedom if mine.any() else float("nan")
        findings = []
        if level > 1.0 + _SIGMAS * np.sqrt(2.0 / freedom):
            findings.append(f"dots are {np.sqrt(level):.2g} times as far off as noise makes them")
        if is_unusual(made, usual[made.camera]):
            findings.append(
                f"edges are blurred by {made.blur_px:.2f} px, usual for this camera are "
                f"{usual[made.camera]:.2f} px"
            )
        if made.pixels.flat_variance > _LOUD:
            findings.append(
                f"paper and ink differ by {np.sqrt(made.pixels.flat_variance):.2g} times the noise"
            )
        if made.pixels.edge_variance > max(_LOUD, _LOUD * made.pixels.flat_variance):
            findings.append(f"edges differ by {np.sqrt(made.pixels.edge_variance):.2g} times the noise")
        noise = np.trace(found.covariance[mine], axis1=1, axis2=2)
        by_noise = float(np.sqrt(noise.mean())) if mine.any() else float("nan")
        rms = _rms(found.residual[mine])
        verdicts.append(PictureVerdict(made.view, made.camera, rms, by_noise, level, tuple(findings)))
    return tuple(verdicts)


def usual_blur(pictures: Sequence[TwinPicture]) -> dict[str, float]:
    """Return the median blur of each camera, px."""
    cameras = dict.fromkeys(made.camera for made in pictures)
    return {
        name: float(np.median([made.blur_px for made in pictures if made.camera == name])) for name in cameras
    }


def is_unusual(made: TwinPicture, usual: float) -> bool:
    """Tell whether the blur of a picture is not the one of its camera."""
    sigma = made.windows.sigma[:, BLUR]
    known = sigma[np.isfinite(sigma)]
    chance = float(np.median(known)) / np.sqrt(len(known)) if len(known) else np.inf
    return abs(made.blur_px - usual) > max(_BLUR_SHARE * usual, _SIGMAS * chance)


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


def unexplained_positions(
    explanation: Explained, found: DotResiduals, names: Sequence[str] = (), far: tuple[str, ...] = ()
) -> tuple[Unexplained, ...]:
    """Return what moves dots beyond noise, by rank.

    Parameters
    ----------
    explanation : Explained
    found : DotResiduals
    names : sequence of str
        Of the pictures.
    far : tuple of str
        Pictures with residuals above the mean.
    """
    moving = [_moving(cause, found, names) for cause in explanation.causes]
    n = 2.0 * len(found)
    if explanation.rest > _REST_SHARE and explanation.left_level > 1.0 + _SIGMAS * np.sqrt(2.0 / n):
        moving.append(Unexplained(
            "positions",
            f"residuals of dots without a pattern that repeats, {np.sqrt(explanation.left_level):.2g} times "
            "the noise: edges that are not those of round dots, or light and blur that vary from dot to dot",
            explanation.rest, np.sqrt(explanation.rest) * found.rms_px, "px", far,
        ))  # fmt: skip
    return tuple(sorted(moving, key=lambda one: -(one.share or 0.0)))


def _moving(cause: Cause, found: DotResiduals, names: Sequence[str]) -> Unexplained:
    """Return a cause of residuals in words."""
    size, share = cause.size, cause.share
    if cause.rivals:
        size = _rms(cause.fit)
        could = " or ".join(_SHORT[kind] for kind in (cause.kind, *cause.rivals))
        words = (
            f"a pattern of {size:.2g} px RMS that can be {could}: these views do not tell which; "
            "more views with other tilts and places in the picture do"
        )
        return Unexplained("undecided", words, share, size, "px")
    if cause.kind is CauseKind.PRINT:
        words = f"the places of the dots on the print: {size:.2g} um RMS in its plane, the same in all views"
    elif cause.kind is CauseKind.BEND:
        words = f"a board that is bent otherwise: dots are displaced by {size:.2g} um RMS as cameras see it"
    elif cause.kind is CauseKind.LENS:
        words = f"the lens: a smooth field over the picture, {size:.2g} px RMS, the same in all views"
    else:
        rms = [_rms(cause.fit[found.picture == number]) for number in range(len(names))]
        order = np.argsort(-np.array(rms))[:_SHOWN]
        worst = tuple(names[i] for i in order if rms[i] > 0.5 * max(rms))
        words = (
            f"single pictures that do not agree with the others of their view: {size:.2g} px RMS, most in "
            f"{listed(worst)}; the target moved between the exposures, or a camera did"
        )
        return Unexplained("pictures", words, share, size, "px", worst)
    return Unexplained(cause.kind.value, words, share, size, cause.unit)


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
    return float(beyond) if spread > 2.0 * noise and beyond > _BLUR_SHARE * made.blur_px else 0.0


def _pixels(pictures: Sequence[TwinPicture], names: list[str]) -> list[Unexplained]:
    """Return what differences of pixels show."""
    found = []
    flat = np.array([made.pixels.flat_variance for made in pictures])
    edge = np.array([made.pixels.edge_variance for made in pictures])
    loud = edge > np.maximum(_LOUD, _LOUD * flat)
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
    loud = flat > _LOUD
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
    """Return a remark where some of the pictures are JPEG."""
    stored = [one.image for one, shown in zip(pictures, which, strict=True) if shown]
    lossy = sum(name.lower().endswith((".jpg", ".jpeg")) for name in stored)
    if not lossy:
        return ""
    return (
        f"; {'they' if lossy == len(stored) else f'{lossy} of them'} are JPEG, whose compression is not "
        "simulated: it adds to these differences"
    )


def _some(names: list[str], which: np.ndarray) -> tuple[str, ...]:
    """Return the names of some pictures; none where all show it."""
    return () if which.all() else tuple(name for name, one in zip(names, which, strict=True) if one)


def _rms(residual: np.ndarray) -> float:
    return float(np.sqrt((residual**2).sum(axis=1).mean())) if len(residual) else float("nan")
