"""Drawn pictures of the print of a target of any kind, seen through a camera with its lens, in even light."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from labcal.arrays import Mask, Pixels, Pose
from labcal.bench.boards.print_samples import lit_samples
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images, of_places
from labcal.geometry.poses import inverse, transform
from labcal.guide.rehearsal.drawn_view import BACKGROUND, board_edge, cut_out, relative_light, taken_picture
from labcal.render.point_spread import behind_lens, cells, reach
from labcal.render.sensor_response import Shot
from labcal.scene.board import Board
from labcal.scene.photometry import Photometry
from labcal.targets.ink_distance import InkDistance, ink_distance
from labcal.targets.target import PrintableTarget

_FINER = 8
"""Samples along a side of a pixel: with 4 the corners of tilted boards are off by up to 0.002 px, with 8 by
0.0004 px."""


@dataclass(frozen=True)
class ImagedPrint:
    """A picture around a target, and the images of its places.

    Attributes
    ----------
    picture : ndarray, (h, w) or (h, w, 3)
        As the camera delivers it, cut out around the target.
    corner : ndarray of int, shape (2,)
        Pixel of the whole picture that is the first one of the cut-out.
    places : ndarray, shape (n, 2)
        True images of all places of the target, of dots their centroids, px of the whole picture; NaN where
        there is none.
    in_frame : ndarray of bool, shape (n,)
        Which of them lie in the picture.
    """

    picture: np.ndarray
    corner: np.ndarray
    places: Pixels
    in_frame: Mask


@dataclass(frozen=True)
class DrawnPrint:
    """The print of a target, to be drawn many times."""

    target: PrintableTarget
    field: InkDistance

    @classmethod
    def of(cls, target: PrintableTarget) -> "DrawnPrint":
        """Return the print of a target as it is designed."""
        return cls(target, ink_distance(target))

    def seen(self, camera: Camera, T_world_target: Pose, photometry: Photometry, shot: Shot) -> ImagedPrint:
        """Return the picture that a camera takes of the print.

        Parameters
        ----------
        camera : Camera
        T_world_target : ndarray, shape (4, 4)
            Mm.
        photometry : Photometry
        shot : Shot
            For which noise is drawn.
        """
        edge = camera.project(transform(T_world_target, board_edge(self.target)))
        corner, end = cut_out(camera, edge.q[edge.ok])
        halo = reach(photometry.blur_px)
        wider = corner - halo, end + halo
        light = cells(self._light(camera, T_world_target, *wider), _FINER)
        behind = behind_lens(light, relative_light(camera, photometry, *wider), photometry.blur_px)
        radii = 0.5 * self.target.outer_diameters_mm()
        images = of_places(dot_images(camera, T_world_target, self.target.points(), radii), radii)
        return ImagedPrint(
            picture=taken_picture(behind, photometry, shot),
            corner=corner,
            places=images.centroid,
            in_frame=np.asarray(images.ok & camera.in_picture(images.centroid)),
        )

    def _light(
        self, camera: Camera, T_world_target: Pose, corner: np.ndarray, end: np.ndarray
    ) -> Float32[np.ndarray, "fine_h fine_w"]:
        """Return the reflectance that samples of a cut-out see, :data:`_FINER` along a side of a pixel.

        Rays are those of the pixels' centres; within a pixel, places on the board change in a line.
        """
        u, v = np.meshgrid(*(np.arange(first, last) for first, last in zip(corner, end, strict=True)))
        ray = camera.rays(np.stack([u, v], axis=-1).astype(np.float64))
        T_target_world = inverse(T_world_target)
        origin = transform(T_target_world, ray.origin)
        direction = ray.direction @ T_target_world[:3, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            places = origin - direction * (origin[..., 2:] / direction[..., 2:])
        x_min, y_min, x_max, y_max = self.target.extent_mm
        paper, ink = Board().light[0], Board().dark[0]
        if self.target.is_white_on_black:
            paper, ink = ink, paper
        at, step = np.array(self.field.origin), self.field.step_mm
        levels = np.array([paper, ink, BACKGROUND])
        x, y = ((places[..., axis] - at[axis]) / step for axis in (0, 1))
        edges = (np.array([x_min, x_max, y_min, y_max]) - at[[0, 0, 1, 1]]) / step
        return lit_samples((x, y), _FINER, self.field.distance / step, edges, levels)
