"""Pictures of boards whose truth is known: drawn through OpenCV's camera, without the code under test."""

from collections.abc import Callable
from dataclasses import dataclass, field

import cv2
import numpy as np
import pytest

from labcal.targets.grid import DotGrid, Polarity

SAMPLES = 4  # a side of a pixel


@dataclass(frozen=True)
class Board:
    """A board, a camera, a light; `missing` dots are not printed, `extra` rows and columns are, beyond it."""

    target: DotGrid
    size: tuple[int, int] = (640, 480)
    focal: float = 700.0
    distortion: tuple[float, float] = (0.0, 0.0)
    rotation: tuple[float, float, float] = (
        0.0,
        0.0,
        0.0,
    )  # degrees: about x, y of the board, then the camera's axis
    distance: float = 600.0
    aim: tuple[float, float] = (0.5, 0.5)  # of the board, where the camera looks
    missing: frozenset[tuple[int, int]] = field(default_factory=frozenset)
    extra: int = 0
    blur: float = 0.6
    falloff: float = 0.3
    noise: float = 0.0
    seed: int = 1

    @property
    def K(self) -> np.ndarray:
        w, h = self.size
        return np.array([[self.focal, 0, (w - 1) / 2], [0, self.focal, (h - 1) / 2], [0, 0, 1.0]])

    @property
    def dist(self) -> np.ndarray:
        return np.array([*self.distortion, 0, 0, 0])

    @property
    def pose(self) -> tuple[np.ndarray, np.ndarray]:
        """R, t of the board in the camera; unturned, its y is up in the picture and its front is seen."""
        about_x, about_y, about_z = np.radians(self.rotation)
        front = np.diag([1.0, -1.0, -1.0])
        turn = [cv2.Rodrigues(np.array(v))[0] for v in ((0, 0, about_z), (about_x, 0, 0), (0, about_y, 0))]
        R = turn[0] @ turn[1] @ turn[2] @ front
        x0, y0, x1, y1 = self.target.extent_mm
        look = np.array([x0 + self.aim[0] * (x1 - x0), y0 + self.aim[1] * (y1 - y0), 0])
        return R, np.array([0, 0, self.distance]) - R @ look

    def project(self, points: np.ndarray) -> np.ndarray:
        R, t = self.pose
        return cv2.projectPoints(points, cv2.Rodrigues(R)[0], t, self.K, self.dist)[0][:, 0]

    def diameter(self, index: tuple[int, int]) -> float:
        ring = index in self.target.ring_indices
        return self.target.ring_outer_diameter_mm if ring else self.target.dot_diameter_mm

    def outline(self, index: tuple[int, int]) -> np.ndarray:
        angle = np.linspace(0, 2 * np.pi, 720, endpoint=False)
        centre = self.target.points(np.array([index]))[0]
        circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], -1) * self.diameter(index) / 2
        return self.project(centre + circle)

    def centroid(self, index: tuple[int, int]) -> np.ndarray:
        """Centre of area of the outline's image: the polygon's, by the shoelace formula."""
        q = self.outline(index)
        middle = q.mean(0)
        q = q - middle
        n = np.roll(q, -1, axis=0)
        cross = q[:, 0] * n[:, 1] - n[:, 0] * q[:, 1]
        return middle + ((q + n) * cross[:, None]).sum(0) / (3 * cross.sum())

    def draw(self) -> np.ndarray:
        """Return the picture, float64, board 200 where the light is full, dots 12."""
        w, h = self.size
        k = (np.arange(w * SAMPLES) + 0.5) / SAMPLES - 0.5
        m = (np.arange(h * SAMPLES) + 0.5) / SAMPLES - 0.5
        q = np.stack(np.meshgrid(k, m), -1).reshape(-1, 1, 2)
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 30, 1e-9)
        ray = (
            cv2.undistortPoints(q, self.K, self.dist, criteria=criteria)[:, 0]
            if any(self.distortion)
            else (q[:, 0] - self.K[:2, 2]) / self.focal
        )
        R, t = self.pose
        H = np.linalg.inv(np.stack([R[:, 0], R[:, 1], t], -1))
        xyz = np.concatenate([ray, np.ones((len(ray), 1))], 1) @ H.T
        front = xyz[:, 2] > 0
        x, y = (xyz[:, :2] / np.where(front, xyz[:, 2], 1)[:, None]).T
        tg = self.target
        row = np.round(y / tg.pitch_y_mm)
        shift = (row % 2) * tg.pitch_x_mm / 2 if tg.layout == "asymmetric" else 0.0
        col = np.round((x - shift) / tg.pitch_x_mm)
        off = np.hypot(x - shift - col * tg.pitch_x_mm, y - row * tg.pitch_y_mm)
        e = self.extra
        printed = front & (col >= -e) & (col < tg.cols + e) & (row >= -e) & (row < tg.rows + e)
        for c, r in self.missing:
            printed &= ~((col == c) & (row == r))
        ring = np.zeros(len(x), bool)
        for c, r in tg.ring_indices:
            ring |= (col == c) & (row == r)
        dark = off < tg.dot_diameter_mm / 2
        if tg.rings is not None:
            inside = (off < tg.ring_outer_diameter_mm / 2) & (off > tg.ring_inner_diameter_mm / 2)
            dark = np.where(ring, inside, dark)
        x0, y0, x1, y1 = tg.extent_mm
        grow = e * np.array([tg.pitch_x_mm, tg.pitch_y_mm])
        board = front & (x > x0 - grow[0]) & (x < x1 + grow[0]) & (y > y0 - grow[1]) & (y < y1 + grow[1])
        white, black = (200.0, 12.0) if tg.polarity is Polarity.BLACK_ON_WHITE else (12.0, 200.0)
        value = np.where(board, np.where(dark & printed, black, white), 70.0)
        value *= 1 - self.falloff * ((q[:, 0, 0] / w) ** 2 + (q[:, 0, 1] / h) ** 2) / 2
        fine = value.reshape(h * SAMPLES, w * SAMPLES)
        fine = cv2.GaussianBlur(fine, (0, 0), self.blur * SAMPLES)
        picture = fine.reshape(h, SAMPLES, w, SAMPLES).mean((1, 3))
        return picture + np.random.default_rng(self.seed).normal(0, self.noise, picture.shape)


@pytest.fixture
def make_board() -> Callable[..., Board]:
    return Board


def as_bytes(picture: np.ndarray) -> np.ndarray:
    return np.clip(np.round(picture), 0, 255).astype(np.uint8)
