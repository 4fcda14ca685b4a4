"""The scene of a twin: the calibrated cameras, and the print as it is known, in even light."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.geometry.poses import rotation_vector
from labcal.scene.board import Bend, Board
from labcal.scene.camera import CameraDescription
from labcal.scene.lamps import Ambient
from labcal.scene.model import Scene
from labcal.scene.motion import ShutterTimes, Track
from labcal.scene.photometry import Photometry
from labcal.scene.placement import HeldPoses, PosedView
from labcal.scene.room import Room
from labcal.scene.surface import Surface
from labcal.scene.take import Take
from labcal.shoot.manifest import Role
from labcal.targets.grid import DotGrid

_FAR_AWAY = 20.0
"""Distance of floor, wall and table, as a multiple of the distance of the farthest board."""
_FLAT_MM = 5e-4
"""A bend that lifts no dot by more is none: it would have to be traced through a mesh."""
_BEHIND = (0.3, 0.3, 0.3)
"""Of whatever is behind the sheet; nothing there is compared."""


def twin_scene(
    cameras: dict[str, Camera],
    views: dict[str, Pose],
    target: DotGrid,
    dots: Vectors3,
) -> Scene:
    """Return the scene that is rendered for the share of paper in each pixel.

    Parameters
    ----------
    cameras : dict of str to Camera
        By name. They are described here as far as a scene can; rendering takes them as they are.
    views : dict of str to ndarray of shape (4, 4)
        Pose of the target in the world of the cameras, mm.
    target : DotGrid
    dots : ndarray, shape (dots, 3)
        Places of its dots, mm: shifts in the plane are taken as they are, heights as the best bend.
    """
    far = _FAR_AWAY * max(
        1000.0, *(float(np.linalg.norm(T[:3, 3] - camera.centre)) for T in views.values() for camera in cameras.values())
    )  # fmt: skip
    shifts = (dots - target.points())[:, :2]
    return Scene(
        name="twin",
        description="The twin of a shoot, as far as a scene describes it.",
        target=target,
        cameras={name: _described(camera) for name, camera in cameras.items()},
        placement=HeldPoses(kind="poses", views=tuple(_view(name, T) for name, T in views.items())),
        lamps=(Ambient(kind="ambient", radiance=1.0),),
        room=Room(floor_z_mm=-far, wall_y_mm=far, table_z_mm=-0.9 * far, support=_BEHIND),
        board=Board(
            dark=(0.0, 0.0, 0.0),
            light=(1.0, 1.0, 1.0),
            plate=_BEHIND,
            bend=_bend(target, dots),
            dot_shifts_mm=tuple((float(x), float(y)) for x, y in shifts) if shifts.any() else (),
        ),
        photometry=Photometry(blur_px=0.0),
    )


def still_take(view: str, camera: str, device: Camera, T_world_target: Pose) -> Take:
    """Return the picture of a target that stands still."""
    track = Track(T_world_target, T_world_target[:3, 3], np.zeros(3), np.zeros(3))
    return Take(view, camera, camera, device, track, ShutterTimes(1e-3, 0.0, device.size[1]))


def _bend(target: DotGrid, dots: Vectors3) -> Bend:
    """Return the bend nearest to the heights of dots; none where they are next to nothing."""
    height = dots[:, 2]
    if np.abs(height).max() <= _FLAT_MM:
        return Bend()
    surface = Surface.of(target, Bend())
    a, b = ((dots[:, :2] - surface.middle) / surface.half).T
    design = np.column_stack([a * a, b * b, a * b, np.ones_like(a), a, b])
    along_x, along_y, twist = np.linalg.lstsq(design, height, rcond=None)[0][:3].tolist()
    bend = Bend(along_x_mm=along_x, along_y_mm=along_y, twist_mm=twist)
    lifted = Surface.of(target, bend).points(dots[:, :2])[:, 2]
    return bend if float(np.abs(lifted).max()) > _FLAT_MM else Bend()


def _described(camera: Camera) -> CameraDescription:
    """Return a camera without distortion at the place of one."""
    fx, fy, cx, cy = camera.intrinsics
    eye: Float64[np.ndarray, "3"] = camera.centre
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


def _view(name: str, T: Pose) -> PosedView:
    return PosedView(
        name=name, role=Role.TRAIN, origin_mm=_triple(T[:3, 3]), rotation_rad=_triple(rotation_vector(T))
    )


def _triple(v: Float64[np.ndarray, "3"]) -> tuple[float, float, float]:
    x, y, z = v.tolist()
    return (x, y, z)
