"""A target in front of two known cameras in many views, for timing of the bundle adjustment."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.state import RigState, moved_poses
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.geometry.poses import pose
from labcal.rng import generator
from labcal.targets.grid import DotGrid

SIZE = (1280, 960)
NOISE_PX = 0.05
TARGET = DotGrid(
    name="held",
    cols=13,
    rows=10,
    pitch_x_mm=30.0,
    pitch_y_mm=30.0,
    dot_diameter_mm=10.0,
    rings=None,
    margin_mm=20.0,
)
CAMERAS = ("left", "right")
_MIDDLE, _FOCAL_PX, _TILT = (639.5, 479.5), (1100.0, 1122.0), 0.35
_DIST = ((-0.25, 0.08, 4e-4, -3e-4, -0.01), (-0.22, 0.06, -3e-4, 2e-4, -0.005))
_NEAREST_MM, _FARTHEST_MM = (-120.0, -120.0, 800.0), (160.0, 120.0, 1300.0)
_OFF = np.array([2e-3, 2e-3, 2e-3, 1.0, 1.0, 1.0])
"""By how much poses are off at the start: rad, mm."""


@dataclass(frozen=True)
class HeldRig:
    """The truth, and the simulated measurements."""

    truth: RigState
    observations: Observations
    """Images of centres with noise, to float32, which is what OpenCV takes."""

    @classmethod
    def drawn(cls, views: int, seed: int) -> "HeldRig":
        """Return views in each of which both cameras see the whole target."""
        random = generator(seed, "bench solve", "held rig")
        cameras = _cameras()
        poses: list[Pose] = []
        while len(poses) < views:
            T = _held(random)
            p = TARGET.points() @ T[:3, :3].T + T[:3, 3]
            if all(camera.in_picture(camera.project(p).q).all() for camera in cameras):
                poses.append(T)
        truth = RigState(cameras, np.stack(poses), TARGET.points())
        dots = TARGET.count
        n = len(cameras) * views * dots
        blank = Observations(
            camera=np.repeat(np.arange(len(cameras)), views * dots),
            view=np.tile(np.repeat(np.arange(views), dots), len(cameras)),
            dot=np.tile(np.arange(dots), len(cameras) * views),
            q=np.zeros((n, 2)),
            covariance=np.tile(NOISE_PX**2 * np.eye(2), (n, 1, 1)),
        )
        q = truth.residuals(blank) + NOISE_PX * random.standard_normal((n, 2))
        return cls(truth, replace(blank, q=q.astype(np.float32).astype(np.float64)))

    def lenses_off(self) -> tuple[Camera, ...]:
        """Return the cameras with lenses from which an adjustment may start."""
        return tuple(
            replace(camera, K=camera.K + np.diag([3.0, -2.0, 0.0]), dist=0.9 * camera.dist)
            for camera in self.truth.cameras
        )

    def start(self, seed: int) -> RigState:
        """Return lenses and poses from which an adjustment may start."""
        random = generator(seed, "bench solve", "held rig", "start")
        first, second = self.lenses_off()
        T_world_target = self.truth.T_world_target
        off = _OFF * random.standard_normal((len(T_world_target), len(_OFF)))
        place = moved_poses(second.T_cam_world[None], _OFF[None])[0]
        cameras = (first, replace(second, T_cam_world=place))
        return RigState(cameras, moved_poses(T_world_target, off), self.truth.dots)

    def detections(self) -> Detections:
        """Return the observations as a table."""
        seen, n = self.observations, len(self.observations)
        return Detections(
            view=np.char.add("pose-", seen.view.astype(np.str_)),
            camera=np.array(CAMERAS)[seen.camera],
            image=np.full(n, "none.png"),
            size=np.tile(np.array(SIZE, dtype=np.int64), (n, 1)),
            index=TARGET.indices()[seen.dot].astype(np.int64),
            has_id=np.ones(n, dtype=bool),
            position=seen.q,
            covariance=seen.covariance,
            flag=np.full(n, "ok"),
        )


def _cameras() -> tuple[Camera, ...]:
    place = pose(Rotation.from_rotvec([0.02, -0.25, 0.01]).as_matrix(), np.array([-240.0, 3.0, 30.0]))
    cx, cy = _MIDDLE
    return tuple(
        Camera(np.array([[f, 0.0, cx], [0.0, f, cy], [0.0, 0.0, 1.0]]), "brown5", np.array(dist), T, SIZE)
        for f, dist, T in zip(_FOCAL_PX, _DIST, (np.eye(4), place), strict=True)
    )


def _held(random: np.random.Generator) -> Pose:
    """Return a pose of the target in front of the first camera."""
    tilt = Rotation.from_rotvec(_TILT * random.standard_normal(3)).as_matrix()
    R = np.diag([1.0, -1.0, -1.0]) @ tilt
    return pose(R, random.uniform(_NEAREST_MM, _FARTHEST_MM) - R @ TARGET.points().mean(axis=0))
