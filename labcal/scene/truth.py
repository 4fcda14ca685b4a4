"""What a picture truly shows, computed from the camera and the pose alone: no renderer takes part."""

from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.geometry.poses import transform
from labcal.scene.views import PlannedView
from labcal.shoot.truth import TrueDots
from labcal.targets.grid import DotGrid


def true_dots(target: DotGrid, view: PlannedView, name: str, camera: Camera) -> TrueDots:
    """Return every dot of the target as one camera truly sees it.

    Parameters
    ----------
    target : DotGrid
    view : PlannedView
    name : str
        Name of the camera.
    camera : Camera

    Returns
    -------
    TrueDots
        `visible` where the whole outline is in the frame and the board is seen from its front.
    """
    centres = target.points()
    images = dot_images(camera, view.T_world_target, centres, 0.5 * target.outer_diameters_mm())
    front = float((camera.centre - view.T_world_target[:3, 3]) @ view.T_world_target[:3, 2]) > 0.0
    return TrueDots(
        view=view.name,
        camera=name,
        index=target.indices(),
        point=transform(view.T_world_target, centres),
        centre=images.centre,
        centroid=images.centroid,
        visible=images.ok & camera.in_picture(images.outline).all(axis=-1) & front,
    )
