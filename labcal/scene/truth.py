"""The true values of a picture, computed from camera and pose without a renderer."""

import numpy as np

from labcal.cameras.dot_image import of_places, outlined_images
from labcal.cameras.record import CameraRecord, matrix4_record
from labcal.scene.model import Scene
from labcal.scene.print import TruePrint
from labcal.scene.take import Take
from labcal.scene.visibility import unseen, viewpoints
from labcal.shoot.truth import TrueDots, TruePicture, TrueView


def true_dots(scene: Scene, made: TruePrint, take: Take) -> TrueDots:
    """Return every dot of the target in one picture, at the middle of the exposure of its row.

    Parameters
    ----------
    scene : Scene
        As it really stands.
    made : TruePrint
        The print of the run: ``TruePrint.of(scene.target, scene.board, seed)``.
    take : Take

    Returns
    -------
    TrueDots
        By the name under which the picture is delivered; `visible` where the whole outline is in the frame,
        the board is seen from its front, and nothing solid is in the way of any part of the dot (in the
        middle of the frame). A dot that no row sees is where it is in the middle of the frame.
    """
    radii = 0.5 * made.target.outer_diameters_mm()
    images = of_places(outlined_images(take.project, made.centres, made.outlines), radii)
    hidden = unseen(scene, made, take.track.T_world_target, viewpoints(take.device, images))
    return TrueDots(
        view=take.view,
        camera=take.camera,
        index=scene.target.indices(),
        point=take.track.carried(made.centres, np.nan_to_num(take.instants(made.centres))),
        centre=images.centre,
        centroid=images.centroid,
        visible=images.ok & take.device.in_picture(images.outline).all(axis=-1) & ~hidden,
    )


def true_view(takes: list[Take], cameras: dict[str, CameraRecord]) -> TrueView:
    """Return the true pose of the target in a view, and the true values of single pictures.

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
        (a, b, c), (d, e, f), (g, h, i) = take.device.K.tolist()
        K = ((a, b, c), (d, e, f), (g, h, i))
        own = TruePicture(
            taken_by=None if take.taken_by == take.camera else take.taken_by,
            T_cam_world=None if T_cam_world == cameras[take.camera].T_cam_world else T_cam_world,
            T_world_target=None if T_world_target_then == T_world_target else T_world_target_then,
            K=None if take.taken_by != take.camera or K == cameras[take.camera].K else K,
        )
        if own != TruePicture():
            pictures[take.camera] = own
    return TrueView(T_world_target=T_world_target, cameras=pictures)
