"""A scene of a print that is held in front of one camera, tilted, as large as a person would hold it."""

import cv2
import numpy as np

from labcal.geometry.poses import pose, rotation_vector
from labcal.scene.board import Board
from labcal.scene.camera import CameraDescription
from labcal.scene.lamps import Ambient
from labcal.scene.model import Scene
from labcal.scene.photometry import Photometry
from labcal.scene.placement import HeldPoses, PosedView
from labcal.scene.room import Room
from labcal.shoot.manifest import Role
from labcal.targets.catalogue import AnyTarget
from labcal.targets.printed_sheet import cut_sheet

ONE_OF_A_KIND = (
    "aprilgrid-6x6",
    "asymmetric-4x11",
    "charuco-12x9",
    "chessboard-marked-13x8",
    "coded-8x6",
    "rings-10x8",
)
"""One target of every kind of artwork and of detector: these are rendered, the others drawn."""
AXES_DEG = (0.0, 90.0, 40.0)
"""Axes of the tilt in the picture, one view each."""


def printed_scene(
    target: AnyTarget,
    size: tuple[int, int],
    fill: float,
    tilt_deg: float,
    sensor: str,
    board: Board | None = None,
) -> Scene:
    """Return a scene of views in which the sheet, seen from in front, would fill a share of the picture."""
    focal = 1.2 * size[0]
    cut = cut_sheet(target, 0)
    middle = np.array([0.5 * (cut.x_min + cut.x_max), 0.5 * (cut.y_min + cut.y_max), 0.0])
    away = focal * max(cut.width / size[0], cut.height / size[1]) / fill
    views = []
    for number, axis in enumerate(np.radians(AXES_DEG)):
        tilt, _ = cv2.Rodrigues(np.radians(tilt_deg) * np.array([np.cos(axis), 0.0, np.sin(axis)]))
        # The camera looks along +y of the world; a board upright before it has z along -y.
        upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
        turned = tilt @ upright
        T = pose(turned, np.array([0.0, away, 0.0]) - turned @ middle)
        x, y, z = T[:3, 3].tolist()
        a, b, c = rotation_vector(T).tolist()
        views.append(
            PosedView(name=f"v{number}", role=Role.TRAIN, origin_mm=(x, y, z), rotation_rad=(a, b, c))
        )
    camera = CameraDescription(
        size=size, focal_px=focal, principal_px=(0.5 * size[0], 0.5 * size[1]), lens="pinhole",
        eye_mm=(0.0, 0.0, 0.0), look_at_mm=(0.0, away, 0.0), up=(0.0, 0.0, 1.0),
    )  # fmt: skip
    far = 10.0 * away
    return Scene(
        name="printed",
        target=target,
        cameras={"camera": camera},
        placement=HeldPoses(kind="poses", views=tuple(views)),
        lamps=(Ambient(kind="ambient", radiance=1.0),),
        room=Room(floor_z_mm=-far, wall_y_mm=far, table_z_mm=-0.9 * far),
        board=board or Board(print_number=0),
        photometry=Photometry.model_validate(sensor),
    )
