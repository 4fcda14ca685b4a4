"""Fixed marks made ready for the test of a calibration: their places have the errors of the rig, too."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from labcal.arrays import PointCovariances, Vectors3
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.state import Layout, RigState
from labcal.calibrate.validity.change import Change
from labcal.calibrate.validity.explanation import Calibrated, Explanation, explained
from labcal.calibrate.validity.mark_views import MarkViews
from labcal.calibrate.validity.prepared import Prepared, covariance_of, require_cameras, unexplained
from labcal.calibrate.validity.room import ROOM, in_room, rig_positions
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import PointFlag
from labcal.distributions import gain_tail
from labcal.errors import InputError
from labcal.geometry.covariances import positive_definite
from labcal.wording import counted, listed

FEWEST_MARKS = 4
"""That a camera has to see."""
_CHANCE = 1e-3
"""Probability, all marks together, below which a mark is held to have moved itself."""
_MOST_MOVED = 0.2
"""Share of the marks that may have moved themselves."""


def prepared_by_marks(rig: Rig, pixels: NamedPixels, places: NamedPoints) -> Prepared:
    """Return new pictures of fixed marks ready for the test.

    Parameters
    ----------
    rig : Rig
        With its covariance.
    pixels : NamedPixels
        Of marks in new pictures, with covariances.
    places : NamedPoints
        The marks as this rig measured them before; several views of one mark are averaged.

    Raises
    ------
    InputError
        The rig states no covariance, has not the cameras of the pixels, or too few marks are known.

    Notes
    -----
    Where the calibration is off by x, it measured places that are off by D x, besides their noise: x and the
    errors of the places have one covariance, by which most errors of the calibration cancel.
    """
    covariance = covariance_of(rig)
    require_cameras(rig, pixels.cameras)
    names, point, stated = _known_marks(places)
    cameras = tuple(rig.camera(name) for name in rig.cameras)
    seen, views = _observations(rig, pixels, names)
    state = RigState(in_room(cameras), np.tile(np.eye(4), (len(views), 1, 1)), point)
    imaged = np.isfinite(state.residuals(seen)).all(axis=1)
    seen = seen.where(imaged)
    _require_marks(rig, seen)
    used = np.unique(seen.dot)
    seen = replace(seen, dot=np.searchsorted(used, seen.dot))
    state = replace(state, dots=point[used])
    joint = _joint(Layout(state, MarkViews(seen).freedom(state)), covariance.matrix, stated[used])
    distance = float(np.median(np.linalg.norm(state.dots, axis=1)))
    return Prepared(
        Calibrated(state, joint, distance),
        MarkViews(seen),
        views,
        tuple(np.unique(seen.camera).tolist()),
        int((~imaged).sum()),
        (),
        poses=0,
        camera_names=(ROOM, *rig.cameras),
        marks=tuple(np.array(names)[used].tolist()),
        view_factor=covariance.view_factor,
    )


def cleaned_marks(made: Prepared, anything: Change) -> tuple[Prepared, Explanation]:
    """Return marks without those that moved themselves, with their noise, and what explains them best.

    Raises
    ------
    InputError
        No rig explains the pixels.

    Notes
    -----
    Noise that is larger than stated beyond chance is found from the residuals, and the test is then an F test
    with their degrees of freedom.
    """
    found = explained(made.calibrated, anything, made.views)
    most = int(_MOST_MOVED * len(made.marks))
    moved: list[str] = []
    while found is not None and len(moved) < most and _excess_is_beyond_chance(made, found, anything):
        less = _without_worst(made, found, anything)
        if less is None:
            break
        moved += [name for name in made.marks if name not in less[0].marks]
        made, found = less
    if found is None:
        raise unexplained()
    if moved:
        words = f"{counted(len(moved), 'mark')} left out, no longer in place: {listed(moved)}"
        made = replace(made, skipped=(*made.skipped, words))
    freedom = _freedom(made, anything)
    excess = found.cost / freedom
    if not _excess_is_beyond_chance(made, found, anything):
        return replace(made, excess=excess), found
    made = replace(made, views=made.views.noisier(excess), excess=excess, noise_freedom=float(freedom))
    again = explained(made.calibrated, anything, made.views)
    return made, found if again is None else again


def _known_marks(places: NamedPoints) -> tuple[tuple[str, ...], Vectors3, PointCovariances]:
    """Return names, places and covariances of marks, those of several views averaged."""
    good = (places.flag == PointFlag.OK.value) & positive_definite(places.covariance)
    if not good.any():
        raise InputError(
            "No place of a mark is usable: each needs the flag 'ok' and a covariance. Measure the marks with "
            "this rig, as `labcal measure` does."
        )
    names = tuple(dict.fromkeys(places.name[good].tolist()))
    numbers = np.array([names.index(name) for name in places.name[good].tolist()])
    point, stated = np.zeros((len(names), 3)), np.zeros((len(names), 3, 3))
    count = np.bincount(numbers)
    np.add.at(point, numbers, places.point[good])
    np.add.at(stated, numbers, places.covariance[good])
    return names, point / count[:, None], stated / count[:, None, None]


def _observations(
    rig: Rig, pixels: NamedPixels, names: tuple[str, ...]
) -> tuple[Observations, tuple[str, ...]]:
    """Return the pixels of known marks, and the names of the views."""
    known = {name: number for number, name in enumerate(names)}
    measured = np.isfinite(pixels.position).all(axis=1)
    measured &= np.array([name in known for name in pixels.point.tolist()], dtype=bool)
    bare = measured & ~positive_definite(pixels.covariance)
    if bare.any():
        raise InputError(
            f"{counted(int(bare.sum()), 'pixel')} of marks without a covariance: a test needs their noise. "
            "Give var_xx, var_xy and var_yy in the table."
        )
    cameras = {name: number for number, name in enumerate(rig.cameras, start=1)}
    camera = np.array([cameras[name] for name in pixels.camera[measured].tolist()], dtype=np.int64)
    views = tuple(dict.fromkeys(pixels.view[measured].tolist()))
    numbers = {name: number for number, name in enumerate(views)}
    view = np.array([numbers[name] for name in pixels.view[measured].tolist()], dtype=np.int64)
    mark = np.array([known[name] for name in pixels.point[measured].tolist()], dtype=np.int64)
    order = np.lexsort((mark, view, camera))
    q, covariance = pixels.position[measured][order], pixels.covariance[measured][order]
    return Observations(camera[order], view[order], mark[order], q, covariance), views


def _require_marks(rig: Rig, seen: Observations) -> None:
    """Raise where a camera sees too few marks."""
    for number in np.unique(seen.camera).tolist() or [1]:
        count = len(np.unique(seen.dot[seen.camera == number]))
        if count < FEWEST_MARKS:
            raise InputError(
                f"Camera '{tuple(rig.cameras)[number - 1]}' sees {counted(count, 'mark')} of known place; "
                f"a check needs {FEWEST_MARKS} or more. Check that the places are those of the marks in "
                "these pictures, by the same names."
            )


def _joint(
    layout: Layout, covariance: Float64[np.ndarray, "rig rig"], stated: PointCovariances
) -> Float64[np.ndarray, "shared shared"]:
    """Return the joint covariance of the rig in its room and of the marks.

    What a mark's covariance holds beyond the calibration is its own noise; one that holds less is of noise
    alone.
    """
    state, cameras = layout.state, layout.state.cameras[1:]
    at, n = rig_positions(state), len(state.dots)
    pixels = np.tile(np.eye(2), (n, len(cameras), 1, 1))
    for number, camera in enumerate(cameras):
        image = camera.project(state.dots)
        pixels[~(image.ok & camera.in_picture(image.q)), number] = np.nan
    D = np.nan_to_num(triangulation_derivatives(cameras, state.dots, pixels)).reshape(3 * n, -1)
    reach = np.zeros((layout.count, len(at)))
    reach[at, np.arange(len(at))] = 1.0
    reach[layout.dots] = D
    joint = reach @ covariance @ reach.T
    for mark, whole in enumerate(stated):
        place = slice(layout.dots.start + 3 * mark, layout.dots.start + 3 * mark + 3)
        noise = whole - joint[place, place]
        spread, axes = np.linalg.eigh(noise)
        own = whole if np.trace(noise) <= 0.0 else (axes * np.maximum(spread, 0.0)) @ axes.T
        joint[place, place] += own
    return np.asarray(0.5 * (joint + joint.T))


def _freedom(made: Prepared, anything: Change) -> int:
    """Return the degrees of freedom of the cost where anything may have changed; marks have a prior."""
    return max(1, made.freedom - anything.count)


def _excess_is_beyond_chance(made: Prepared, found: Explanation, anything: Change) -> bool:
    """Return whether residuals are larger than their covariances explain but once in a thousand checks."""
    return gain_tail(found.cost, _freedom(made, anything), np.inf) < _CHANCE


def _without_worst(
    made: Prepared, found: Explanation, anything: Change
) -> tuple[Prepared, Explanation] | None:
    """Return the marks without the one that explains most by having moved itself; None if none stands out."""
    best: tuple[Prepared, Explanation] | None = None
    seen = made.views.observations
    for mark in np.unique(seen.dot).tolist():
        without = replace(made.views, observations=seen.where(seen.dot != mark))
        tried = explained(made.calibrated, anything, without, start=found.errors)
        if tried is None or (best is not None and tried.cost >= best[1].cost):
            continue
        names = (*made.marks[:mark], "", *made.marks[mark + 1 :])
        best = replace(made, views=without, marks=names, outliers=made.outliers + 1), tried
    if best is None:
        return None
    gone = len(seen) - len(best[0].views.observations)
    chance = len(made.marks) * gain_tail(max(0.0, found.cost - best[1].cost), 2 * gone, np.inf)
    return best if chance < _CHANCE else None
