"""The prior of lens coefficients, in calibration and in resection.

Dots do not tell all coefficients of a lens. Some stand in for each other (k1 and k4 of the rational model do
at first order), and steps along such a direction end at a pole of the formula; and what a high power of the
radius does in the picture's corners no dot in its middle tells. So all of them are held where the lens has
no distortion, most at 0.

The wide prior says that none bends the picture by its own width where dots are. It weighs nothing beside what
dots tell: a dot's noise is a ten-thousandth of a picture's width or less. The coefficients beyond Brown's
five are held tighter: else noise sets them, and the pole may come to lie just outside the dots.

The narrow prior is for dots that leave a lens open up to folds inside the picture: coefficients are held by
what they do at the picture's border, where they do most. It would move coefficients that dots tell by some of
their standard deviations, so it is taken only where the lens is open, and where it explains the dots as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from jaxtyping import Float64

from labcal.cameras.camera import Camera
from labcal.cameras.lens import undistorted_dist
from labcal.cameras.opencv_model import PERSPECTIVE
from labcal.cameras.optics import INTRINSICS

_BEYOND_BROWN = PERSPECTIVE.order[5:]
"""These stand in for the first five where dots do not tell them apart."""
_OPEN = 0.1
"""Standard deviation at the picture's border, over its width, from which on dots leave a lens open. It is
0.04 or less where dots reach half of the way to the corners or farther, 0.13 or more where they do not."""
_LESS = 0.5
"""Share of the blind pixels that may be left. Those outside the round picture of a fisheye are no fold."""
_AS_WELL = 1.05
"""Ratio of RMS residuals up to which dots are explained as well, with fewer coefficients that are free."""


class PriorWidth(Enum):
    """One standard deviation of what each coefficient does to a picture, over the picture's width.

    First of Brown's five and of all coefficients of models of another kind, then of those beyond the five.
    """

    WIDE = (1.0, 0.01)
    """At the outermost dot."""
    NARROW = (0.05, 0.01)
    """At the picture's border. A single coefficient folds a lens at the corner with 0.1 (k3) to 0.2 (k1)."""


@dataclass(frozen=True)
class FoundLens:
    """A camera that was found, and the covariance of its lens's coefficients."""

    camera: Camera
    covariance: Float64[np.ndarray, "coefficients coefficients"]

    @property
    def is_open(self) -> bool:
        """True if the lens folds inside the picture, or its border is not determined."""
        if self.camera.model.coefficients == 0:
            return False
        if self.camera.share_without_rays > 0.0:
            return True
        J = _border_slopes(self.camera)
        variance = np.einsum("nic,cd,nid->n", J, self.covariance, J)
        return not bool((variance <= (_OPEN * self.camera.size[0]) ** 2).all())  # of NaN, too


def coefficient_weights(
    camera: Camera, effect: Float64[np.ndarray, " coefficients"], width: PriorWidth
) -> Float64[np.ndarray, " coefficients"]:
    """Return the inverse variances of a lens's coefficients about those of no distortion.

    Parameters
    ----------
    camera : Camera
    effect : ndarray, shape (coefficients,)
        The most that a coefficient of 1 moves the image of any dot, px; for the wide prior.
    width : PriorWidth
    """
    model, picture_width = camera.model, camera.size[0]
    share, share_beyond = width.value
    beyond = _BEYOND_BROWN if model.opencv is PERSPECTIVE else ()
    shares = np.array([share_beyond if name in beyond else share for name in model.names])
    if width is PriorWidth.NARROW:
        effect = border_effects(camera)
    return np.asarray((effect / (shares * picture_width)) ** 2)


def narrow_is_better(wide: Sequence[Camera], narrow: Sequence[Camera], rms_ratio: float) -> bool:
    """Tell whether to take the cameras that the narrow prior gave, where the wide one leaves lenses open.

    They must image more of their pictures, if the others fold, and explain the dots as well.

    Parameters
    ----------
    wide, narrow : sequence of Camera
        The same cameras with both priors.
    rms_ratio : float
        RMS residual of the latter over that of the former.
    """
    lost = [sum(camera.share_without_rays for camera in found) for found in (wide, narrow)]
    return lost[1] <= _LESS * lost[0] and rms_ratio <= _AS_WELL


def border_effects(camera: Camera) -> Float64[np.ndarray, " coefficients"]:
    """Return the most that a coefficient of 1 moves the picture's border of an undistorted lens, px."""
    return np.asarray(np.abs(_border_slopes(camera)).max(axis=(0, 1), initial=0.0))


def _border_slopes(camera: Camera) -> Float64[np.ndarray, "n 2 coefficients"]:
    """Return the displacement of the border of the picture of an undistorted lens by each coefficient, px."""
    width, height = camera.size
    plain = replace(camera, dist=undistorted_dist(camera.model), T_cam_world=np.eye(4), window=None)
    u, v = np.meshgrid([0.0, 0.5 * (width - 1), width - 1.0], [0.0, 0.5 * (height - 1), height - 1.0])
    rays = plain.rays(np.stack([u.ravel(), v.ravel()], axis=-1))
    return np.asarray(plain.intrinsic_jacobian((rays.origin + rays.direction)[rays.ok])[:, :, INTRINSICS:])
