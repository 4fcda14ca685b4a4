"""What a picture truly shows, computed from the camera and the pose alone: no renderer takes part."""

import numpy as np

from labcal.cameras.dot_image import flat_outlines, outlined_images
from labcal.cameras.record import CameraRecord, matrix4_record
from labcal.scene.take import Take
from labcal.shoot.truth import TrueDots, TruePicture, TrueView
from labcal.targets.grid import DotGrid


def true_dots(target: DotGrid, take: Take) -> TrueDots:
    """Return every dot of the target as it is in one picture, in the middle of its own row's exposure.

    Parameters
    ----------
    target : DotGrid
        The target as it is printed.
    take : Take

    Returns
    -------
    TrueDots
        By the name under which the picture is delivered; `visible` where the whole outline is in the frame
        and the board is seen from its front. A dot that no row sees is where it is in the middle of the
        frame.
    """
    centres = target.points()
    images = outlined_images(take.image, centres, flat_outlines(centres, 0.5 * target.outer_diameters_mm()))
    T_world_target = take.track.T_world_target
    front = float((take.device.centre - T_world_target[:3, 3]) @ T_world_target[:3, 2]) > 0.0
    return TrueDots(
        view=take.view,
        camera=take.camera,
        index=target.indices(),
        point=take.track.carried(centres, np.nan_to_num(take.instants(centres))),
        centre=images.centre,
        centroid=images.centroid,
        visible=images.ok & take.device.in_picture(images.outline).all(axis=-1) & front,
    )


def true_view(takes: list[Take], cameras: dict[str, CameraRecord]) -> TrueView:
    """Return where the target was in a view, and what is true of single pictures only.

    Parameters
    ----------
    takes : list of Take
        The pictures of the view; the target's pose is that of the first one.
    cameras : dict of CameraRecord
        The cameras by name, as they stand in the truth of the whole shoot.
    """
    T_world_target = matrix4_record(takes[0].track.T_world_target)
    pictures = {}
    for take in takes:
        T_cam_world = matrix4_record(take.device.T_cam_world)
        T_world_target_then = matrix4_record(take.track.T_world_target)
        own = TruePicture(
            taken_by=None if take.taken_by == take.camera else take.taken_by,
            T_cam_world=None if T_cam_world == cameras[take.camera].T_cam_world else T_cam_world,
            T_world_target=None if T_world_target_then == T_world_target else T_world_target_then,
        )
        if own != TruePicture():
            pictures[take.camera] = own
    return TrueView(T_world_target=T_world_target, cameras=pictures)
