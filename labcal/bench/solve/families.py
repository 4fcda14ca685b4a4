"""Families of camera pairs on which methods are compared, each with its volume."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.lens import PRESCRIPTION
from labcal.cameras.prescription import load_prescription
from labcal.cameras.window import WATER, FlatWindow, Wave, WavyWindow
from labcal.geometry.poses import look_at
from labcal.rng import generator

SIZE = (1280, 960)
FOCAL_PX, FISHEYE_PX = 1000.0, 0.5 * SIZE[0] / np.radians(75.0)
"""The fisheye's picture is 150 degrees wide."""
WEBCAM = "webcam-doublet"
PLANES, COLS, ROWS = 4, 13, 10
_EYES_MM = ((650.0, 700.0, 2400.0), (1350.0, 700.0, 2400.0))
_LOOK_AT_MM = (1000.0, 1000.0, 500.0)
_NO_LENS = np.zeros(5)
_BROWN = np.array([-0.3, 0.09, 0.0006, -0.0004, 0.0])
_RATIONAL = np.array([-0.35, 0.12, 0.0006, -0.0004, 0.02, 0.3, 0.1, 0.02])
_FISHEYE = np.array([0.02, -0.004, 0.001, 0.0, 0.0])
_WAVES, _AMPLITUDE_PX, _PERIOD_PX = 3, 3.0, 300.0


@dataclass(frozen=True)
class Volume:
    """A box, mm."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    def planes(self) -> Vectors3:
        """Return the dots of four planes across z, the box's faces included, (520, 3)."""
        x, y = np.meshgrid(
            np.linspace(self.low[0], self.high[0], COLS), np.linspace(self.low[1], self.high[1], ROWS)
        )
        heights = np.linspace(self.low[2], self.high[2], PLANES)
        return np.concatenate([np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], axis=1) for z in heights])

    def points(self, count: int, random: np.random.Generator) -> Vectors3:
        """Return random points, (count, 3)."""
        return random.uniform(self.low, self.high, (count, 3))


TABLE = Volume((650.0, 650.0, 0.0), (1350.0, 1350.0, 1000.0))
"""The paper's volume, seen from 1.4 to 2.9 m."""
ROOM = Volume((-2500.0, -1500.0, 0.0), (4500.0, 3500.0, 1000.0))
"""Volume that fills the picture of a fisheye camera at the same place."""


@dataclass(frozen=True)
class Family:
    """One family of cameras.

    Attributes
    ----------
    camera : callable
        From the pose ``T_cam_world``, the seed and the camera's number to the true camera.
    volume : Volume
    right : mapping, optional
        Parameters of ``bundle`` that make it the right family; None where there is none.
    parametric : bool
        Whether one of the lens models that ``hybrid`` chooses among can be right.
    """

    name: str
    camera: Callable[[Pose, int, int], Camera]
    volume: Volume
    right: Mapping[str, str | float] | None
    parametric: bool

    def pair(self, seed: int) -> tuple[Camera, Camera]:
        """Return both cameras."""
        up = np.array([0.0, 1.0, 0.0])
        first, second = (look_at(np.array(eye), np.array(_LOOK_AT_MM), up) for eye in _EYES_MM)
        return self.camera(first, seed, 0), self.camera(second, seed, 1)


def _matrix(f: float) -> np.ndarray:
    return np.array([[f, 0.0, 640.3], [0.0, f, 478.2], [0.0, 0.0, 1.0]])


def _lens(name: str, dist: np.ndarray, f: float = FOCAL_PX) -> Callable[[Pose, int, int], Camera]:
    return lambda T_cam_world, _seed, _number: Camera(_matrix(f), name, dist, T_cam_world, SIZE)


def _webcam(T_cam_world: Pose, _seed: int, _number: int) -> Camera:
    glass = load_prescription(WEBCAM)
    return Camera(_matrix(FOCAL_PX), PRESCRIPTION, _NO_LENS, T_cam_world, SIZE, glass)


def _behind_waves(T_cam_world: Pose, seed: int, number: int) -> Camera:
    random = generator(seed, "bench solve", "waves", str(number))
    waves = []
    for _ in range(_WAVES):
        turn, direction, phase = random.uniform(0.0, 360.0, 3)
        amplitude = (
            float(_AMPLITUDE_PX * np.cos(np.radians(turn))),
            float(_AMPLITUDE_PX * np.sin(np.radians(turn))),
        )
        waves.append(
            Wave(
                amplitude_px=amplitude, period_px=_PERIOD_PX, direction_deg=float(direction), phase_deg=phase
            )
        )
    window = WavyWindow(waves=tuple(waves))
    return Camera(_matrix(FOCAL_PX), "pinhole", _NO_LENS, T_cam_world, SIZE, window=window)


def _in_water(T_cam_world: Pose, _seed: int, _number: int) -> Camera:
    window = FlatWindow(distance_mm=200.0, tilt_x_deg=30.0, behind_index=WATER)
    return Camera(_matrix(FOCAL_PX), "pinhole", _NO_LENS, T_cam_world, SIZE, window=window)


FAMILIES = (
    Family("pinhole", _lens("pinhole", _NO_LENS), TABLE, {"lens": "pinhole"}, parametric=True),
    Family("brown", _lens("brown5", _BROWN), TABLE, {"lens": "brown5"}, parametric=True),
    Family("rational", _lens("rational8", _RATIONAL), TABLE, {"lens": "rational8"}, parametric=True),
    Family(
        "fisheye",
        _lens("fisheye-kb4", _FISHEYE, FISHEYE_PX),
        ROOM,
        {"lens": "fisheye-kb4"},
        parametric=True,
    ),
    Family("webcam", _webcam, TABLE, {"lens": WEBCAM}, parametric=False),
    Family("wavy pane", _behind_waves, TABLE, None, parametric=False),
    Family("water", _in_water, TABLE, {"lens": "pinhole", "behind_index": WATER}, parametric=False),
)
