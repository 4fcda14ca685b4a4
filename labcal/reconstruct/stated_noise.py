"""Covariances of pixels that state none, from a standard deviation that the user states for them."""

import numpy as np

from labcal.correspond.named_pixels import NamedPixels
from labcal.errors import InputError
from labcal.wording import counted


def with_covariances(pixels: NamedPixels, pixel_sigma: float | None) -> NamedPixels:
    """Return named pixels of which each has a covariance.

    Parameters
    ----------
    pixels : NamedPixels
    pixel_sigma : float or None
        Standard deviation along each axis of the pixels that state no covariance, px.

    Raises
    ------
    InputError
        A pixel states none and neither does the user, or all do and the user does, too, or no pixel has a
        position.
    """
    there = np.isfinite(pixels.position).all(axis=1)
    unknown = ~pixels.has_covariance & there
    if len(pixels) and not there.any():
        raise InputError(
            f"None of the {counted(len(pixels), 'pixel')} has a position: x_px or y_px is empty or NaN in "
            "all lines, so that nothing was measured. Give pixels of at least two cameras."
        )
    if pixel_sigma is None:
        if unknown.any():
            raise InputError(
                f"{unknown.sum()} of {counted(len(pixels), 'pixel')} have no covariance (var_xx, var_xy, "
                "var_yy), so that nobody could say how far off their points are. State the standard "
                "deviation of their x and y, in px: `pixel_sigma=0.1`."
            )
        return pixels
    if not unknown.any() and len(pixels):
        raise InputError(
            "All pixels have covariances of their own, so that `pixel_sigma` would be dropped. Leave it out."
        )
    covariance = np.where(unknown[:, None, None], pixel_sigma**2 * np.eye(2), pixels.covariance)
    return pixels.with_covariances(covariance)
