"""The pictures of a scene: cameras, views, and true poses at each time."""

import numpy as np

from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.scene.mistakes import Mistake, Outcome, Shooting, make_mistake, printed_target
from labcal.scene.model import Scene
from labcal.scene.motion import ShutterTimes, Track
from labcal.scene.placement import Stage
from labcal.scene.take import Take
from labcal.scene.views import PlannedView
from labcal.shoot.manifest import Role


def built_scene(scene: Scene) -> Scene:
    """Return the scene as built, with another print if the mistake is one of the print.

    Raises
    ------
    InputError
        The mistake changes the print, and its code would describe the changed one, which no real print does.
    """
    if scene.mistake is Mistake.WRONG_PITCH and scene.board.print_number is not None:
        raise InputError(
            f"In the scene '{scene.name}' the mistake '{scene.mistake}' is made with a board whose print has "
            "a code, and that would describe the wrong board. Leave out board.print_number, or scale the "
            "whole print with board.print_scale in place of the mistake."
        )
    return scene.model_copy(
        update={"target": printed_target(scene.target, scene.mistake, scene.mistake_size or 1.0)}
    )


def planned_takes(scene: Scene, views: tuple[PlannedView, ...], seed: int) -> Outcome:
    """Return the pictures of views as taken, view by view, camera by camera.

    Parameters
    ----------
    scene : Scene
        As it is described.
    views : tuple of PlannedView
        The views that are taken; a mistake between views is made in the middle of these.
    seed : int
        Seed of the run; chance in a mistake is drawn from it.

    Raises
    ------
    InputError
        A camera is impossible, or the scene's mistake cannot be made with these views and cameras.
    """
    cameras = scene.true_cameras()
    takes = tuple(
        Take(view.name, name, name, camera, _track(scene, view), _shutter(scene, camera.size[1]))
        for view in views
        for name, camera in cameras.items()
    )
    if scene.mistake is None:
        return Outcome(takes)
    training = frozenset(view.name for view in views if view.role is Role.TRAIN)
    shooting = Shooting(takes, isinstance(scene.placement, Stage), training, seed, scene.mistake_size or 1.0)
    return make_mistake(scene.mistake, shooting)


def _track(scene: Scene, view: PlannedView) -> Track:
    """Return the motion of the target in a view."""
    x_min, y_min, x_max, y_max = built_scene(scene).target.extent_mm
    middle = np.array([0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.0])
    return Track(
        T_world_target=view.T_world_target,
        middle=transform(view.T_world_target, middle),
        velocity=np.array(scene.motion.velocity_mm_s),
        rotation=np.radians(scene.motion.rotation_deg_s),
    )


def _shutter(scene: Scene, rows: int) -> ShutterTimes:
    """Return the exposure times of the rows of a picture."""
    return ShutterTimes(1e-3 * scene.photometry.exposure_ms, 1e-3 * scene.readout_ms, rows)
