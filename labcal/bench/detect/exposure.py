"""The exposure of a picture of the suite: light gradient, sensor and file compression."""

import numpy as np

from labcal.arrays import Pixels
from labcal.bench.detect.design import BLUR, MOST_BLUR_PX, PictureDesign
from labcal.bench.detect.dot_visibility import LEAST_MINOR_PX, DotVisibility
from labcal.bench.held_board import BARE_BOARD
from labcal.render.development import develop
from labcal.render.film import Shading
from labcal.render.sensor_response import Exposure, Shot, read_sensor
from labcal.scene.photometry import Photometry
from labcal.shoot.luma import lossy_picture
from labcal.shoot.tone_curve import ToneCurve

WHITE = 0.8
"""Share of full scale of the brightest bare board."""
READ_NOISE = 0.1
"""Read noise over the noise of white."""


def blur_px(design: PictureDesign, minor_px: np.ndarray) -> float:
    """Return the standard deviation of the blur of a picture, px, by its smallest measurable dot."""
    large = minor_px[minor_px >= LEAST_MINOR_PX]
    smallest = float(large.min()) if len(large) else LEAST_MINOR_PX
    most = max(BLUR[0], min(MOST_BLUR_PX, BLUR[1] * smallest))
    return float(BLUR[0] + design.blur * (most - BLUR[0]))


def exposed_picture(light: np.ndarray, design: PictureDesign, seed: int) -> np.ndarray:
    """Return the picture, uint8, in grey or in red, green and blue; that of a JPEG file as its luma.

    Parameters
    ----------
    light : ndarray of float32, shape (height, width)
        Behind the lens.
    design : PictureDesign
    seed : int
    """
    photometry = _photometry(design)
    lit = np.repeat(light[..., None], 3, axis=-1) if design.bayer else light
    exposure = Exposure(WHITE / BARE_BOARD, (1.0, 1.0, 1.0))
    picture = develop(
        read_sensor(lit, photometry, exposure, Shot(seed, design.name, "suite")), photometry, exposure
    )
    if design.jpeg_quality is None:
        return picture
    return lossy_picture(picture, design.jpeg_quality)


def _photometry(design: PictureDesign) -> Photometry:
    """Return a sensor with the noise of the design where the board is brightest."""
    return Photometry(
        bayer=design.bayer,
        full_well_e=WHITE / design.noise**2,
        read_noise_e=READ_NOISE * WHITE / design.noise,
        tone_curve=ToneCurve.LINEAR if design.linear else ToneCurve.SRGB,
    )


def falling_light(design: PictureDesign, seen: DotVisibility) -> Shading:
    """Return the light of places, 1 at one end of the dots in the frame, falling exponentially to the other.

    Parameters
    ----------
    design : PictureDesign
        Its gradient and the direction of that.
    seen : DotVisibility
    """
    along = np.array([np.cos(design.gradient_direction), np.sin(design.gradient_direction)])
    places = seen.centroid[seen.in_frame] @ along
    first, last = (float(places.min()), float(places.max())) if len(places) else (0.0, 1.0)

    def light(q: Pixels) -> np.ndarray:
        share = np.clip((q @ along - first) / max(last - first, 1.0), 0.0, 1.0)
        return np.asarray(design.gradient**-share)

    return light
