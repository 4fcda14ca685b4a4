"""The confirmation of a rehearsal: render, detect, calibrate, measure, and compare with the forecast."""

from pathlib import Path

import numpy as np

from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.dot_image import dot_images
from labcal.cameras.rig_file import write_rig
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import write_detections
from labcal.correspond.dot_source import dots_of_shoot
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.guide.rehearsal.confirmation import Confirmation, expected_length, rms_coordinate, rms_length
from labcal.guide.rehearsal.dot_noise import minor_semi_axes
from labcal.guide.rehearsal.forecast import Sources, forecast, range_of_one
from labcal.guide.rehearsal.laboratory import laboratory
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.guide.rehearsal.settings import RehearseSettings
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.reconstruct.reconstruction import reconstruct_points
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.run.progress import Progress
from labcal.scene.model import Scene
from labcal.shoot.manifest import Role
from labcal.shoot.truth import TrueDots, read_true_dots, read_truth

TEST_VIEWS = 4
"""Further views, whose dots are measured."""
SHOOT, DETECTIONS, RIG = "shoot", "detections.csv", "calibrated.json"
Sizes = dict[tuple[str, str], np.ndarray]
"""Minor semi-axes of dots by view and camera, px."""


def confirmed(found: Rehearsal, folder: Path, how: RehearseSettings, progress: Progress) -> Confirmation:
    """Render the views of a plan and further ones into a folder, and compare errors with the forecast.

    The views are chosen together with the further ones, so that they differ from those of the rehearsal; the
    forecast that is compared is made for them.

    Parameters
    ----------
    found : Rehearsal
    folder : Path
        Where the shoot, its dots and its calibrated rig are written.
    how : RehearseSettings
    progress : Progress

    Raises
    ------
    InputError
        Too few dots of the further views were measured in all cameras.
    OutputError, DeviceError
        As of rendering.
    """
    plan = found.plan
    rendering = RenderSettings(spp=how.spp, seed=how.seed, workers=how.workers)
    shoot = render_shoot(_scene(found), folder / SHOOT, rendering, progress)
    dots = dots_of_shoot(shoot, how.workers, progress)
    write_detections(folder / DETECTIONS, dots, force=True)
    settings = HandheldSettings(
        dot_places=DotTreatment.FREED if plan.shoot.free_dots else DotTreatment.DECLARED
    )
    testing = {view.name for view in shoot.views(Role.TEST)}
    tested = np.isin(dots.view, sorted(testing))
    lens = next(iter(plan.cameras.values())).lens
    rig = calibrate_handheld(dots.where(~tested), plan.target, lens, settings).rig
    write_rig(folder / RIG, rig, force=True)
    truth, planned = read_truth(shoot.folder), PlannedRig.of(plan)
    T_first_world = np.array(next(iter(truth.cameras.values())).T_cam_world)
    T_first_target = {
        name: T_first_world @ np.array(view.T_world_target) for name, view in truth.views.items()
    }
    training = [T_first_target[view.name] for view in shoot.views(Role.TRAIN)]
    made = forecast(planned, training, Sources.of(plan, found.noise))
    true = {(one.view, one.camera): one for one in read_true_dots(shoot.folder)}
    points = reconstruct_points(rig, dots.where(tested), plan.target)
    first = next(iter(truth.cameras))
    good = np.isfinite(points.point).all(axis=1)
    if not good.any():
        raise InputError("No dot of the further views was measured in all cameras of the rendered shoot.")
    number = points.index[:, 1] * plan.target.cols + points.index[:, 0]
    places = np.array(
        [true[view, first].point[i] for view, i in zip(points.view.tolist(), number.tolist(), strict=True)]
    )
    p = transform(T_first_world, places)[good]
    sizes = _sizes(planned, T_first_target)
    pairs = list(zip(points.view[good].tolist(), number[good].tolist(), strict=True))
    size = [np.array([sizes[view, name][i] for view, i in pairs]) for name in planned.rig.cameras]
    pixels = np.stack([found.noise.covariances(one) for one in size], axis=1)
    budget = PointBudget.of(
        planned.rig.model_copy(update={"covariance": made.covariance}), p, pixels, Budget.FULL
    )
    lowest, highest = range_of_one(budget)
    error_px, expected_px = _pixel_errors(dots, true, sizes, found)
    return Confirmation(
        views=len(training),
        points=int(good.sum()),
        dot_rms_px=error_px,
        dot_expected_px=expected_px,
        rms_mm=rms_length(points.point[good] - p),
        expected_mm=expected_length(budget.noise + budget.calibration),
        lowest_mm=lowest,
        highest_mm=highest,
    )


def _scene(found: Rehearsal) -> Scene:
    """Return the laboratory with further views."""
    scene = laboratory(found.plan, found.plan.shoot.views)
    return scene.model_copy(update={"placement": scene.placement.model_copy(update={"test": TEST_VIEWS})})


def _sizes(planned: PlannedRig, T_first_target: dict[str, np.ndarray]) -> Sizes:
    """Return the minor semi-axes of all dots, px, by view and camera."""
    target = planned.plan.target
    radii = 0.5 * target.outer_diameters_mm()
    return {
        (view, name): minor_semi_axes(dot_images(camera, T, target.points(), radii).outline)
        for view, T in T_first_target.items()
        for name, camera in zip(planned.rig.cameras, planned.cameras, strict=True)
    }


def _pixel_errors(
    dots: Detections, true: dict[tuple[str, str], TrueDots], sizes: Sizes, found: Rehearsal
) -> tuple[float, float]:
    """Return the RMS error of a coordinate of all measured dots, px, and the foretold one."""
    errors, variances = [], []
    for (view, camera), picture in true.items():
        mine = (dots.view == view) & (dots.camera == camera) & (dots.flag == "ok") & dots.has_id
        number = dots.index[mine, 1] * found.plan.target.cols + dots.index[mine, 0]
        errors.append(dots.position[mine] - picture.centroid[number])
        variances.append(found.noise.at(sizes[view, camera][number]))
    return rms_coordinate(np.concatenate(errors)), float(np.sqrt(np.concatenate(variances).mean()))
