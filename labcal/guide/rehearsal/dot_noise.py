"""The noise of measured dots by their size: from drawn pictures in which the detector measures them."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64

from labcal.arrays import PixelCovariances, Pixels, PointJacobians, Pose
from labcal.cameras.camera import Camera
from labcal.detect.detector import detect_dots
from labcal.errors import InputError
from labcal.guide.rehearsal.drawn_view import drawn_view
from labcal.render.sensor_response import Shot
from labcal.scene.photometry import Photometry
from labcal.targets.grid import DotGrid
from labcal.wording import counted

_FEWEST = 60
"""Measured coordinates from which noise is known to a tenth."""
_SPREAD = 1.2
"""Ratio of the sizes of dots from which on their noise by size is found from the pictures themselves."""
_USUAL_POWER = -1.5
"""Of the variance by the minor semi-axis, between that of the bound (-1) and what small dots show (-3)."""
_POWERS = (-6.0, 0.0)


@dataclass(frozen=True)
class DotNoise:
    """The variance of a coordinate of a dot's position, px squared: ``variance * (size / size_px)^power``.

    Attributes
    ----------
    size_px : float
        Typical minor semi-axis of the dots, px.
    variance : float
        Of dots of that size.
    power : float
    """

    size_px: float
    variance: float
    power: float

    def at(self, size_px: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
        """Return the variance of dots with these minor semi-axes, px squared."""
        return np.asarray(self.variance * (size_px / self.size_px) ** self.power)

    def covariances(self, size_px: Float64[np.ndarray, " n"]) -> PixelCovariances:
        """Return the same as covariances of positions, (n, 2, 2)."""
        return self.at(size_px)[:, None, None] * np.eye(2)

    def times(self, factor: float) -> "DotNoise":
        """Return noise with a standard deviation that is so many times as large."""
        return DotNoise(self.size_px, factor**2 * self.variance, self.power)

    @classmethod
    def of_errors(
        cls, size_px: Float64[np.ndarray, " n"], error_px: Float64[np.ndarray, "n 2"]
    ) -> "DotNoise":
        """Return the noise that errors of measured dots show.

        Parameters
        ----------
        size_px : ndarray, shape (n,)
            Minor semi-axes of the dots.
        error_px : ndarray, shape (n, 2)
            Measured minus true positions.

        Notes
        -----
        The logarithm of a squared normal error is that of its variance and a variable of one distribution,
        so that least squares on logarithms find the power; the variance is then the mean square.
        """
        typical = float(np.exp(np.log(size_px).mean()))
        relative = np.log(size_px / typical)
        square = (error_px**2).mean(axis=1)
        power = _USUAL_POWER
        if np.exp(relative.max() - relative.min()) > _SPREAD:
            power = float(np.clip((relative @ np.log(square)) / (relative @ relative), *_POWERS))
        return cls(typical, float((square * np.exp(-power * relative)).mean()), power)


@dataclass(frozen=True)
class DrawnPicture:
    """Outcome of the detector in one drawn picture.

    Attributes
    ----------
    view, camera : int
    whole : int
        Dots that are wholly in the picture.
    found : int
        Those of them that were measured.
    size_px : float64 array, (found,)
        Their minor semi-axes.
    error_px : float64 array, (found, 2)
    dot_px : float
        Median minor semi-axis of all whole dots; NaN where there is none.
    spanned : float
        Share of the picture that is inside the convex hull of the whole dots.
    refusal : str
        Why the detector gives no ids; empty where it does.
    """

    view: int
    camera: int
    whole: int
    found: int
    size_px: Float64[np.ndarray, " found"]
    error_px: Float64[np.ndarray, "found 2"]
    dot_px: float
    spanned: float
    refusal: str


def drawn_pictures(
    cameras: Sequence[Camera],
    T_world_target: Sequence[Pose],
    target: DotGrid,
    photometry: Photometry,
    seed: int,
) -> list[DrawnPicture]:
    """Draw every view in every camera, and measure its dots.

    Parameters
    ----------
    cameras : sequence of Camera
    T_world_target : sequence of ndarray, shape (4, 4)
        Mm.
    target : DotGrid
    photometry : Photometry
    seed : int
    """
    return [
        _drawn(camera, T, target, photometry, (view, number, seed))
        for view, T in enumerate(T_world_target)
        for number, camera in enumerate(cameras)
    ]


def measured_noise(pictures: Sequence[DrawnPicture]) -> DotNoise:
    """Return the noise of dots in drawn pictures.

    Raises
    ------
    InputError
        The detector measures next to nothing in them.
    """
    size = np.concatenate([np.zeros(0), *(picture.size_px for picture in pictures)])
    error = np.concatenate([np.zeros((0, 2)), *(picture.error_px for picture in pictures)])
    if error.size < _FEWEST:
        refused = sorted({picture.refusal for picture in pictures if picture.refusal})
        why = f" ({', '.join(refused)})" if refused else ""
        raise InputError(
            f"In drawn pictures of the planned views only {counted(len(size), 'dot')} can be measured{why}. "
            "Plan a target with larger dots, a shorter distance, a longer focal length, or a better sensor."
        )
    return DotNoise.of_errors(size, error)


def facing_sizes(by_point: PointJacobians, radius_mm: float) -> Float64[np.ndarray, " n"]:
    """Return the minor semi-axes (px) of the images of dots that face the camera.

    Parameters
    ----------
    by_point : ndarray, shape (n, 2, 3)
        Derivatives of pixels by the place of a point, px/mm.
    radius_mm : float
    """
    return np.asarray(radius_mm * np.linalg.svd(by_point, compute_uv=False)[:, 1])


def _drawn(
    camera: Camera, T: Pose, target: DotGrid, photometry: Photometry, key: tuple[int, int, int]
) -> DrawnPicture:
    view, number, seed = key
    drawn = drawn_view(camera, T, target, photometry, Shot(seed, f"drawn-{view}", f"camera-{number}"))
    inside = drawn.images.ok & camera.in_picture(drawn.images.outline).all(axis=-1)
    dots = detect_dots(drawn.picture, target)
    index = dots.index[:, 1] * target.cols + dots.index[:, 0]
    good = dots.ok
    at = index[good]
    whole = inside[at]
    size = minor_semi_axes(drawn.images.outline[at[whole]])
    error = dots.position[good][whole] + drawn.corner - drawn.images.centroid[at[whole]]
    refusal = "" if dots.refusal is None else str(dots.refusal.value)
    return DrawnPicture(
        view=view,
        camera=number,
        whole=int(inside.sum()),
        found=int(whole.sum()),
        size_px=size,
        error_px=error,
        dot_px=float(np.median(minor_semi_axes(drawn.images.outline[inside]))) if inside.any() else np.nan,
        spanned=hull_area(drawn.images.centre[inside]) / (camera.size[0] * camera.size[1]),
        refusal=refusal,
    )


def hull_area(q: Pixels) -> float:
    """Return the area of the convex hull of pixels, px squared."""
    if len(q) < 3:  # noqa: PLR2004 -- a triangle
        return 0.0
    return float(cv2.contourArea(cv2.convexHull(q.astype(np.float32))))


def minor_semi_axes(outlines: Float64[np.ndarray, "n samples 2"]) -> Float64[np.ndarray, " n"]:
    """Return the minor semi-axes of outlines that are nearly ellipses, px."""
    away = outlines - outlines.mean(axis=1, keepdims=True)
    shape = 2.0 * np.einsum("nki,nkj->nij", away, away) / outlines.shape[1]
    return np.asarray(np.sqrt(np.linalg.eigvalsh(shape)[:, 0]))
