"""A drawn picture of a target: quick, without a renderer, through the same sensor and development.

The renderer follows rays; here the outline of every dot is projected and filled. In even light, which a
rehearsal has, both give the same picture up to the board's edge and the room behind it.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float32, Int64

from labcal.arrays import Pixels, Pose
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import DotImages, dot_images
from labcal.cameras.field import FallOff
from labcal.geometry.poses import transform
from labcal.render.bands import ROWS, strips
from labcal.render.development import develop
from labcal.render.film import CELLS_AT_ONCE
from labcal.render.point_spread import behind_lens, cells, finer, in_cells, reach
from labcal.render.sensor_response import Shot, exposure_for, read_sensor
from labcal.scene.board import Board
from labcal.scene.photometry import Photometry, PictureFormat, Stage
from labcal.shoot.luma import lossy_picture
from labcal.targets.catalogue import AnyTarget
from labcal.targets.grid import DotGrid, Polarity

_RAYS = 256
"""Rays of a traced pixel whose film is as fine as what is drawn."""
BACKGROUND = 0.3
"""Reflectance behind the board."""
_CELLS = 32
"""Of the grid on which the lens's fall-off is computed."""
_AROUND_PX = 24
"""Pixels around the board that are drawn, too."""
_BLOCK = 16
"""Side of the blocks in which JPEG holds colour."""


@dataclass(frozen=True)
class DrawnView:
    """A picture as the camera delivers it, cut out around the target, and the true images of all dots.

    Attributes
    ----------
    picture : ndarray, (h, w) or (h, w, 3)
    corner : int array, (2,)
        Pixel of the whole picture that is the first one of the cut-out.
    images : DotImages
        In pixels of the whole picture.
    """

    picture: np.ndarray
    corner: Int64[np.ndarray, "2"]
    images: DotImages


def drawn_view(
    camera: Camera, T_world_target: Pose, target: DotGrid, photometry: Photometry, shot: Shot
) -> DrawnView:
    """Draw a view of a target in even light.

    Parameters
    ----------
    camera : Camera
    T_world_target : ndarray, shape (4, 4)
        Mm.
    target : DotGrid
    photometry : Photometry
        Pictures in the format EXR are read as they come from the sensor, with 16 bits.
    shot : Shot
        What noise is drawn for.
    """
    images = dot_images(camera, T_world_target, target.points(), 0.5 * target.outer_diameters_mm())
    edge = camera.project(transform(T_world_target, board_edge(target)))
    corner, end = cut_out(camera, edge.q[edge.ok])
    outlines = [(images.outline[images.ok], 1.0)]
    if target.ring_indices:
        key = np.array([row * target.cols + col for col, row in target.ring_indices])
        inner = np.full(len(key), 0.5 * float(target.ring_inner_diameter_mm or 0.0))
        holes = dot_images(camera, T_world_target, target.points()[key], inner)
        outlines.append((holes.outline[holes.ok], -1.0))
    paper, ink = Board().light[0], Board().dark[0]
    if target.polarity is Polarity.WHITE_ON_BLACK:
        paper, ink = ink, paper
    (width, height), blur_px = (end - corner).tolist(), photometry.blur_px
    cells_a_pixel = finer(blur_px, _RAYS)
    halo, light = reach(blur_px), np.empty((height, width), dtype=np.float32)
    share = relative_light(camera, photometry, corner - halo, end + halo)
    for own, wide in strips(height, max(ROWS, CELLS_AT_ONCE // (width * cells_a_pixel**2)), halo):
        size = cells_a_pixel * np.array([len(wide), width + 2 * halo])
        fine = np.full(size, BACKGROUND, dtype=np.float32)
        first = corner + np.array([-halo, wide.start])
        sheet = np.rint(in_cells(edge.q[edge.ok] - first, cells_a_pixel))
        cv2.fillPoly(fine, [sheet.astype(np.int32)], paper)
        for some, times in outlines:
            for outline in some:
                _fill(fine, in_cells(outline - first, cells_a_pixel), times * (ink - paper))
        passing = share[wide.start + halo : wide.stop + halo]
        light[own] = behind_lens(cells(fine, cells_a_pixel), passing, blur_px)
    return DrawnView(taken_picture(light, photometry, shot), corner, images)


def relative_light(
    camera: Camera,
    photometry: Photometry,
    corner: Int64[np.ndarray, "2"],
    end: Int64[np.ndarray, "2"],
) -> Float32[np.ndarray, "h w"]:
    """Return the share of the light that reaches the pixels of a cut-out: fall-off and vignetting.

    Parameters
    ----------
    camera : Camera
    photometry : Photometry
    corner, end : ndarray of int, shape (2,)
        First pixel of the cut-out, and the one past its last.
    """
    u, v = np.meshgrid(
        *(np.linspace(first, last - 1.0, _CELLS) for first, last in zip(corner, end, strict=True))
    )
    weight = np.ones(u.shape)
    if photometry.fall_off and camera.model.fall_off is FallOff.COS4:
        ray = camera.rays(np.stack([u, v], axis=-1))
        cosine = np.nan_to_num(ray.direction) @ camera.T_cam_world[2, :3]
        weight *= np.where(ray.ok, np.clip(cosine, 0.0, 1.0) ** 4, 1.0)
    width, height = camera.size
    corner2 = 0.25 * (width**2 + height**2)
    radius2 = (u - 0.5 * (width - 1)) ** 2 + (v - 0.5 * (height - 1)) ** 2
    weight *= 1.0 - photometry.vignetting * radius2 / corner2
    along, down = np.meshgrid(
        *(np.linspace(0.0, _CELLS - 1.0, count, dtype=np.float32) for count in (end - corner).tolist())
    )
    return np.asarray(cv2.remap(weight.astype(np.float32), along, down, cv2.INTER_LINEAR))


def cut_out(camera: Camera, edge: Pixels) -> tuple[Int64[np.ndarray, "2"], Int64[np.ndarray, "2"]]:
    """Return the first pixel around the target, and the one past the last; at corners of JPEG's blocks."""
    size = np.array(camera.size, dtype=np.int64)
    if len(edge) == 0:
        return np.zeros(2, dtype=np.int64), np.minimum(size, _BLOCK)
    low = np.clip(np.floor(edge.min(axis=0)) - _AROUND_PX, 0, size - 1).astype(np.int64) // _BLOCK * _BLOCK
    high = np.clip(np.ceil(edge.max(axis=0)) + _AROUND_PX, low + _BLOCK, None).astype(np.int64)
    return low, np.minimum(low + -(-(high - low) // _BLOCK) * _BLOCK, np.maximum(size, low + 1))


def board_edge(target: AnyTarget) -> np.ndarray:
    """Return points along the edge of the board, mm, (n, 3)."""
    x_min, y_min, x_max, y_max = target.extent_mm
    along = np.linspace(0.0, 1.0, _CELLS, endpoint=False)
    x, y = x_min + along * (x_max - x_min), y_min + along * (y_max - y_min)
    sides = [
        np.stack([x, np.full_like(x, y_min)], axis=-1), np.stack([np.full_like(y, x_max), y], axis=-1),
        np.stack([x[::-1], np.full_like(x, y_max)], axis=-1),
        np.stack([np.full_like(y, x_min), y[::-1]], axis=-1),
    ]  # fmt: skip
    flat = np.concatenate(sides)
    return np.concatenate([flat, np.zeros((len(flat), 1))], axis=1)


def _fill(light: np.ndarray, outline: Pixels, contrast: float) -> None:
    """Add light to cells by the share of each that is inside an outline, where that is among them.

    The outline is given as its distance from its middle by the angle. Near it the distance of a cell's middle
    from it, across the outline, tells how much of the cell is covered.
    """
    height, width = light.shape
    low = np.maximum(np.floor(outline.min(axis=0)).astype(int) - 1, 0)
    high = np.minimum(np.ceil(outline.max(axis=0)).astype(int) + 2, [width, height])
    if (high <= low).any():
        return
    middle = outline.mean(axis=0)
    away = outline - middle
    angle, radius = np.arctan2(away[:, 1], away[:, 0]), np.hypot(away[:, 0], away[:, 1])
    order = np.argsort(angle)
    angle, radius = angle[order], radius[order]
    x, y = (np.arange(first, last) - centre for first, last, centre in zip(low, high, middle, strict=True))
    at, distance = np.arctan2(y[:, None], x), np.hypot(x, y[:, None])
    reach_of = np.interp(at, angle, radius, period=2.0 * np.pi)
    slope = np.interp(at, angle, np.gradient(radius, angle) / radius, period=2.0 * np.pi)
    covered = np.clip(0.5 + (reach_of - distance) / np.hypot(1.0, slope), 0.0, 1.0)
    light[low[1] : high[1], low[0] : high[0]] += (contrast * covered).astype(np.float32)


def taken_picture(light: np.ndarray, photometry: Photometry, shot: Shot) -> np.ndarray:
    """Return the picture that a camera delivers, as it is measured: that of a lossy file by its luma.

    Parameters
    ----------
    light : ndarray, shape (h, w)
        Radiance that each pixel gathers, behind the point spread of the lens.
    photometry : Photometry
    shot : Shot
        For which noise is drawn.
    """
    behind = np.repeat(light[..., None], 3, axis=-1) if photometry.bayer else light
    exposure = exposure_for(photometry, np.array(Board().light))
    codes = read_sensor(behind, photometry, exposure, shot)
    if photometry.stage is Stage.RAW or photometry.format is PictureFormat.EXR:
        return codes
    picture = develop(codes, photometry, exposure)
    if photometry.format is not PictureFormat.JPEG:
        return picture
    return lossy_picture(picture, photometry.jpeg_quality)
