"""Design of the pictures of the suite: a Latin hypercube over all difficulties of detection."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from labcal.rng import generator
from labcal.targets.grid import Polarity

LENSES = ("pinhole", "brown-k1k2", "fisheye-kb4")
SIZES = ((640, 480), (960, 720), (1280, 960))
TILT_DEG = (0.0, 70.0)
RADIUS_PX = (4.0, 60.0)
LEAST_MINOR_PX = 4.0
"""A tilted dot of the board's middle is no flatter than this, so that most of the board can be measured."""
RADIUS_OVER_WIDTH = 1.0 / 24.0
"""Larger dots need a wider picture."""
GRADIENT = (1.0, 10.0)
NOISE = (0.008, 0.05)
BLUR = (0.35, 0.35)
"""Least, in px, and greatest, as a share of the smallest measurable dot's minor semi-axis."""
MOST_BLUR_PX = 3.0
JPEG_QUALITY = (40.0, 100.0)
HIDDEN = (0.0, 0.5)
PITCH_OVER_RADIUS = (3.2, 5.0)
ASIDE = 0.12
"""Displacement of the middle of the board from that of the picture, as a share of its size."""
SHARES_PNG, SHARES_BARE, SHARES_BAYER, SHARES_RINGS = 0.25, 0.25, 0.25, 0.8
"""Shares of pictures without compression, with nothing hidden, in colour, and with all rings visible."""
_COLUMNS = 19

Choice = TypeVar("Choice")


@dataclass(frozen=True)
class PictureDesign:
    """Design of one picture; hidden share and number of dots are approximate."""

    name: str
    lens: str
    size: tuple[int, int]
    tilt_deg: float
    radius_px: float
    """Root of the product of the semi-axes of a dot in the board's middle, px."""
    pitch_over_radius: float
    polarity: Polarity
    azimuth: float
    """Direction of the tilt's axis, rad."""
    roll: float
    aside: tuple[float, float]
    """The board's middle off the picture's, in shares of width and height."""
    gradient: float
    """Brightest over darkest light on the board."""
    gradient_direction: float
    """Rad."""
    noise: float
    """Standard deviation of white as a share of full scale, before the tone curve; photon noise."""
    blur: float
    """From 0, the least, to 1, the greatest."""
    jpeg_quality: int | None
    """None: no compression."""
    bayer: bool
    linear: bool
    """True if values are linear in light; otherwise sRGB."""
    hidden: float
    """Share of the dots that something should hide."""
    rings_in_sight: bool
    """True if the three rings should be visible."""


def designs(count: int, seed: int) -> Iterator[PictureDesign]:
    """Yield the designs of the pictures of a suite.

    Each quantity's range is cut into as many strata as there are pictures, and each stratum is drawn from
    once, in an order of its own (McKay, Beckman and Conover 1979).

    Parameters
    ----------
    count : int
    seed : int
    """
    random = generator(seed, "bench detect", "suite")
    strata = np.stack([random.permutation(count) for _ in range(_COLUMNS)], axis=1)
    for number, row in enumerate((strata + random.uniform(size=strata.shape)) / count):
        yield _design(f"picture-{number:03d}", iter(row.tolist()))


def _design(name: str, share: Iterator[float]) -> PictureDesign:
    """Return a design from numbers between 0 and 1."""
    tilt = _between(TILT_DEG, next(share))
    flatness = float(np.sqrt(np.cos(np.radians(tilt))))
    radius = _geometric((max(RADIUS_PX[0], LEAST_MINOR_PX / flatness), RADIUS_PX[1]), next(share))
    sizes = [size for size in SIZES if radius <= RADIUS_OVER_WIDTH * size[0] * 1.001]
    bare = next(share)
    compressed = next(share)
    return PictureDesign(
        name=name,
        lens=_one_of(LENSES, next(share)),
        size=_one_of(tuple(sizes) or SIZES[-1:], next(share)),
        tilt_deg=tilt,
        radius_px=radius,
        pitch_over_radius=_between(PITCH_OVER_RADIUS, next(share)),
        polarity=_one_of(tuple(Polarity), next(share)),
        azimuth=_between((-np.pi, np.pi), next(share)),
        roll=_between((-np.pi, np.pi), next(share)),
        aside=(_between((-ASIDE, ASIDE), next(share)), _between((-ASIDE, ASIDE), next(share))),
        gradient=_geometric(GRADIENT, next(share)),
        gradient_direction=_between((-np.pi, np.pi), next(share)),
        noise=_geometric(NOISE, next(share)),
        blur=next(share),
        jpeg_quality=None
        if compressed < SHARES_PNG
        else round(_between(JPEG_QUALITY, (compressed - SHARES_PNG) / (1.0 - SHARES_PNG))),
        bayer=next(share) < SHARES_BAYER,
        linear=next(share) < 0.5,  # noqa: PLR2004 -- one half
        hidden=0.0 if bare < SHARES_BARE else _between(HIDDEN, (bare - SHARES_BARE) / (1.0 - SHARES_BARE)),
        rings_in_sight=next(share) < SHARES_RINGS,
    )


def _between(ends: tuple[float, float], share: float) -> float:
    """Return a number from a range, uniformly."""
    return float(ends[0] + share * (ends[1] - ends[0]))


def _geometric(ends: tuple[float, float], share: float) -> float:
    """Return a number from a range, uniformly in its logarithm."""
    return float(ends[0] * (ends[1] / ends[0]) ** share)


def _one_of(choices: tuple[Choice, ...], share: float) -> Choice:
    """Return one of several values, each for a part of the range."""
    return choices[min(int(share * len(choices)), len(choices) - 1)]
