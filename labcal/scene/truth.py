"""What a picture truly shows, computed from the camera and the pose alone: no renderer takes part."""

from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import outlined_images
from labcal.geometry.poses import transform
from labcal.scene.model import Scene
from labcal.scene.print import TruePrint
from labcal.scene.views import PlannedView
from labcal.scene.visibility import unseen, viewpoints
from labcal.shoot.truth import TrueDots


def true_dots(scene: Scene, made: TruePrint, view: PlannedView, name: str, camera: Camera) -> TrueDots:
    """Return every dot of the target as one camera truly sees it.

    Parameters
    ----------
    scene : Scene
    made : TruePrint
        The print of the run: ``TruePrint.of(scene.target, scene.board, seed)``.
    view : PlannedView
    name : str
        Name of the camera.
    camera : Camera

    Returns
    -------
    TrueDots
        `visible` where the whole outline is in the frame, the board is seen from its front, and nothing solid
        is in the way of any part of the dot.
    """
    T_world_target = view.T_world_target
    centres = made.centres
    images = outlined_images(lambda p: camera.project(transform(T_world_target, p)), centres, made.outlines)
    hidden = unseen(scene, made, T_world_target, viewpoints(camera, images))
    return TrueDots(
        view=view.name,
        camera=name,
        index=scene.target.indices(),
        point=transform(T_world_target, centres),
        centre=images.centre,
        centroid=images.centroid,
        visible=images.ok & camera.in_picture(images.outline).all(axis=-1) & ~hidden,
    )
