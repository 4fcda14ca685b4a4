"""Positions of dots in photographs minus those in renderings, and how each cause would move them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

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
        As rendered or predicted, px; as measured, they would hold the very noise that is to be judged.
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
        return rms(self.residual)

    @property
    def noise_px(self) -> float:
        """RMS that noise alone makes, 2-D, px."""
        return float(np.sqrt(np.trace(self.covariance, axis1=1, axis2=2).mean()))


def rms(vectors: Float64[np.ndarray, "n 2"]) -> float:
    """Return the root mean square of the lengths of vectors; NaN of none."""
    return float(np.sqrt((vectors**2).sum(axis=1).mean())) if len(vectors) else float("nan")


def dot_residuals(posed: PosedViews, pictures: Sequence[TwinPicture]) -> DotResiduals:
    """Return the residuals of all dots that were measured both in photographs and in renderings.

    Parameters
    ----------
    posed : PosedViews
    pictures : sequence of TwinPicture
    """
    seen = posed.observations
    numbers = {(posed.cameras[p.camera], posed.names[p.view]): p for p in seen.pictures}
    rendered, which = np.full((len(seen), 2), np.nan), np.zeros(len(seen), dtype=np.int64)
    for number, made in enumerate(pictures):
        rows = numbers[made.camera, made.view].rows
        rendered[rows], which[rows] = made.rendered, number
    known = np.isfinite(rendered).all(axis=1)
    return _residuals(posed, known, (seen.q - rendered)[known], which[known], _scale(pictures))


def predicted_residuals(posed: PosedViews, scale: float) -> DotResiduals:
    """Return the residuals of all dots against predicted centroids, without a rendering.

    Parameters
    ----------
    posed : PosedViews
    scale : float
        Of the variances that the detector states.
    """
    seen = posed.observations
    which = np.zeros(len(seen), dtype=np.int64)
    for number, picture in enumerate(seen.pictures):
        which[picture.rows] = number
    return _residuals(posed, np.ones(len(seen), dtype=bool), posed.residual(), which, scale)


def _residuals(
    posed: PosedViews,
    known: Bool[np.ndarray, " all"],
    residual: Float64[np.ndarray, "n 2"],
    which: Int64[np.ndarray, " n"],
    scale: float,
) -> DotResiduals:
    """Return residuals of known dots, with the derivatives of their images."""
    state, seen = posed.state, posed.observations
    by_point = np.zeros((len(seen), 2, 3))
    for picture in seen.pictures:
        camera, T = state.cameras[picture.camera], state.T_world_target[picture.view]
        p = state.dots[seen.dot[picture.rows]]
        for axis in range(3):
            step = _STEP_MM * np.eye(3)[axis]
            ahead, back = camera.project(transform(T, p + step)).q, camera.project(transform(T, p - step)).q
            by_point[picture.rows, :, axis] = (ahead - back) / (2.0 * _STEP_MM)
    return DotResiduals(
        seen.camera[known], seen.view[known], seen.dot[known], which, seen.q[known] - residual, residual,
        scale * seen.covariance[known], by_point[known], scale,
    )  # fmt: skip


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
