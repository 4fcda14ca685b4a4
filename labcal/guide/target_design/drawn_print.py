"""A drawn picture of any printed target: its outlines projected, filled and seen through a sensor."""

import cv2
import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.geometry.poses import transform
from labcal.guide.rehearsal.drawn_view import BACKGROUND, board_edge, cut_out, relative_light, taken_picture
from labcal.render.point_spread import behind_lens, cells, in_cells, reach
from labcal.render.sensor_response import Shot
from labcal.scene.board import Board
from labcal.scene.photometry import Photometry
from labcal.targets.catalogue import AnyTarget
from labcal.targets.polygons import print_polygons

_FINER = 8
"""Steps of a pixel in which outlines are filled."""
_CELLS = 4
"""Cells along a side of a pixel, which a lens blurs."""
_SHIFT = 6
"""Bits of a fraction of such a step."""
_PIECE_PX = 2.0
"""Length of the pieces of a line, so that a lens bends it."""


def drawn_print(
    camera: Camera, T_world_target: Pose, target: AnyTarget, photometry: Photometry, shot: Shot
) -> tuple[np.ndarray, np.ndarray]:
    """Draw a view of a target, black on white, in even light.

    Parameters
    ----------
    camera : Camera
    T_world_target : ndarray, shape (4, 4)
        Mm.
    target : AnyTarget
    photometry : Photometry
    shot : Shot
        What noise is drawn for.

    Returns
    -------
    picture : ndarray, (h, w) or (h, w, 3)
        Cut out around the target.
    corner : ndarray of int, shape (2,)
        Pixel of the whole picture that is the first one of the cut-out.
    """
    edge = camera.project(transform(T_world_target, board_edge(target)))
    corner, end = cut_out(camera, edge.q[edge.ok])
    halo = reach(photometry.blur_px)
    first, (width, height) = corner - halo, (end - corner + 2 * halo).tolist()
    fine = np.zeros((height * _FINER, width * _FINER), dtype=np.uint8)
    scale = float(np.ptp(edge.q[edge.ok], axis=0).max()) / max(np.ptp(board_edge(target), axis=0))
    parts = []
    for ring in _polygons(target, _PIECE_PX / max(scale, 1e-9)):
        image = camera.project(transform(T_world_target, np.column_stack([ring, np.zeros(len(ring))])))
        if image.ok.all():
            place = in_cells(image.q - first, _FINER) * 2**_SHIFT
            parts.append(np.rint(place).astype(np.int32))
    cv2.fillPoly(fine, parts, 255, lineType=cv2.LINE_8, shift=_SHIFT)
    size = (_CELLS * width, _CELLS * height)
    share = cv2.resize(fine, size, interpolation=cv2.INTER_AREA).astype(np.float32) / np.float32(255.0)
    paper, ink = Board().light[0], Board().dark[0]
    light = np.full(share.shape, BACKGROUND, dtype=np.float32)
    cv2.fillPoly(light, [np.rint(in_cells(edge.q[edge.ok] - first, _CELLS)).astype(np.int32)], paper)
    light += share * np.float32(ink - paper)
    share = relative_light(camera, photometry, first, end + halo)
    seen = behind_lens(cells(light, _CELLS), share, photometry.blur_px)
    return taken_picture(seen, photometry, shot), corner


def _polygons(target: AnyTarget, piece_mm: float) -> list[np.ndarray]:
    """Return the outlines of the print as closed polygons with short sides, mm."""
    found = []
    for corners in print_polygons(target):
        lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        pieces = np.maximum(1, np.ceil(lengths / piece_mm)).astype(int)
        along = [
            first + (last - first) * np.arange(count)[:, None] / count
            for first, last, count in zip(corners[:-1], corners[1:], pieces.tolist(), strict=True)
            if count and (first != last).any()
        ]
        if along:
            found.append(np.concatenate(along))
    return found
