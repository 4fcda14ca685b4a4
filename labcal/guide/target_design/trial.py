"""A target tried in drawn pictures: near and far, square and tilted, whether the detector finds its dots."""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.arrays import Pixels, Pose
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import DotImages, dot_images
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.geometry.poses import transform
from labcal.guide.rehearsal.dot_noise import hull_area, minor_semi_axes
from labcal.guide.rehearsal.drawn_view import drawn_view
from labcal.guide.target_design.drawn_print import drawn_print
from labcal.guide.target_design.question import TargetQuestion
from labcal.render.sensor_response import Shot
from labcal.rng import generator
from labcal.run.progress import Progress
from labcal.targets.catalogue import AnyTarget
from labcal.targets.grid import DotGrid

TILTS_DEG = (0.0, 30.0)
"""Beside the greatest one."""
PICTURES, MANY_DOTS = 2, 200
"""Of each camera, distance and tilt, in other turns of the board; one is enough of so many dots."""
FOUND_SHARE = 0.95
"""Least share of the whole dots that is measured."""


@dataclass(frozen=True)
class TriedView:
    """Pictures of one camera at one distance and tilt.

    Parameters
    ----------
    camera : str
    distance_mm, tilt_deg : float
    size_px : float
        Median minor semi-axis of a dot, or side of a square of a chessboard; NaN where no dot is whole.
    picture_share : float
        Share of the picture that the board's dots span.
    indexed, pictures : int
        Pictures whose dots were numbered, of all.
    found, whole : int
        Dots that were measured, of those that are wholly in the pictures.
    sigma_px : float
        Root mean square of a coordinate's error; NaN without a measurement.
    refusal : str
        Why a picture was not indexed; empty where all were.
    """

    camera: str
    distance_mm: float
    tilt_deg: float
    size_px: float
    picture_share: float
    indexed: int
    pictures: int
    found: int
    whole: int
    sigma_px: float
    refusal: str

    @property
    def passed(self) -> bool:
        """True if all pictures are indexed, and nearly all dots measured."""
        return self.indexed == self.pictures and self.found >= FOUND_SHARE * self.whole > 0


@dataclass(frozen=True)
class _Picture:
    size_px: float
    share: float
    whole: int
    error: Pixels
    refusal: str


def tried_views(
    target: AnyTarget, question: TargetQuestion, seed: int, progress: Progress
) -> tuple[TriedView, ...]:
    """Return what the detector makes of a target in drawn pictures.

    Parameters
    ----------
    target : AnyTarget
    question : TargetQuestion
    seed : int
        Of turns of the board and noise.
    progress : Progress
    """
    distances = sorted({question.near_mm, question.far_mm})
    tilts = sorted({*(tilt for tilt in TILTS_DEG if tilt < question.tilt_max_deg), question.tilt_max_deg})
    cameras = question.different_cameras
    progress.start("drawn pictures", len(cameras) * len(distances) * len(tilts))
    found = []
    for name in cameras:
        for distance in distances:
            for tilt in tilts:
                found.append(_tried(target, question, (name, distance, tilt), seed))
                progress.advance()
    return tuple(found)


def _tried(
    target: AnyTarget, question: TargetQuestion, case: tuple[str, float, float], seed: int
) -> TriedView:
    name, distance, tilt = case
    camera = question.cameras[name]
    random = generator(seed, "target design", name, f"{distance:g}", f"{tilt:g}")
    parts = []
    for number in range(PICTURES if target.count < MANY_DOTS else 1):
        T = board_pose(camera, target, distance, tilt, random)
        shot = Shot(seed, f"{distance:g}-{tilt:g}-{number}", name)
        parts.append(_picture(camera, T, target, question, shot))
    error = np.concatenate([part.error for part in parts])
    refusals = [part.refusal for part in parts if part.refusal]
    sizes = [part.size_px for part in parts if np.isfinite(part.size_px)]
    return TriedView(
        camera=name,
        distance_mm=distance,
        tilt_deg=tilt,
        size_px=float(np.median(sizes)) if sizes else float("nan"),
        picture_share=float(np.mean([part.share for part in parts])),
        indexed=len(parts) - len(refusals),
        pictures=len(parts),
        found=len(error),
        whole=sum(part.whole for part in parts),
        sigma_px=float(np.sqrt((error**2).mean())) if len(error) else float("nan"),
        refusal=refusals[0] if refusals else "",
    )


def board_pose(
    camera: Camera, target: AnyTarget, distance_mm: float, tilt_deg: float, random: np.random.Generator
) -> Pose:
    """Return a pose of a board on the camera's axis, turned and tilted at random, in the world.

    Parameters
    ----------
    camera : Camera
    target : AnyTarget
    distance_mm : float
        Of its middle.
    tilt_deg : float
    random : numpy.random.Generator
        Of the turn about the normal, of the direction of the tilt, and of up to a pixel of displacement.
    """
    x_min, y_min, x_max, y_max = target.extent_mm
    middle = np.array([0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.0])
    azimuth, turn = random.uniform(0.0, 2.0 * np.pi, 2)
    axis = np.radians(tilt_deg) * np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    R = cv2.Rodrigues(axis)[0] @ cv2.Rodrigues(np.array([0.0, 0.0, turn]))[0] @ np.diag([1.0, -1.0, -1.0])
    T = np.eye(4)
    T[:3, :3] = R
    pixel = distance_mm / float(camera.K[0, 0])
    T[:3, 3] = np.append(pixel * random.uniform(-1.0, 1.0, 2), distance_mm) - R @ middle
    return np.asarray(np.linalg.inv(camera.T_cam_world) @ T)


def _picture(camera: Camera, T: Pose, target: AnyTarget, question: TargetQuestion, shot: Shot) -> _Picture:
    if isinstance(target, DotGrid):
        view = drawn_view(camera, T, target, question.photometry, shot)
        picture, corner = view.picture, view.corner
    else:
        picture, corner = drawn_print(camera, T, target, question.photometry, shot)
    dots = detect_dots(picture, target)
    q, whole, size = _truth(camera, T, target)
    number = dots.index[:, 1] * target.cols + dots.index[:, 0]
    good = np.flatnonzero(_measured(dots, target))
    good = good[whole[number[good]]]
    return _Picture(
        size_px=size,
        share=hull_area(q[whole]) / (camera.size[0] * camera.size[1]),
        whole=int(whole.sum()),
        error=dots.position[good] + corner - q[number[good]],
        refusal="" if dots.refusal is None else str(dots.refusal.value),
    )


def _measured(dots: PictureDots, target: AnyTarget) -> np.ndarray:
    """Return a mask of the dots of the declared grid that are measurements."""
    col, row = dots.index[:, 0], dots.index[:, 1]
    return np.asarray(dots.ok & (col >= 0) & (col < target.cols) & (row >= 0) & (row < target.rows))


def _truth(camera: Camera, T: Pose, target: AnyTarget) -> tuple[Pixels, np.ndarray, float]:
    """Return true places of all dots, which of them are whole in the picture, and their size in px."""
    radii = 0.5 * target.outer_diameters_mm()
    points = target.points()
    if not radii.any():
        corners = camera.project(transform(T, points))
        whole = corners.ok & camera.in_picture(corners.q)
        steps = np.linalg.norm(np.diff(corners.q.reshape(target.rows, target.cols, 2), axis=1), axis=-1)
        return corners.q, np.asarray(whole), float(np.nanmedian(steps))
    images: DotImages = dot_images(camera, T, points, radii)
    whole = images.ok & camera.in_picture(images.outline).all(axis=-1)
    if not whole.any():
        return images.centroid, np.asarray(whole), float("nan")
    return images.centroid, np.asarray(whole), float(np.median(minor_semi_axes(images.outline[whole])))
