"""Stated covariances of dots in developed pictures: grey or through a mosaic, as they are or through JPEG."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from labcal.arrays import PixelCovariances, Pixels
from labcal.bench.detect.accuracy import SIGMAS, chi_square_z, over_bound
from labcal.bench.detect.lit_board import LitBoard, lit_board
from labcal.bench.groups import Bench, Findings
from labcal.detect.detector import detect_dots
from labcal.geometry.ellipsoids import within_ellipsoids
from labcal.render.development import develop
from labcal.render.sensor_response import Exposure, Shot, read_sensor
from labcal.report.bench import Check, Figure, at_most
from labcal.rng import generator
from labcal.scene.photometry import Photometry
from labcal.shoot.luma import lossy_picture

RADII_PX = (6.0, 10.0, 20.0)
TILTS_DEG, QUICK_TILTS_DEG = (5.0, 25.0, 45.0, 60.0), (10.0, 60.0)
SPP, QUICK_SPP = 512, 256
DOTS = 200
"""About so many measurements for every radius, tilt and kind of picture, by taking the picture again."""
MOST_SHIFT_PX = 16
"""A picture is taken again from up to so many pixels aside: elsewhere on the mosaic and on JPEG's blocks."""
MOST_OFF = 0.15
"""Of the root of the mean normalised error from 1."""


@dataclass(frozen=True)
class PictureKind:
    """A kind of picture."""

    name: str
    bayer: bool
    jpeg_quality: int | None


@dataclass(frozen=True)
class SensorNoise:
    """The noise of a sensor, electrons."""

    name: str
    full_well_e: float
    read_noise_e: float | None
    """None: no noise at all."""


KINDS = (
    PictureKind("grey", bayer=False, jpeg_quality=None),
    PictureKind("grey, JPEG of quality 90", bayer=False, jpeg_quality=90),
    PictureKind("grey, JPEG of quality 75", bayer=False, jpeg_quality=75),
    PictureKind("Bayer", bayer=True, jpeg_quality=None),
    PictureKind("Bayer, JPEG of quality 95", bayer=True, jpeg_quality=95),
    PictureKind("Bayer, JPEG of quality 85", bayer=True, jpeg_quality=85),
    PictureKind("Bayer, JPEG of quality 75", bayer=True, jpeg_quality=75),
)
NOISES = (
    SensorNoise("no noise", 6000.0, None),
    SensorNoise("usual noise", 6000.0, 8.0),
    SensorNoise("strong noise", 2000.0, 60.0),
)


def developed_findings(bench: Bench) -> Findings:
    """Return how far normalised errors are off chi-square, by kind of picture and noise, over all radii."""
    tilts, spp = (QUICK_TILTS_DEG, QUICK_SPP) if bench.quick else (TILTS_DEG, SPP)
    bench.progress.start("developed", len(RADII_PX) * len(tilts))
    parts: dict[tuple[str, str, float], list[tuple[Pixels, PixelCovariances]]] = {}
    for radius, tilt in product(RADII_PX, tilts):
        board = lit_board(radius, tilt, spp, bench.seed)
        for kind, noise in product(KINDS, NOISES):
            part = stated_errors(board, kind, noise, bench.seed)
            parts.setdefault((kind.name, noise.name, radius), []).append(part)
        bench.progress.advance()
    checks: list[Check] = []
    figures: list[Figure] = []
    for kind, noise in product(KINDS, NOISES):
        for radius in RADII_PX:
            errors, covariance = (
                np.concatenate(some) for some in zip(*parts[kind.name, noise.name, radius], strict=True)
            )
            name = f"{kind.name}, {noise.name}, dots of {radius:g} px"
            checks += covariance_checks(name, errors, covariance)
            figures += covariance_figures(name, errors, covariance)
    return Findings(checks, figures)


def stated_errors(
    board: LitBoard, kind: PictureKind, noise: SensorNoise, seed: int
) -> tuple[Pixels, PixelCovariances]:
    """Return errors (px), shape (n, 2), and stated covariances, (n, 2, 2), of a board's measured dots.

    Parameters
    ----------
    board : LitBoard
    kind : PictureKind
    noise : SensorNoise
    seed : int
    """
    name = f"{board.name}, {kind.name}, {noise.name}"
    random = generator(seed, "bench detect", "developed", name)
    errors, covariances = [], []
    for draw in range(max(1, round(DOTS / max(1, len(board.number))))):
        right, down = (int(pixels) for pixels in random.integers(MOST_SHIFT_PX, size=2))
        light = np.pad(board.clean.astype(np.float32), ((down, 0), (right, 0)), mode="edge")
        dots = detect_dots(taken_picture(light, kind, noise, Shot(seed, name, f"draw {draw}")), board.target)
        number = dots.index[:, 1] * board.target.cols + dots.index[:, 0]
        place = {int(one): at for at, one in enumerate(board.number)}
        for dot in np.flatnonzero(dots.ok):
            at = place.get(int(number[dot]))
            if at is not None:
                errors.append(dots.position[dot] - board.centroid[at] - [right, down])
                covariances.append(dots.covariance[dot])
    return np.reshape(errors, (-1, 2)), np.reshape(covariances, (-1, 2, 2))


def taken_picture(light: np.ndarray, kind: PictureKind, noise: SensorNoise, shot: Shot) -> np.ndarray:
    """Return the picture that a camera delivers of light, with the tone curve of sRGB, uint8.

    Parameters
    ----------
    light : ndarray of float32, shape (height, width)
        As a share of full scale.
    kind : PictureKind
    noise : SensorNoise
    shot : Shot
        What noise is drawn for.
    """
    photometry = Photometry(
        bayer=kind.bayer,
        full_well_e=noise.full_well_e,
        read_noise_e=noise.read_noise_e or 0.0,
        black_level_dn=0.0,
    )
    exposure = Exposure(1.0, (1.0, 1.0, 1.0))
    behind = np.repeat(light[..., None], 3, axis=-1) if kind.bayer else light
    codes = read_sensor(behind, photometry, exposure, None if noise.read_noise_e is None else shot)
    picture = develop(codes, photometry, exposure)
    if kind.jpeg_quality is None:
        return picture
    return lossy_picture(picture, kind.jpeg_quality)


def covariance_checks(name: str, errors: Pixels, covariance: PixelCovariances) -> list[Check]:
    """Return how far the root of the mean normalised error is from 1.

    Parameters
    ----------
    name : str
    errors : ndarray, shape (n, 2)
        px.
    covariance : ndarray, shape (n, 2, 2)
        As stated, px squared.
    """
    off = abs(over_bound(errors, covariance) - 1.0)  # NaN, which is not ok, where there is no dot
    return [at_most(f"{name}: RMS error over what labcal says of it, off 1", off, MOST_OFF)]


def covariance_figures(name: str, errors: Pixels, covariance: PixelCovariances) -> list[Figure]:
    """Return RMS errors, stated ones, the share in 95% ellipses, and the deviation from chi-square.

    Parameters
    ----------
    name : str
    errors : ndarray, shape (n, 2)
        px.
    covariance : ndarray, shape (n, 2, 2)
        As stated, px squared.
    """
    squares = np.einsum("ni,ni->n", errors, np.linalg.solve(covariance, errors[..., None])[..., 0])
    stated = float(np.sqrt(np.trace(covariance, axis1=1, axis2=2).mean() / 2.0))
    share = float(within_ellipsoids(errors, covariance, 0.95).mean()) if len(errors) else float("nan")
    return [
        Figure(name=f"{name}: RMS error of a coordinate, px", value=float(np.sqrt((errors**2).mean()))),
        Figure(name=f"{name}: the same as stated, px", value=stated),
        Figure(name=f"{name}: share within the 95% ellipse", value=share),
        Figure(
            name=f"{name}: normalised errors off chi-square, standard deviations (grey: {SIGMAS:.1f})",
            value=chi_square_z(float(squares.sum()), 2 * len(errors)),
        ),
    ]
