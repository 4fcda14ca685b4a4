"""The laboratory of a plan: the scene in which its cameras and its target are rendered."""

from labcal.guide.rehearsal.rig_plan import CameraPlace, PairGeometry, RigPlan
from labcal.scene.board import Board
from labcal.scene.lamps import Ambient
from labcal.scene.model import Scene
from labcal.scene.placement import Handheld
from labcal.scene.room import Room

_FAR_AWAY = 20.0
"""Distance of floor and wall, as a multiple of the volume's far end."""
_NO_LESS_MM = 3000.0


def places(plan: RigPlan) -> dict[str, CameraPlace]:
    """Return the place of every camera, in the plan's frame."""
    geometry = plan.geometry
    if not isinstance(geometry, PairGeometry):
        return {name: geometry.places[name] for name in plan.cameras}
    found = {}
    for name, side in zip(plan.cameras, (-0.5, 0.5), strict=True):
        x = side * geometry.baseline_mm
        aim = (0.0, 0.0, geometry.convergence_mm) if geometry.convergence_mm else (x, 0.0, 1000.0)
        found[name] = CameraPlace(eye_mm=(x, 0.0, 0.0), look_at_mm=aim)
    return found


def laboratory(plan: RigPlan, views: int) -> Scene:
    """Return the scene of a plan with a target held in the hand, which is lit evenly from everywhere.

    The scene's Z points up: a point (x, y, z) of the plan is at (x, z, -y) there.

    Parameters
    ----------
    plan : RigPlan
    views : int
        Views to calibrate from.
    """
    volume, shoot = plan.volume, plan.shoot
    far = max(_NO_LESS_MM, _FAR_AWAY * abs(volume.far_mm))
    cameras = {}
    for name, place in places(plan).items():
        eye, focus, up = (_in_scene(v) for v in (place.eye_mm, place.look_at_mm, place.up))
        cameras[name] = plan.cameras[name].described(eye, focus, up)
    return Scene(
        name=plan.name,
        description=plan.description,
        target=plan.target,
        cameras=cameras,
        placement=Handheld(
            kind="handheld",
            train=views,
            test=0,
            centre_mm=_in_scene((*volume.centre_mm, 0.5 * (volume.near_mm + volume.far_mm))),
            spread_mm=(
                0.5 * volume.width_mm,
                0.5 * (volume.far_mm - volume.near_mm),
                0.5 * volume.height_mm,
            ),
            tilt_max_deg=shoot.tilt_max_deg,
            roll_max_deg=shoot.roll_max_deg,
            visible_share=shoot.visible_share,
        ),
        lamps=(Ambient(kind="ambient", radiance=1.0),),
        room=Room(floor_z_mm=-far, wall_y_mm=far, table_z_mm=0.9 * -far),
        board=Board(misplacement_mm=plan.print_sigma_mm),
        photometry=plan.photometry,
    )


def _in_scene(v: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = v
    return (x, z, -y)
