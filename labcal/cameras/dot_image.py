"""The image of a circular dot: where its centre, its outline and the centroid of its area fall.

The centroid of a projected disc is not the projection of its centre (the "eccentricity" of Ahn, Warnecke
and Kotowski 1999); lens distortion moves it further. Here both follow from the outline, for any camera.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Lengths, Mask, Outlines, Pixels, Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.imaging import Projection
from labcal.geometry.poses import transform

SAMPLES = 64
"""Points on an outline; on a smooth closed curve sums and Fourier derivatives converge exponentially."""

Imaging = Callable[[Vectors3], Projection]
"""From points of the target, in mm in any one frame, to pixels."""


@dataclass(frozen=True)
class DotImages:
    """Images of n dots in one picture, px; NaN where any part cannot be imaged."""

    centre: Pixels
    """(n, 2), the image of the dot's centre."""
    centroid: Pixels
    """(n, 2), the centre of area of the image of its outline."""
    outline: Outlines
    """(n, SAMPLES, 2), the outline from the target's +x direction towards +y."""
    ok: Mask
    """(n,), whether the whole dot is imaged."""


def flat_outlines(
    centres: Vectors3, radii: np.ndarray, rotation: Float64[np.ndarray, "n 3 3"] | None = None
) -> Float64[np.ndarray, "n samples 3"]:
    """Return the outlines of discs, parallel to the target's x-y plane or tilted, mm, shape (n, SAMPLES, 3).

    Parameters
    ----------
    centres : ndarray, shape (n, 3)
        Centres of the dots in the target's frame, mm.
    radii : ndarray, shape (n,)
        Radii of the outer outlines, mm.
    rotation : ndarray, shape (n, 3, 3), optional
        From a frame whose x-y plane is that of the disc to the target's; parallel discs where left out.
    """
    angle = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(SAMPLES)], axis=-1)
    turned = circle if rotation is None else circle @ np.swapaxes(rotation, -1, -2)
    return np.asarray(centres[:, None, :] + radii[:, None, None] * turned)


def dot_images(
    camera: Camera,
    T_world_target: Pose,
    centres: Vectors3,
    radii: np.ndarray,
    rotation: Float64[np.ndarray, "n 3 3"] | None = None,
) -> DotImages:
    """Return where the dots of a flat target are imaged.

    Parameters
    ----------
    camera : Camera
    T_world_target : ndarray, shape (4, 4)
        Pose of the target, mm.
    centres : ndarray, shape (n, 3)
        Centres of the dots in the target's frame, mm.
    radii : ndarray, shape (n,)
        Radii of the outer outlines, mm; 0 for a place without extent, a corner: its centroid is its centre.
    rotation : ndarray, shape (n, 3, 3), optional
        Of the discs against the target's x-y plane; they lie parallel to it where left out.
    """
    outlines = flat_outlines(centres, radii, rotation)
    images = outlined_images(lambda p: camera.project(transform(T_world_target, p)), centres, outlines)
    return of_places(images, radii)


def of_places(images: DotImages, radii: Lengths) -> DotImages:
    """Return images in which the centroid of a place without extent, of radius 0, is its centre."""
    if radii.all():
        return images
    centroid = np.where((radii == 0.0)[:, None], images.centre, images.centroid)
    return replace(images, centroid=centroid)


def outlined_images(
    image: Imaging, centres: Vectors3, outlines: Float64[np.ndarray, "n samples 3"]
) -> DotImages:
    """Return where dots of any shape are imaged, by any smooth imaging.

    Parameters
    ----------
    image : callable
        Takes points (..., 3) of the frame of `centres`, returns their :class:`Projection`.
    centres : ndarray, shape (n, 3)
        The dots' centres, mm.
    outlines : ndarray, shape (n, SAMPLES, 3)
        Their outlines at equal steps of a parameter that runs once around, mm.

    Notes
    -----
    With the outline (x(t), y(t)), Green's theorem gives the area as half the integral of x dy - y dx and the
    centroid as the integrals of x^2 dy / 2 and -y^2 dx / 2 over the area. The derivatives are those of the
    trigonometric interpolant.
    """
    middle = image(centres)
    edge = image(outlines)
    ok = middle.ok & edge.ok.all(axis=-1)
    offset = edge.q - middle.q[:, None, :]  # about the centre, where no digits are lost
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        x, y = offset[..., 0], offset[..., 1]
        dx, dy = _derivative(x), _derivative(y)
        area = 0.5 * (x * dy - y * dx).sum(axis=-1)
        first = np.stack([0.5 * (x * x * dy).sum(axis=-1), -0.5 * (y * y * dx).sum(axis=-1)], axis=-1)
        centroid = middle.q + first / area[:, None]
    keep = ok[:, None]
    return DotImages(
        centre=middle.q,
        centroid=np.where(keep, centroid, np.nan),
        outline=np.where(keep[..., None], edge.q, np.nan),
        ok=ok,
    )


def _derivative(values: np.ndarray) -> np.ndarray:
    """Return the derivative of periodic samples (last axis) by their own index."""
    frequency = np.fft.fftfreq(values.shape[-1], 1.0 / values.shape[-1])
    frequency[values.shape[-1] // 2] = 0.0  # the highest one has no sign
    spectrum = np.fft.fft(np.where(np.isfinite(values), values, 0.0), axis=-1)
    return np.asarray(np.fft.ifft(1j * frequency * spectrum, axis=-1).real)
