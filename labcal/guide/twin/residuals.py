"""Positions of dots in photographs minus those in renderings, and how each cause would move them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.geometry.poses import transform
from labcal.guide.twin.picture import TwinPicture
from labcal.guide.twin.posed import PosedViews

_STEP_MM = 1e-3
_LEAST_SCALE = 0.2
_FEWEST = 20


@dataclass(frozen=True)
class DotResiduals:
    """Residuals of n dots in pictures.

    Attributes
    ----------
    camera, view, dot, picture : int array, (n,)
        Numbers; the picture's among those that were rendered.
    q : float64 array, (n, 2)
        As measured in the photograph, px.
    residual : float64 array, (n, 2)
        Photograph minus rendering, px.
    covariance : float64 array, (n, 2, 2)
        By noise, px squared: as the detector states it for the photograph, times what simulated noise shows
        of the statements.
    by_point : float64 array, (n, 2, 3)
        Derivative of the image by the place of the dot in the target's frame, px/mm.
    scale : float
        Variance of positions in renderings with noise over the one that the detector states for them.
    """

    camera: Int64[np.ndarray, " n"]
    view: Int64[np.ndarray, " n"]
    dot: Int64[np.ndarray, " n"]
    picture: Int64[np.ndarray, " n"]
    q: Float64[np.ndarray, "n 2"]
    residual: Float64[np.ndarray, "n 2"]
    covariance: Float64[np.ndarray, "n 2 2"]
    by_point: Float64[np.ndarray, "n 2 3"]
    scale: float

    def __len__(self) -> int:
        return len(self.camera)

    def squares(self) -> Float64[np.ndarray, " n"]:
        """Return squared residuals in units of the noise; 2 is noise alone."""
        inverse = np.linalg.inv(self.covariance)
        return np.asarray(np.einsum("ni,nij,nj->n", self.residual, inverse, self.residual))

    @property
    def rms_px(self) -> float:
        """RMS residual, 2-D, px."""
        return float(np.sqrt((self.residual**2).sum(axis=1).mean()))

    @property
    def noise_px(self) -> float:
        """RMS that noise alone makes, 2-D, px."""
        return float(np.sqrt(np.trace(self.covariance, axis1=1, axis2=2).mean()))


def dot_residuals(posed: PosedViews, pictures: Sequence[TwinPicture]) -> DotResiduals:
    """Return the residuals of all dots that were measured both in photographs and in renderings.

    Parameters
    ----------
    posed : PosedViews
    pictures : sequence of TwinPicture
    """
    parts: list[tuple[np.ndarray, ...]] = []
    state, seen = posed.state, posed.observations
    numbers = {(posed.cameras[p.camera], posed.names[p.view]): p for p in seen.pictures}
    for number, made in enumerate(pictures):
        picture = numbers[made.camera, made.view]
        rows = np.arange(len(seen))[picture.rows]
        known = np.isfinite(made.rendered).all(axis=1)
        rows = rows[known]
        camera, T = state.cameras[picture.camera], state.T_world_target[picture.view]
        p = state.dots[seen.dot[rows]]
        columns = []
        for axis in range(3):
            step = _STEP_MM * np.eye(3)[axis]
            ahead, back = camera.project(transform(T, p + step)).q, camera.project(transform(T, p - step)).q
            columns.append((ahead - back) / (2.0 * _STEP_MM))
        parts.append((
            seen.camera[rows], seen.view[rows], seen.dot[rows], np.full(len(rows), number), seen.q[rows],
            seen.q[rows] - made.rendered[known], seen.covariance[rows], np.stack(columns, axis=-1),
        ))  # fmt: skip
    camera_of, view, dot, which, q, residual, covariance, by_point = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    scale = _scale(pictures)
    return DotResiduals(
        camera_of, view, dot, which.astype(np.int64), q, residual, scale * covariance, by_point, scale
    )


def _scale(pictures: Sequence[TwinPicture]) -> float:
    """Return the variance that draws show over the one that the detector states for them."""
    ratios = []
    for made in pictures:
        off = made.drawn - made.rendered
        inverse = np.linalg.inv(np.where(np.isfinite(made.covariance), made.covariance, np.eye(2)))
        square = np.einsum("kni,nij,knj->kn", off, inverse, off) / 2.0
        ratios.append(square[:, np.isfinite(made.covariance[:, 0, 0])].ravel())
    every = np.concatenate([np.zeros(0), *ratios])
    every = every[np.isfinite(every)]
    if len(every) < _FEWEST:
        return 1.0
    return max(_LEAST_SCALE, float(np.median(every) / np.log(2.0)))  # of chi-square with 2 over 2
