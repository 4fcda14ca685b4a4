"""A board in front of one camera in even light, for benchmarks of single pictures."""

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose
from labcal.geometry.poses import pose
from labcal.scene.board import Board
from labcal.scene.camera import CameraDescription
from labcal.scene.lamps import Ambient
from labcal.scene.model import Scene
from labcal.scene.motion import ShutterTimes, Track
from labcal.scene.occluders import Occluder
from labcal.scene.photometry import Photometry
from labcal.scene.placement import Handheld
from labcal.scene.room import Room
from labcal.scene.take import Take
from labcal.targets.catalogue import DescribedTarget
from labcal.targets.grid import DotGrid

CAMERA = "only"
"""Name of the one camera."""
BARE_BOARD = Board().light[0]
"""Radiance of a bare board under the even light."""


def board_scene(
    target: DescribedTarget, camera: CameraDescription, spp: int, occluders: tuple[Occluder, ...] = ()
) -> Scene:
    """Return a target in front of a sharp camera in even light without noise, far from the walls of the room.

    Parameters
    ----------
    target : target of any kind
    camera : CameraDescription
    spp : int
        Rays a pixel.
    occluders : tuple of Occluder
        Occluders.
    """
    return Scene(
        name="bench",
        target=target,
        cameras={CAMERA: camera},
        placement=Handheld(
            kind="handheld", train=1, test=0, centre_mm=(0.0, 0.0, 0.0), spread_mm=(0.0, 0.0, 0.0)
        ),
        lamps=(Ambient(kind="ambient", radiance=1.0),),
        room=Room(floor_z_mm=-9000.0, wall_y_mm=9000.0, table_z_mm=-8000.0),
        occluders=occluders,
        photometry=Photometry(blur_px=0.0),
        spp=spp,
    )


def blurred_scene(scene: Scene, blur_px: float) -> Scene:
    """Return a scene whose cameras have a point spread of some standard deviation, px."""
    photometry = scene.photometry.model_copy(update={"blur_px": blur_px})
    return scene.model_copy(update={"photometry": photometry})


def tilted_pose(target: DotGrid, tilt_deg: float, azimuth: float, roll: float, at: np.ndarray) -> Pose:
    """Return ``T_world_target`` with the board's middle at a point, turned about its normal and then tilted.

    Parameters
    ----------
    target : DotGrid
    tilt_deg : float
        Between the board's normal and the world's z.
    azimuth, roll : float
        Direction of the axis of the tilt, and the turn about the normal, rad.
    at : ndarray, shape (3,)
        World, mm.
    """
    axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    tilted = Rotation.from_rotvec(np.radians(tilt_deg) * axis)
    R_world_target = (tilted * Rotation.from_rotvec([0.0, 0.0, roll])).as_matrix()
    return pose(R_world_target, at - R_world_target @ target.points().mean(axis=0))


def still_take(scene: Scene, T_world_target: Pose) -> Take:
    """Return the take of the only camera of a board that does not move."""
    device = scene.cameras[CAMERA].camera()
    track = Track(T_world_target, np.zeros(3), np.zeros(3), np.zeros(3))
    return Take("one", CAMERA, CAMERA, device, track, ShutterTimes(0.0, 0.0, device.size[1]))
