"""The picture of a board before noise, rendered once, with the Cramer-Rao bound of each of its dots."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import PixelCovariances, Pixels
from labcal.bench.detect.bound import ImagedDot, centre_bound, outline_shapes
from labcal.bench.detect.design import LENSES, SIZES, PictureDesign
from labcal.bench.detect.dot_visibility import DotVisibility, dot_visibility
from labcal.bench.detect.exposure import WHITE, falling_light
from labcal.bench.detect.suite_scene import suite_scene
from labcal.bench.held_board import BARE_BOARD, blurred_scene
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.variant import MONO, renderer
from labcal.rng import generator
from labcal.scene.board import Board
from labcal.scene.print import TruePrint
from labcal.targets.grid import DotGrid, Polarity

BLUR_PX = 0.7
GRADIENT = 2.0
PITCH_OVER_RADIUS = 4.0
MOST_DOTS = 60
"""Of a board; the others are not looked at."""
WIDTH_OVER_RADIUS = 60.0
"""Of the picture, so that enough dots are in it."""
REACH = 0.5 * (1.0 + 0.5 * PITCH_OVER_RADIUS)
"""A dot's own pixels, as a multiple of its outline: half-way to the outline of the next dot."""


@dataclass(frozen=True)
class LitBoard:
    """The picture of a board before noise, and the true values of the dots that count."""

    name: str
    target: DotGrid
    clean: np.ndarray
    """(height, width), as a share of full scale."""
    number: np.ndarray
    """(n,), which dots count, by row and column: those that can be measured, without the rings."""
    centroid: Pixels
    """(n, 2), px."""
    shape: PixelCovariances
    """(n, 2, 2), S of their outlines, px squared."""
    unit_bound: PixelCovariances
    """(n, 2, 2), the bound for noise of full scale in every pixel, px squared."""


def lit_board(radius_px: float, tilt_deg: float, spp: int, seed: int) -> LitBoard:
    """Render a board in falling light, blurred, and compute the bound of every dot.

    Parameters
    ----------
    radius_px : float
        Of a dot in the board's middle.
    tilt_deg : float
    spp : int
        Rays a pixel; so many that their noise is small against that which is measured under.
    seed : int
        Lens, direction of the tilt and of the gradient are drawn from it.
    """
    design = _design(radius_px, tilt_deg, seed)
    stage = suite_scene(design, seed)
    scene, made = stage.scene, TruePrint.of(stage.scene.target, stage.scene.board, seed)
    seen = dot_visibility(scene, stage.take, 4.0 * BLUR_PX)
    with renderer(MONO) as mi:
        laboratories = Laboratories(mi, blurred_scene(scene.with_spp(spp), BLUR_PX), seed)
        light = render_light(laboratories, Case(stage.take, seed), falling_light(design, seen))
    number = np.flatnonzero(seen.measurable & ~seen.ring)
    number = np.sort(generator(seed, design.name, "dots").permutation(number)[:MOST_DOTS])
    shape = outline_shapes(stage.take.project(made.outlines).q[number])
    bounds = [
        centre_bound(_imaged(design, seen, int(one), S), 1.0) for one, S in zip(number, shape, strict=True)
    ]
    return LitBoard(
        name=design.name,
        target=scene.grid,
        clean=WHITE / BARE_BOARD * light.astype(np.float64),
        number=number,
        centroid=seen.centroid[number],
        shape=shape,
        unit_bound=np.array(bounds),
    )


def _design(radius: float, tilt: float, seed: int) -> PictureDesign:
    """Return the picture of one radius and tilt."""
    random = generator(seed, "bench detect", "accuracy", f"{radius:g} px", f"{tilt:g} degrees")
    azimuth, roll, gradient_direction = random.uniform(-np.pi, np.pi, 3).tolist()
    aside_x, aside_y = random.uniform(-0.02, 0.02, 2).tolist()
    return PictureDesign(
        name=f"accuracy-{radius:g}-{tilt:g}",
        lens=LENSES[int(random.integers(len(LENSES)))],
        size=next((size for size in SIZES if size[0] >= WIDTH_OVER_RADIUS * radius), SIZES[-1]),
        tilt_deg=tilt,
        radius_px=radius,
        pitch_over_radius=PITCH_OVER_RADIUS,
        polarity=Polarity.BLACK_ON_WHITE,
        azimuth=azimuth,
        roll=roll,
        aside=(aside_x, aside_y),
        gradient=GRADIENT,
        gradient_direction=gradient_direction,
        noise=0.0,
        blur=0.0,
        jpeg_quality=None,
        bayer=False,
        linear=True,
        hidden=0.0,
        rings_in_sight=True,
    )


def _imaged(design: PictureDesign, seen: DotVisibility, number: int, shape: np.ndarray) -> ImagedDot:
    """Return the parameters of the image of a dot, as shares of full scale."""
    along = np.array([np.cos(design.gradient_direction), np.sin(design.gradient_direction)])
    places, own = seen.centroid[seen.in_frame] @ along, float(seen.centroid[number] @ along)
    share = float(np.clip((own - places.min()) / (places.max() - places.min()), 0.0, 1.0))
    light = float(WHITE * design.gradient**-share)
    dark = light * Board().dark[0] / BARE_BOARD
    return ImagedDot(seen.centroid[number], shape, BLUR_PX, dark, light, REACH)
