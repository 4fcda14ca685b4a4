"""Traced pictures of boards: views that are drawn in :mod:`labcal.bench.boards`, rendered ray by ray.

The laboratory stands as the drawn view has it: the print in the artwork of its kind on a plate, the camera,
and a solid box where something hides a part of the board. The lens blurs it, light falls off over the
picture, and the sensor has noise.
"""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.bench.boards.april_grid_ink import PAPER_CELLS
from labcal.bench.boards.board_view import FOCAL, BoardPicture
from labcal.bench.boards.charuco_ink import PAPER_SQUARES
from labcal.bench.boards.chessboard_picture import BORDER_SQUARES
from labcal.bench.held_board import blurred_scene, board_scene, still_take
from labcal.bench.marks.drawn_picture import INK, PAPER, Cover
from labcal.geometry.poses import inverse
from labcal.render.development import develop
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.sensor_response import Exposure as SensorExposure
from labcal.render.sensor_response import Shot, read_sensor
from labcal.render.variant import MONO, renderer
from labcal.scene.board import Board
from labcal.scene.camera import CameraDescription
from labcal.scene.occluders import Box
from labcal.scene.photometry import Photometry
from labcal.scene.take import Take
from labcal.shoot.tone_curve import ToneCurve
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_dictionary
from labcal.targets.chessboard import Chessboard

SquareBoard = Chessboard | CharucoBoard | AprilGrid
SPP = 256
"""Rays a pixel: with 72 their noise adds a tenth to the errors of AprilGrids, with 8 it is more than that of
most sensors."""
UNIT_MM = 30.0
"""Of a square or tag, which is 1 in a drawn view."""
EYE_MM = 3000.0
"""Height of the camera over the world's origin; it looks straight down."""
_DOWN = np.diag([1.0, -1.0, -1.0])
_NEARER = 0.9
"""Distance of what hides a board, of that of its nearest corner."""
_THICK_MM = 1.0


@dataclass(frozen=True)
class TracedView:
    """The laboratory's side of a drawn view."""

    camera: CameraDescription
    T_world_target: Pose
    boxes: tuple[Box, ...]


def traced_picture(picture: BoardPicture[SquareBoard], shot: Shot, spp: int = SPP) -> np.ndarray:
    """Return a drawn view as the renderer and the sensor see it, uint8, shape (height, width).

    Parameters
    ----------
    picture : BoardPicture
        Its own picture does not count.
    shot : Shot
        For which rays and noise are drawn.
    spp : int
        Rays a pixel.

    Raises
    ------
    DeviceError
        There is no LLVM library for the renderer.
    """
    exposure = picture.exposure
    behind = traced_light(picture, shot, spp)
    sensor = Photometry(
        full_well_e=1.0 / exposure.noise**2,
        read_noise_e=0.0,
        tone_curve=ToneCurve.LINEAR,
    )
    gain = SensorExposure(PAPER / Board().light[0], (1.0, 1.0, 1.0))
    return develop(read_sensor(behind, sensor, gain, shot), sensor, gain)


def traced_light(picture: BoardPicture[SquareBoard], shot: Shot, spp: int) -> np.ndarray:
    """Return the light that pixels gather behind the lens, float32, shape (h, w).

    Light that falls off over the picture does so before the lens blurs it, as on the board and in the lens.

    Parameters
    ----------
    picture : BoardPicture
    shot : Shot
    spp : int
    """
    view = traced_view(picture)
    scene = board_scene(_printed(picture.board), view.camera, spp, view.boxes)
    paper = Board().light[0]
    board = Board(dark=(paper * INK / PAPER,) * 3)
    scene = blurred_scene(scene.model_copy(update={"board": board}), picture.exposure.blur_px)
    take: Take = still_take(scene, view.T_world_target)
    with renderer(MONO) as mi:
        laboratories = Laboratories(mi, scene, shot.seed)
        return render_light(laboratories, Case(take, shot.seed), picture.exposure.light)


def traced_view(picture: BoardPicture[SquareBoard]) -> TracedView:
    """Return camera, pose and boxes that show what a drawn view shows.

    The middle of a drawn board is in the camera's principal point.
    """
    width, height = picture.exposure.size
    places = picture.board.points()[:, :2]
    principal = picture.exposure.seen(places.mean(axis=0)[None])[0]
    focal = FOCAL * width
    camera = CameraDescription(
        size=(width, height),
        focal_px=focal,
        principal_px=(float(principal[0]), float(principal[1])),
        lens="pinhole",
        eye_mm=(0.0, 0.0, EYE_MM),
        look_at_mm=(0.0, 0.0, 0.0),
    )
    K = np.array([[focal, 0.0, principal[0]], [0.0, focal, principal[1]], [0.0, 0.0, 1.0]])
    columns = np.linalg.solve(K, picture.exposure.H @ np.diag([1.0 / UNIT_MM, 1.0 / UNIT_MM, 1.0]))
    columns /= np.linalg.norm(columns[:, 0])
    T_cam_target = np.eye(4)
    T_cam_target[:3] = np.column_stack(
        [columns[:, 0], columns[:, 1], np.cross(columns[:, 0], columns[:, 1]), columns[:, 2]]
    )
    T_world_target = inverse(camera.camera().T_cam_world) @ T_cam_target
    depths = (places * UNIT_MM) @ T_cam_target[2, :2] + T_cam_target[2, 3]
    depth = _NEARER * float(depths.min())
    return TracedView(camera, T_world_target, tuple(_box(cover, depth, K) for cover in picture.covers))


def _box(cover: Cover, depth: float, K: np.ndarray) -> Box:
    """Return a thin box whose front, at a distance from the camera, mm, looks as a cover does."""
    scale = depth / K[0, 0]
    x, y = (scale * (cover.middle - K[:2, 2])).tolist()
    across, down = (2.0 * scale * cover.half).tolist()
    grey = min(cover.level / PAPER * Board().light[0], 1.0)
    return Box(
        kind="box",
        centre_mm=(x, -y, EYE_MM - depth - 0.5 * _THICK_MM),
        size_mm=(across, down, _THICK_MM),
        turn_deg=(0.0, 0.0, float(-np.degrees(cover.turn))),
        reflectance=(grey,) * 3,
    )


def _printed(board: SquareBoard) -> SquareBoard:
    """Return a board in millimetres, with as much bare paper around it as it is drawn with."""
    if isinstance(board, AprilGrid):
        cells = opencv_dictionary(board.dictionary).markerSize + 2 * board.border_cells
        tag = {"tag_mm": UNIT_MM * board.tag_mm, "margin_mm": UNIT_MM * board.tag_mm * PAPER_CELLS / cells}
        return board.model_copy(update=tag)
    square = UNIT_MM * board.square_mm
    if isinstance(board, Chessboard):
        return board.model_copy(update={"square_mm": square, "margin_mm": BORDER_SQUARES * square})
    marker = {"marker_mm": UNIT_MM * board.marker_mm, "margin_mm": PAPER_SQUARES * square}
    return board.model_copy(update={"square_mm": square, **marker})
