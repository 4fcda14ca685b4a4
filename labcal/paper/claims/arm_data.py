"""The points of an arm from a seed: what is trained, and what is tested."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.paper.claims.plan import Arm, ArmData, ArmNoise
from labcal.paper.problem import Problem
from labcal.paper.rows import SCENES, Data
from labcal.paper.simulated import (
    FOCAL_LENGTH_MM,
    FOCAL_RATIO,
    HEIGHT_MM,
    HIGH_MM,
    LOW_MM,
    NOISE,
    PIXEL_MM,
    TESTS,
    NoiseReading,
    box,
    cameras,
    grid,
    image_coordinates,
    noise_sigma,
)
from labcal.rng import generator
from labcal.scene.catalogue import load_scene
from labcal.scene.views import planned_views
from labcal.shoot.manifest import Role

_SIZE = (2000, 2000)
"""Picture of the exact cameras, px: large enough for every point."""
_MOST_DRAWS = 20


@dataclass(frozen=True)
class ArmProblem:
    """Training and test data, and what an oracle knows about them.

    Attributes
    ----------
    problem : Problem
        Image coordinates and points in mm; further outputs in mm, too.
    cameras : tuple of Camera
        The exact cameras, whose pixels are the inputs.
    sigma_px : ndarray, shape (inputs,)
        Standard deviation of the noise of every input.
    """

    problem: Problem
    cameras: tuple[Camera, ...]
    sigma_px: np.ndarray

    @property
    def image_sizes(self) -> tuple[tuple[int, int], ...]:
        """Width and height of the cameras' pictures, px."""
        return tuple(camera.size for camera in self.cameras)


def arm_problem(arm: Arm, seed: int) -> ArmProblem:
    """Return the data of an arm that needs no pictures.

    Arms of the same data share their points and the draws of their noise at one seed; an arm of fewer random
    points has the first of them.

    Parameters
    ----------
    arm : Arm
    seed : int

    Raises
    ------
    InputError
        The arm needs pictures.
    """
    match arm.data:
        case ArmData.PLANE | ArmData.VOLUME:
            return _paper_points(arm, seed)
        case ArmData.FOCAL_LENGTHS:
            return _focal_lengths(arm, seed)
        case ArmData.POSITIONS:
            return _positions(arm, seed)
        case ArmData.DISTORTED_VOLUME:
            return _distorted_volume(arm, seed)
    raise InputError(f"Data '{arm.data}' come from pictures, which must be rendered first.")


def _paper_points(arm: Arm, seed: int) -> ArmProblem:
    """Return points of the plane or the volume, seen by the cameras of the paper, in px."""
    data = Data.PLANE if arm.data is ArmData.PLANE else Data.VOLUME_RANDOM
    low, high = box(data)
    if arm.data is ArmData.PLANE and arm.placed == "grid":
        trained = grid(data, arm.points)
    else:
        trained = _stream(arm, seed, "trained").uniform(low, high, (arm.points, 3))
    tested = _stream(arm, seed, "tested").uniform(low, high, (TESTS, 3))
    pair = cameras(FOCAL_LENGTH_MM)
    X, X_test = (image_coordinates(pair, p) / PIXEL_MM for p in (trained, tested))
    exact = tuple(camera.camera(PIXEL_MM, (0.0, 0.0), _SIZE) for camera in pair)
    return _with_noise(arm, seed, Problem(X, trained, X_test, tested), exact)


def _focal_lengths(arm: Arm, seed: int) -> ArmProblem:
    """Return points of a plane seen by two models of camera; the two focal lengths are further outputs.

    Tested are both models, or one whose focal length lies half-way between theirs.
    """
    low, high = box(Data.FOCAL_LENGTHS)
    lengths = (FOCAL_LENGTH_MM, FOCAL_RATIO * FOCAL_LENGTH_MM)
    tested_lengths = lengths if arm.tested == "trained" else (float(np.mean(lengths)),)
    points = _stream(arm, seed, "tested").uniform(low, high, (TESTS, 3))
    trained = [_seen_with(f, grid(Data.FOCAL_LENGTHS, arm.points)) for f in lengths]
    tested = [
        _seen_with(f, part)
        for f, part in zip(tested_lengths, np.array_split(points, len(tested_lengths)), strict=True)
    ]
    (X, Y), (X_test, Y_test) = _joined(trained), _joined(tested)
    return _with_noise(arm, seed, Problem(X, Y, X_test, Y_test), ())


def _joined(parts: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Return image coordinates and outputs of several parts, one below the other."""
    X, Y = zip(*parts, strict=True)
    return np.concatenate(X), np.concatenate(Y)


def _seen_with(focal_length_mm: float, p: Vectors3) -> tuple[np.ndarray, np.ndarray]:
    """Return the image coordinates of points, px, and their outputs, mm."""
    X = image_coordinates(cameras(focal_length_mm), p) / PIXEL_MM
    return X, np.column_stack([p, np.full((len(p), 2), focal_length_mm)])


def _positions(arm: Arm, seed: int) -> ArmProblem:
    """Return every fifth dot at each of five places along the slide; the cameras' distance is an output.

    The pixels are those of the exact cameras of the scene: noise is known, and a seed costs no pictures.
    Tested are random points of the board at the trained places, or half-way between them.
    """
    scene = load_scene(SCENES[Data.STILL_POSITIONS])
    pair = tuple(camera.camera() for camera in scene.cameras.values())
    heights = np.array(
        [view.T_world_target[2, 3] for view in planned_views(scene, 0) if view.role is Role.TRAIN]
    )
    origin = next(view.T_world_target[:3, 3] for view in planned_views(scene, 0))
    dots = scene.target.points() + np.array([*origin[:2], 0.0])
    chosen = [dots[k :: len(heights)] for k in range(len(heights))]
    count = sum(map(len, chosen))
    if count != arm.points:
        raise InputError(f"The board has {count} dots, but the arm asks for {arm.points} points.")
    places = heights if arm.tested == "trained" else (heights[:-1] + heights[1:]) / 2
    inside = _stream(arm, seed, "tested").uniform(dots.min(axis=0), dots.max(axis=0), (TESTS, 3))
    trained = [_at_height(pair, part, z, heights.max()) for part, z in zip(chosen, heights, strict=True)]
    tested = [
        _at_height(pair, part, z, heights.max())
        for part, z in zip(np.array_split(inside, len(places)), places, strict=True)
    ]
    (X, Y), (X_test, Y_test) = _joined(trained), _joined(tested)
    return _with_noise(arm, seed, Problem(X, Y, X_test, Y_test), pair)


def _at_height(
    pair: Sequence[Camera], p: Vectors3, height_mm: float, reference_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return pixels of board points at a height of the stage, and their outputs in the board's frame, mm."""
    X = _pixels(pair, p + np.array([0.0, 0.0, height_mm]))
    distance = np.full(len(p), reference_mm - height_mm)
    return X, np.column_stack([p[:, :2], np.full(len(p), reference_mm), distance])


def _distorted_volume(arm: Arm, seed: int) -> ArmProblem:
    """Return random points of the volume before the webcams, with radial distortion k1 alone."""
    scene = load_scene(SCENES[Data.WEBCAM_VOLUME])
    pair = tuple(
        camera.model_copy(update={"lens": "brown5", "dist": (arm.k1, 0.0, 0.0, 0.0, 0.0)}).camera()
        for camera in scene.cameras.values()
    )
    X, trained = _visible(pair, _stream(arm, seed, "trained"), arm.points)
    X_test, tested = _visible(pair, _stream(arm, seed, "tested"), TESTS)
    return _with_noise(arm, seed, Problem(X, trained, X_test, tested), pair)


def _visible(pair: Sequence[Camera], random: np.random.Generator, count: int) -> tuple[np.ndarray, Vectors3]:
    """Return random points that both cameras see, and their pixels."""
    low, high = np.array([LOW_MM, LOW_MM, 0.0]), np.array([HIGH_MM, HIGH_MM, HEIGHT_MM])
    p = random.uniform(low, high, (_MOST_DRAWS * count, 3))
    within = np.all([camera.in_picture(camera.project(p).q) for camera in pair], axis=0)
    seen = p[np.flatnonzero(within)[:count]]
    return _pixels(pair, seen), seen


def _pixels(pair: Sequence[Camera], p: Vectors3) -> np.ndarray:
    """Return x1 y1 x2 y2, px."""
    return np.concatenate([camera.project(p).q for camera in pair], axis=1)


def _with_noise(arm: Arm, seed: int, exact: Problem, pair: tuple[Camera, ...]) -> ArmProblem:
    """Return the data with noise on trained and tested image coordinates alike."""
    sigma = np.full(exact.X.shape[1], NOISE if arm.noise is ArmNoise.PIXEL else 0.0)
    if arm.noise is ArmNoise.SPREAD:
        sigma = noise_sigma(exact.X, NoiseReading.SPREAD)
    X, X_test = (
        values + sigma * _stream(arm, seed, part, "noise").standard_normal(values.shape)
        for part, values in (("trained", exact.X), ("tested", exact.X_test))
    )
    return ArmProblem(Problem(X, exact.Y, X_test, exact.Y_test), pair, sigma)


def _stream(arm: Arm, seed: int, *names: str) -> np.random.Generator:
    """Return random numbers that depend on the data and the seed only."""
    return generator(seed, "claim", arm.data, *names)
