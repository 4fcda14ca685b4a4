"""The scene of a twin: the calibrated cameras, and the print as it is known, in even light."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.geometry.poses import inverse, rotation_vector, transform
from labcal.guide.twin.known_print import KnownPrint
from labcal.scene.board import Board
from labcal.scene.camera import CameraDescription
from labcal.scene.lamps import Ambient
from labcal.scene.model import Scene
from labcal.scene.motion import ShutterTimes, Track
from labcal.scene.placement import HeldPoses, PosedView
from labcal.scene.room import Room
from labcal.scene.take import Take
from labcal.shoot.manifest import Role

_FAR_AWAY = 20.0
"""Distance of floor, wall and table, as a multiple of the distance of the farthest board."""
_NO_LESS_MM = 1000.0
_MARGIN = 0.75
"""Of the pitch: bare board around the outermost dots, at least, so that their cells are on the board."""
_BEHIND = (0.3, 0.3, 0.3)
"""Of whatever is behind the sheet; nothing there is compared."""


def twin_scene(camera: Camera, T_world_target: Pose, known: KnownPrint) -> Scene:
    """Return the scene of one picture, which is rendered for the share of paper in each pixel.

    Parameters
    ----------
    camera : Camera
        It is described here as far as a scene can; rendering takes it as it is.
    T_world_target : ndarray, shape (4, 4)
        Pose of the target in the world of the camera, mm.
    known : KnownPrint
    """
    away = float(np.linalg.norm(T_world_target[:3, 3] - camera.centre))
    far = _FAR_AWAY * max(_NO_LESS_MM, away, float(np.abs(camera.centre).max()))
    target = known.target
    roomy = target.model_copy(update={"margin_mm": max(target.margin_mm, _MARGIN * max(target.cell_mm))})
    view = PosedView(
        name="view",
        role=Role.TRAIN,
        origin_mm=_triple(T_world_target[:3, 3]),
        rotation_rad=_triple(rotation_vector(T_world_target)),
    )
    return Scene(
        name="twin",
        target=roomy,
        cameras={"camera": _described(camera)},
        placement=HeldPoses(kind="poses", views=(view,)),
        lamps=(Ambient(kind="ambient", radiance=1.0),),
        room=Room(floor_z_mm=-far, wall_y_mm=far, table_z_mm=-0.9 * far, support=_BEHIND),
        board=Board(
            dark=(0.0, 0.0, 0.0),
            light=(1.0, 1.0, 1.0),
            plate=_BEHIND,
            dot_shifts_mm=known.shifts_from(transform(inverse(T_world_target), camera.centre)),
        ),
    )


def still_take(view: str, camera: str, device: Camera, T_world_target: Pose) -> Take:
    """Return the picture of a target that stands still."""
    track = Track(T_world_target, T_world_target[:3, 3], np.zeros(3), np.zeros(3))
    return Take(view, camera, camera, device, track, ShutterTimes(1e-3, 0.0, device.size[1]))


def _described(camera: Camera) -> CameraDescription:
    """Return a camera without distortion at the place of one."""
    fx, fy, cx, cy = camera.intrinsics
    eye: Float64[np.ndarray, 3] = camera.centre
    ahead = eye + 1000.0 * camera.T_cam_world[2, :3]
    return CameraDescription(
        size=camera.size,
        focal_px=0.5 * (fx + fy),
        principal_px=(cx, cy),
        lens="pinhole",
        eye_mm=_triple(eye),
        look_at_mm=_triple(ahead),
        up=_triple(-camera.T_cam_world[1, :3]),
    )


def _triple(v: Float64[np.ndarray, "3"]) -> tuple[float, float, float]:
    x, y, z = v.tolist()
    return (x, y, z)
