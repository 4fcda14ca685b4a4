"""The pose of a target in a view of a calibrated rig, to start an adjustment from."""

import numpy as np

from labcal.arrays import Pose
from labcal.calibrate.lens_start import start_from_camera
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.geometry.poses import inverse
from labcal.targets.target import Target


def first_pose(rig: Rig, dots: Detections, view: str, target: Target) -> Pose:
    """Return the pose of the target in a view, by the camera that sees most of it, as the rig was.

    Parameters
    ----------
    rig : Rig
    dots : Detections
        Dots of the rig's cameras that are on the target.
    view : str
        One of their views.
    target : Target

    Returns
    -------
    ndarray, shape (4, 4)
        ``T_world_target``, mm.
    """
    here = dots.where(dots.view == view)
    counts = {name: int((here.camera == name).sum()) for name in here.cameras}
    name = max(counts, key=lambda camera: counts[camera])
    camera = rig.camera(name)
    start = start_from_camera([here.where(here.camera == name)], target, camera)
    return np.asarray(inverse(camera.T_cam_world) @ start.T_cam_target[0])
