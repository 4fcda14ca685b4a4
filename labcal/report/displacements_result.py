"""Displacements in the JSON document of ``labcal measure``, and the same for people."""

from dataclasses import dataclass

import numpy as np

from labcal.paths import AnyPath
from labcal.reconstruct.displacements import Displacements
from labcal.wording import counted


@dataclass(frozen=True)
class MovedView:
    """The points of a view."""

    view: str
    points: int
    """Points with a displacement."""
    rms_mm: float
    """RMS length of the displacements."""
    max_mm: float
    sigma_mm: float
    """RMS standard deviation of a displacement, in space."""
    rigid_displacement_mm: list[float] | None
    """Displacement of the middle of the points by their rigid motion; null with fewer than three points."""
    rigid_displacement_sigma_mm: list[float] | None
    rotation_deg: list[float] | None
    """Rotation vector."""
    rotation_sigma_deg: list[float] | None
    rigid_rms_mm: float | None
    """RMS distance of the points from their places after the rigid motion."""


@dataclass(frozen=True)
class DisplacementsResult:
    """The key ``displacements`` in the JSON document."""

    file: str
    reference_view: str
    n: int
    """Lines of the table."""
    views: list[MovedView]


def displacements_result(file: AnyPath, found: Displacements) -> DisplacementsResult:
    """Return the key of the document; `file` is where the displacements are."""
    return DisplacementsResult(
        str(file), found.reference_view, len(found), [_moved(found, view) for view in found.views]
    )


def displacements_words(result: DisplacementsResult) -> str:
    """Return the displacements as lines for people, after those of a result: those of the last view."""
    last = result.views[-1]
    words = f"\n{result.file}: displacements in {counted(len(result.views), 'view')} since "
    words += (
        f"'{result.reference_view}'\nin '{last.view}' RMS {last.rms_mm:.4g} mm, sigma {last.sigma_mm:.2g} mm"
    )
    if last.rigid_displacement_mm is not None and last.rotation_deg is not None:
        shift, turn = np.linalg.norm(last.rigid_displacement_mm), np.linalg.norm(last.rotation_deg)
        words += f", rigid motion {shift:.4g} mm and {turn:.3g} degrees, residual {last.rigid_rms_mm:.2g} mm"
    return words


def _moved(found: Displacements, view: str) -> MovedView:
    rows = np.flatnonzero(found.view == view)
    length = found.length_mm[rows]
    known = np.isfinite(length)
    variance = np.trace(found.covariance[rows][known], axis1=1, axis2=2)
    motion = found.motions.get(view)
    return MovedView(
        view,
        int(known.sum()),
        float(np.sqrt((length[known] ** 2).mean())) if known.any() else float("nan"),
        float(length[known].max()) if known.any() else float("nan"),
        float(np.sqrt(variance.mean())) if known.any() else float("nan"),
        None if motion is None else motion.displacement_mm.tolist(),
        None if motion is None else motion.sigma_displacement_mm.tolist(),
        None if motion is None else np.degrees(motion.rotation_rad).tolist(),
        None if motion is None else np.degrees(motion.sigma_rotation_rad).tolist(),
        None if motion is None else motion.rms_mm,
    )
