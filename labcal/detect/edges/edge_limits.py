"""Settings of the edge fit as compiled code takes them."""

from typing import NamedTuple


class EdgeLimits(NamedTuple):
    """The settings of the edge fit that compiled code takes."""

    max_iterations: int
    shift_tolerance_px: float
    blur_tolerance_share: float
    max_step_radii: float
    max_blur_factor: float
    max_move_radii: float
    min_blur_px: float
    edge_blurs: float
    edge_px: float
    band_blurs: float
    band_px: float
    band_radii: float
    max_bands: int
    reband_factor: float
    hole_blurs: float
    clutter_sigma: float
    clutter_share: float
    clutter_px: float
    prior_shading_share: float
    prior_third_harmonic_per_px: float
    near_flat_blurs: float


class PictureLimits(NamedTuple):
    """Limits that hold for a whole picture: see :func:`~labcal.detect.edges.gauss_newton.fit_all`."""

    reach_radii: float
    clipped_black: float
    clipped_white: float
    black: float
    noise_every: int
    outlines_every: int
