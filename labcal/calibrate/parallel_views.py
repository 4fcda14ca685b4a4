"""The refusal of a hand-held target's views whose rays are parallel, where those of the lens meet."""

from collections.abc import Sequence

import numpy as np

from labcal.calibrate.adjustment.observations import observations_of
from labcal.calibrate.adjustment.rounds import adjust_in_rounds
from labcal.calibrate.adjustment.state import Freedom, Lenses, RigState
from labcal.calibrate.lens_start import start_from_pictures
from labcal.calibrate.perspectivity import Perspectivity, Sight, parallel_error
from labcal.cameras.camera import Camera
from labcal.cameras.lens import TELECENTRIC
from labcal.correspond.detections import Detections
from labcal.correspond.gathering import joined
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.targets.catalogue import AnyTarget

_LONG_SIDES = 10.0
"""Focal length to begin with, over the picture's longer side, from which on rays may be parallel: of a
field of view below 6 degrees."""
_VIEWS = 12
"""Of these some tell as well as all."""


def refuse_parallel_views(
    pictures: Sequence[Detections], target: AnyTarget, first: Camera, eccentricity_rounds: int
) -> None:
    """Raise where the rays of a camera are parallel as far as its dots tell.

    Without it a focal length would grow for hundreds of steps, with every lens model that is tried, and what
    then does not fit would be taken for a camera that was moved.

    Parameters
    ----------
    pictures : sequence of Detections
        The dots of each view of one camera.
    target : AnyTarget
    first : Camera
        The camera to begin with; nothing is tested where its focal length is no long one.
    eccentricity_rounds : int
        Number of computations of the eccentricity.

    Raises
    ------
    InputError
        They are.
    """
    if first.model.parallel or max(first.intrinsics[:2]) < _LONG_SIDES * max(first.size):
        return
    some = list(pictures[:: -(-len(pictures) // _VIEWS)])
    dots = joined(some)
    observations = observations_of(dots, target, dots.cameras, dots.views)
    freedom = Freedom(Lenses.FREE, np.zeros((3 * target.count, 0)))
    radii = 0.5 * target.outer_diameters_mm()
    try:
        start = start_from_pictures(some, target, TELECENTRIC)
        state = RigState((start.camera,), start.T_cam_target, target.points())
        found = adjust_in_rounds(state, observations, freedom, radii, eccentricity_rounds)
    except InputError:  # no parallel rays see them so
        return
    centres = observations.moved(-found.eccentricity)
    sights = []
    for picture in centres.pictures:
        kept = np.arange(picture.rows.start, picture.rows.stop)[~found.outlier[picture.rows]]
        T = found.state.T_world_target[picture.view]
        sights.append(Sight(centres.q[kept], transform(T, found.state.dots[centres.dot[kept]])))
    camera = found.state.cameras[0]
    if Perspectivity.of(camera, [sight for sight in sights if len(sight.q)]).is_none(camera):
        raise parallel_error(f"Camera '{dots.cameras[0]}'")
