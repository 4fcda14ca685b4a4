"""The confirmation of a rehearsal: render, detect, calibrate, measure, and compare with the forecast."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.rig_file import write_rig
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import write_detections
from labcal.correspond.dot_source import dots_of_shoot
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.geometry.poses import rigid_alignment, transform
from labcal.guide.rehearsal.confirmation import (
    Confirmation,
    FoundError,
    group_rank,
    lowest_rank,
    rms_coordinate,
    squares,
)
from labcal.guide.rehearsal.error_scatter import ErrorScatter
from labcal.guide.rehearsal.forecast import forecast
from labcal.guide.rehearsal.held_points import HeldPoints
from labcal.guide.rehearsal.held_scene import held_scene
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.guide.rehearsal.renderer_noise import rendered_noise, renderer_sigma
from labcal.guide.rehearsal.settings import RehearseSettings
from labcal.guide.rehearsal.sources import Sources
from labcal.reconstruct.reconstruction import reconstruct_points
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.run.progress import Progress
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role
from labcal.shoot.truth import TrueDots, read_true_dots, read_truth

SHOOT, DETECTIONS, RIG = "shoot", "detections.csv", "calibrated.json"
_FEWEST = 3
"""Points that a rigid alignment needs."""


@dataclass(frozen=True)
class RenderedSet:
    """Errors of one rendered set.

    Attributes
    ----------
    places : float64 array, (n,)
        Squared errors of the dots of all views in the frame of the first camera, mm squared; NaN where a dot
        was not measured.
    shape, map : float64 array, (n,)
        The same after a rigid alignment of the dots of the test views, and of all views.
    pixels : float64 array, (m, 2)
        Errors of all measured dots, px.
    pixel_variance : float64 array, (m,)
        Their foretold variances, px squared.
    freed : bool
        True if the calibration freed the dots.
    """

    places: Float64[np.ndarray, " n"]
    shape: Float64[np.ndarray, " n"]
    map: Float64[np.ndarray, " n"]
    pixels: Float64[np.ndarray, "m 2"]
    pixel_variance: Float64[np.ndarray, " m"]
    freed: bool


def confirmed(found: Rehearsal, folder: Path, how: RehearseSettings, progress: Progress) -> Confirmation:
    """Render the recommended views and further ones into a folder, and compare errors with the forecast.

    Every set has the same poses, and a print and noise of its own. It is calibrated as `labcal calibrate`
    does. What is foretold here has the noise of the renderer's finitely many rays in it.

    Parameters
    ----------
    found : Rehearsal
    folder : Path
        Where shoots, dots and calibrated rigs are written; of several sets each has a folder of its own.
    how : RehearseSettings
        `confirm` is the number of sets.
    progress : Progress

    Raises
    ------
    InputError
        Too few dots of the further views were measured in all cameras.
    OutputError, DeviceError
        As of rendering.
    """
    noise = rendered_noise(found.noise, how.spp)
    made = forecast(PlannedRig.of(found.plan), list(found.views), Sources.of(found.plan, noise))
    rig, points = found.rig.model_copy(update={"covariance": made.covariance}), HeldPoints.of(found, noise)
    sets = []
    for number in range(how.confirm):
        own = folder if how.confirm == 1 else folder / f"set-{number + 1:02d}"
        own.mkdir(exist_ok=True)
        sets.append(_rendered(found, points, own, how, number, progress))
    places, shape, over_map = (
        np.stack([getattr(one, name) for one in sets]) for name in ("places", "shape", "map")
    )
    known = np.isfinite(places).any(axis=0)
    measured = known & points.tested
    if measured.sum() < _FEWEST:
        raise InputError("No dot of the further views was measured in all cameras of the rendered shoot.")
    budget = points.budget(rig, measured)
    foretold = points.shape_covariances(points.budget(rig, known))
    return Confirmation(
        sets=len(sets),
        views=len(found.views),
        points=int(np.isfinite(places[:, points.tested]).sum()),
        freed=sum(one.freed for one in sets),
        renderer_px=float(renderer_sigma(np.array([found.noise.size_px]), how.spp)[0]),
        dot_rms_px=rms_coordinate(np.concatenate([one.pixels for one in sets])),
        dot_expected_px=float(np.sqrt(np.concatenate([one.pixel_variance for one in sets]).mean())),
        places=FoundError.of(places[:, measured], ErrorScatter.of_places(budget)),
        shape=FoundError.of(shape[:, measured], ErrorScatter.of_shape(budget)),
        map_rank=group_rank(over_map[:, known], np.trace(foretold, axis1=1, axis2=2)),
        map_rank_lowest=lowest_rank(foretold, len(sets)),
    )


def _rendered(
    found: Rehearsal, points: HeldPoints, folder: Path, how: RehearseSettings, number: int, progress: Progress
) -> RenderedSet:
    plan = found.plan
    rendering = RenderSettings(spp=how.spp, seed=how.seed + number, workers=how.workers)
    shoot = render_shoot(held_scene(found), folder / SHOOT, rendering, progress)
    dots = dots_of_shoot(shoot, how.workers, progress)
    write_detections(folder / DETECTIONS, dots, force=True)
    tested = np.isin(dots.view, [view.name for view in shoot.views(Role.TEST)])
    lens = next(iter(plan.cameras.values())).lens
    settings = HandheldSettings(dot_places=plan.shoot.dot_places)
    calibration = calibrate_handheld(dots.where(~tested), plan.target, lens, settings)
    write_rig(folder / RIG, calibration.rig, force=True)
    measured = reconstruct_points(calibration.rig, dots, plan.target)
    errors = _point_errors(measured, shoot, points)
    return RenderedSet(*errors, *_pixel_errors(dots, shoot, points), calibration.freed is not None)


def _point_errors(
    measured: Points, shoot: Shoot, points: HeldPoints
) -> tuple[Float64[np.ndarray, " n"], Float64[np.ndarray, " n"], Float64[np.ndarray, " n"]]:
    """Return squared errors of all dots in order: as they are, and after both rigid alignments."""
    truth = read_truth(shoot.folder)
    first, T_first_world = next((name, np.array(one.T_cam_world)) for name, one in truth.cameras.items())
    true = {one.view: one.point for one in read_true_dots(shoot.folder) if one.camera == first}
    names = {view.name: number for number, view in enumerate(shoot.views())}
    good = np.isfinite(measured.point).all(axis=1)
    p, view = measured.point[good], measured.view[good].tolist()
    dot = measured.index[good, 1] * points.cols + measured.index[good, 0]
    exact = transform(
        T_first_world, np.array([true[name][i] for name, i in zip(view, dot.tolist(), strict=True)])
    )
    line = np.array([names[name] for name in view]) * len(true[view[0]]) + dot
    tested = points.tested[line]
    if tested.sum() < _FEWEST:
        raise InputError("No dot of the further views was measured in all cameras of the rendered shoot.")
    aligned = [transform(rigid_alignment(exact[of], p[of]), p) for of in (tested, np.ones(len(p), bool))]
    found = []
    for places in (p, *aligned):
        square = np.full(len(points.tested), np.nan)
        square[line] = squares(places - exact)
        found.append(square)
    return found[0], found[1], found[2]


def _pixel_errors(
    dots: Detections, shoot: Shoot, points: HeldPoints
) -> tuple[Float64[np.ndarray, "m 2"], Float64[np.ndarray, " m"]]:
    """Return the errors of all measured dots, px, and their foretold variances."""
    errors, variances = [], []
    true: list[TrueDots] = read_true_dots(shoot.folder)
    for picture in true:
        mine = (dots.view == picture.view) & (dots.camera == picture.camera) & (dots.flag == "ok")
        mine &= dots.has_id
        number = dots.index[mine, 1] * points.cols + dots.index[mine, 0]
        errors.append(dots.position[mine] - picture.centroid[number])
        variances.append(points.variance[picture.view, picture.camera][number])
    return np.concatenate(errors), np.concatenate(variances)
