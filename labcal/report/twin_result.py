"""Result of ``labcal twin``: the JSON document, and the same for people."""

from dataclasses import dataclass

import numpy as np

from labcal.guide.twin.twin import DeclaredPrint, Twin
from labcal.guide.twin.unexplained_positions import Unexplained
from labcal.paths import AnyPath


@dataclass(frozen=True)
class TwinPictureResult:
    """One picture in the JSON document."""

    view: str
    camera: str
    image: str
    dots: int
    rms_px: float | None
    """RMS residual of dots, photograph minus rendering, 2-D."""
    noise_px: float | None
    """The same by noise alone, as simulated."""
    level: float | None
    """Mean squared residual of dots in units of noise; 1 is noise alone."""
    blur_px: float
    """Standard deviation of the blur of edges, fitted to the photograph."""
    flat_variance: float | None
    """Mean squared difference of pixels of paper and ink in units of the variance of noise; 1 is noise."""
    edge_variance: float | None
    """The same at the edges of dots."""
    specks: int
    """Pixels farther off than 6 standard deviations."""
    tone_curve: str
    noise_offset: float
    noise_slope: float
    """Variance of the noise without light, and its growth with light, in values proportional to light."""
    noise_correlation: tuple[float, float]
    """Of neighbours along rows and columns."""
    at_noise: bool
    findings: list[str]


@dataclass(frozen=True)
class UnexplainedResult:
    """Something that simulation does not explain, in the JSON document."""

    kind: str
    words: str
    share: float | None
    """Of the squares of residuals of dots; null of what does not move dots."""
    size: float
    unit: str
    pictures: list[str]
    """That show it; empty where all do."""


@dataclass(frozen=True)
class DeclaredResult:
    """A simulation of the print as declared, in the JSON document."""

    rms_px: float
    """RMS residual of dots, 2-D."""
    unexplained: list[UnexplainedResult]


@dataclass(frozen=True)
class TwinResult:
    """The JSON document of ``labcal twin``."""

    folder: str | None
    views: list[str]
    dots: int
    """Positions that were compared."""
    rms_px: float
    """RMS residual of dots, photograph minus rendering, 2-D."""
    noise_px: float
    """The same by simulated noise alone."""
    explained: float
    """Share of the squares of residuals that simulation predicts; 1 is all."""
    level: float
    """Mean squared residual in units of noise; 1 is noise alone."""
    pixel_variance: float | None
    """Mean squared difference of all compared pixels in units of the variance of the noise."""
    flat_variance: float | None
    edge_variance: float | None
    unexplained: list[UnexplainedResult]
    """By rank: what moves dots first."""
    print_measured: bool
    """True if dots were rendered at places that the calibration found."""
    print_rms_um: float
    """RMS displacement of these places in the plane from the declared ones; 0 of a print as declared."""
    declared: DeclaredResult | None
    """A simulation of the print as declared; null where it was rendered so."""
    dot_growth_um: float
    """By how much radii of dots are larger than declared, as pictures show them; it is in the renderings."""
    pictures: list[TwinPictureResult]
    warnings: list[str]


def twin_result(folder: AnyPath | None, found: Twin) -> TwinResult:
    """Return the JSON document.

    Parameters
    ----------
    folder : path or None
    found : Twin
    """
    pictures = [
        TwinPictureResult(
            view=made.view, camera=made.camera, image=made.image, dots=len(made.dots),
            rms_px=_number(verdict.rms_px), noise_px=_number(verdict.noise_px), level=_number(verdict.level),
            blur_px=made.blur_px, flat_variance=_number(made.pixels.flat_variance),
            edge_variance=_number(made.pixels.edge_variance), specks=made.pixels.specks,
            tone_curve=made.curve, noise_offset=made.noise.offset, noise_slope=made.noise.slope,
            noise_correlation=(made.noise.along, made.noise.down), at_noise=not verdict.findings,
            findings=list(verdict.findings),
        )
        for made, verdict in zip(found.pictures, found.verdicts, strict=True)
    ]  # fmt: skip
    return TwinResult(
        folder=None if folder is None else str(folder),
        views=list(dict.fromkeys(made.view for made in found.pictures)),
        dots=len(found.residuals),
        rms_px=found.residuals.rms_px,
        noise_px=found.residuals.noise_px,
        explained=found.explained.noise,
        level=found.explained.level,
        pixel_variance=_number(found.pixel_variance),
        flat_variance=_number(found.flat_variance),
        edge_variance=_number(found.edge_variance),
        unexplained=[_unexplained(one) for one in found.unexplained],
        print_measured=found.known.is_measured,
        print_rms_um=found.known.rms_um,
        declared=None if found.declared is None else _declared(found.declared),
        dot_growth_um=found.growth_um,
        pictures=pictures,
        warnings=list(found.warnings),
    )


def _unexplained(one: Unexplained) -> UnexplainedResult:
    return UnexplainedResult(one.kind, one.words, one.share, one.size, one.unit, list(one.pictures))


def _declared(found: DeclaredPrint) -> DeclaredResult:
    return DeclaredResult(found.rms_px, [_unexplained(one) for one in found.unexplained])


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
