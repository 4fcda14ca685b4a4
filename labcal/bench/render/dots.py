"""Errors of grey-value centroids of rendered dots, under light without noise."""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from labcal.arrays import Pose
from labcal.bench.held_board import board_scene, still_take, tilted_pose
from labcal.bench.render.optics import OPTICS, description
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.variant import MONO, renderer
from labcal.report.bench import Check, at_most
from labcal.rng import generator
from labcal.run.progress import Progress
from labcal.scene.model import Scene
from labcal.scene.print import TruePrint
from labcal.scene.take import Take
from labcal.scene.truth import true_dots
from labcal.shoot.truth import TrueDots
from labcal.targets.grid import DotGrid, Rings

SPP = 256
SIZE = (640, 480)
RADII_PX = (5.0, 7.0, 10.0, 20.0, 40.0)
LIMITS_PX = {5.0: 0.008, 7.0: 0.008}
"""From a radius of 10 px on it is 0.004 px."""
LIMIT_PX = 0.004
SIGMAS = 3.0
TILTS_DEG = (0.0, 25.0, 45.0, 60.0)
AWAY_MM = 700.0
PITCH_OVER_RADIUS = 5.0
GAP_PX = 2.0
"""Pixels around a dot's outline that its centroid takes in."""
LEAST_SHARE = 0.6
"""A tilted board reaches far back; dots whose mean radius there is below this share are another size."""


def dot_checks(seed: int, tilts: tuple[float, ...], progress: Progress) -> list[Check]:
    """Return RMS and mean of grey centroid minus true centroid, by lens and radius.

    Parameters
    ----------
    seed : int
    tilts : tuple of float
        Angles between the board's normal and the camera's axis, degrees.
    progress : Progress
        Notified of every picture.
    """
    progress.start("dots", len(OPTICS) * len(RADII_PX) * len(tilts))
    checks = []
    for name in OPTICS:
        all_errors = []
        for radius in RADII_PX:
            errors = np.concatenate(list(_errors(name, radius, tilts, seed, progress)))
            all_errors.append(errors)
            rms = float(np.sqrt((errors**2).sum(axis=1).mean()))
            limit = LIMITS_PX.get(radius, LIMIT_PX)
            checks.append(at_most(f"dots of {radius:g} px through {name}, RMS error, px", rms, limit))
        every = np.concatenate(all_errors)
        z = np.abs(every.mean(axis=0)) / (every.std(axis=0) / np.sqrt(len(every)))
        checks.append(at_most(f"dots through {name}, mean error, standard errors", float(z.max()), SIGMAS))
    return checks


def _errors(
    name: str, radius: float, tilts: tuple[float, ...], seed: int, progress: Progress
) -> Iterator[np.ndarray]:
    """Yield the errors (n, 2) of every picture of one lens and radius."""
    scene = _scene(name, radius)
    made = TruePrint.of(scene.target, scene.board, seed)
    with renderer(MONO) as mi:
        laboratories = Laboratories(mi, scene, seed)
        for tilt in tilts:
            random = generator(seed, "bench dots", name, f"{radius:g} px", f"{tilt:g} degrees")
            take = still_take(scene, _turned(scene.grid, tilt, random))
            seen = true_dots(scene, made, take)
            light = render_light(laboratories, Case(take, seed))
            yield grey_errors(light / np.float32(scene.board.light[0]), _whole(scene, take, seen, radius))
            progress.advance()


def _scene(name: str, radius_px: float) -> Scene:
    """Return a board square to a camera, with dots of a radius in the middle of the picture, evenly lit."""
    camera = description(name, SIZE, {"eye_mm": (0.0, 0.0, AWAY_MM), "look_at_mm": (0.0, 0.0, 0.0)})
    px_per_mm = camera.focal_px / AWAY_MM
    radius = radius_px / px_per_mm
    pitch = PITCH_OVER_RADIUS * radius
    half_width = 1.6 * 0.5 * SIZE[0] / px_per_mm
    cols, rows = max(6, int(2 * half_width / pitch)), max(6, int(1.8 * half_width / pitch))
    target = DotGrid(
        name="bench",
        cols=cols,
        rows=rows,
        pitch_x_mm=pitch,
        pitch_y_mm=pitch,
        dot_diameter_mm=2.0 * radius,
        ring_outer_diameter_mm=2.0 * radius,
        ring_inner_diameter_mm=0.5 * radius,
        rings=Rings(origin=(1, 1), x=(4, 1), y=(1, 3)),
        margin_mm=0.5 * pitch,
    )
    return board_scene(target, camera, SPP)


def _turned(target: DotGrid, tilt_deg: float, random: np.random.Generator) -> Pose:
    """Return a pose with the board's middle before the camera, tilted and turned at random, off the grid."""
    azimuth, roll = random.uniform(-np.pi, np.pi, 2)
    aside = np.array([*(0.5 * target.pitch_x_mm * random.uniform(-1.0, 1.0, 2)), 0.0])
    return tilted_pose(target, tilt_deg, azimuth, roll, aside)


@dataclass(frozen=True)
class _Whole:
    """Dots that are measured: their true centroids and the windows that hold them."""

    centroid: np.ndarray
    """(n, 2), px."""
    outline: np.ndarray
    """(n, samples, 2), px."""


def _whole(scene: Scene, take: Take, seen: TrueDots, radius_px: float) -> _Whole:
    """Return the dots that are whole in the picture with room around them; no rings."""
    outline = take.project(TruePrint.of(scene.target, scene.board, 0).outlines).q
    room = (outline >= GAP_PX).all(axis=(1, 2))
    room &= (outline <= np.array(take.device.size) - 1 - GAP_PX).all(axis=(1, 2))
    ring = np.zeros(scene.target.count, dtype=bool)
    for col, row in scene.grid.ring_indices:
        ring[row * scene.target.cols + col] = True
    edge = (seen.index == 0).any(axis=1) | (seen.index == [scene.target.cols - 1, scene.target.rows - 1]).any(
        axis=1
    )
    mean_radius = np.linalg.norm(outline - seen.centroid[:, None], axis=-1).mean(axis=1)
    keep = seen.visible & room & ~ring & ~edge & (mean_radius >= LEAST_SHARE * radius_px)
    return _Whole(seen.centroid[keep], outline[keep])


def grey_errors(light: np.ndarray, dots: _Whole) -> np.ndarray:
    """Return grey centroids minus true ones, px, shape (n, 2).

    Parameters
    ----------
    light : ndarray, shape (height, width)
        1 where there is bare board.
    dots : _Whole
    """
    errors = np.empty_like(dots.centroid)
    for number, (centroid, outline) in enumerate(zip(dots.centroid, dots.outline, strict=True)):
        away = outline - centroid
        # Beyond the outline by the gap, and not a window, which would hold parts of tilted neighbours.
        wider = centroid + away * (1.0 + GAP_PX / np.linalg.norm(away, axis=1, keepdims=True))
        low, high = np.floor(wider.min(axis=0)).astype(int), np.ceil(wider.max(axis=0)).astype(int) + 1
        here = np.zeros((high - low)[::-1], dtype=np.uint8)
        cv2.fillPoly(here, [np.rint(wider - low).astype(np.int32)], 1)
        weight = here * (1.0 - light[low[1] : high[1], low[0] : high[0]].astype(np.float64))
        u, v = np.arange(low[0], high[0]), np.arange(low[1], high[1])
        errors[number] = np.array([weight.sum(axis=0) @ u, weight.sum(axis=1) @ v]) / weight.sum() - centroid
    return errors
