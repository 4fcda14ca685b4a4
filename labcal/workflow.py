"""The chain from pictures to errors in millimetres, each step a function of plain values.

::

    render ─► SHOOT ─► detect ─► fit, or calibrate ─► reconstruct ─► evaluate

The command line adds reading, writing and printing.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from labcal.cameras.camera import Camera
from labcal.cameras.rig import CalibrationRecord, Rig
from labcal.cameras.triangulation import epipolar_distances
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.correspond.measure import Measurement, detections_of, measure_pictures
from labcal.correspond.points import ReconstructedPoints
from labcal.correspond.sources import Source, shoot_sources
from labcal.correspond.training import TrainingData, training_data
from labcal.evaluate.against_truth import Alignment, TruthErrors, errors_against_truth
from labcal.evaluate.own_lengths import LengthErrors, errors_of_lengths
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress, Progress
from labcal.scene.catalogue import load_scene
from labcal.shoot.dataset import Shoot
from labcal.shoot.tone_curve import AnyToneCurve, ToneCurve
from labcal.shoot.truth import has_truth
from labcal.solve.centre_bias import centred
from labcal.solve.centred_training import centred_training
from labcal.solve.estimator import PointEstimator
from labcal.solve.fitted_model import FittedModel, TrainingBox
from labcal.solve.handheld import calibrate_handheld as calibrate
from labcal.solve.handheld_training import handheld_training
from labcal.solve.reconstruction import reconstruct_points as reconstruct
from labcal.solve.rehearsal import Twin, fitted_beside, rehearse, twin_of
from labcal.targets.catalogue import AnyTarget

__all__ = [
    "calibrate",
    "centred_training",
    "detect",
    "epipolar_rms",
    "evaluate",
    "fit",
    "handheld_training",
    "measure",
    "reconstruct",
    "render",
    "training_data",
    "twin_of",
]


def render(scene: str, folder: Path, settings: RenderSettings | None = None) -> Shoot:
    """Render a scene, by name or from a YAML file, into a new shoot; see :func:`render_shoot` for errors."""
    return render_shoot(load_scene(scene), folder, settings or RenderSettings(), NoProgress())


def measure(
    sources: Sequence[Source],
    target: AnyTarget,
    workers: int = 1,
    progress: Progress | None = None,
    tone_curve: AnyToneCurve = ToneCurve.LINEAR,
) -> list[Measurement]:
    """Find the dots in pictures; a picture that cannot be used is a result with a reason."""
    with open_executor(workers) as executor:
        return measure_pictures(sources, target, executor, progress or NoProgress(), tone_curve)


def detect(shoot: Shoot, workers: int = 1, progress: Progress | None = None) -> Detections:
    """Return the dots of a shoot, found by its own target.

    Raises
    ------
    InputError
        No picture could be read at all.
    """
    return detections_of(measure(shoot_sources(shoot), shoot.target, workers, progress))


def fit(
    data: TrainingData,
    estimator: PointEstimator,
    resected: tuple[Camera, ...] | None = None,
    twin: Twin | None = None,
    calibration: CalibrationRecord | None = None,
) -> FittedModel:
    """Teach a method the dots of the training views, whose places the stage tells.

    `resected` are the cameras of :func:`centred_training`, where it gave the data; `twin` is where the method
    is rehearsed, so that it is known whether to trust it; `calibration` is how well the cameras agree, from
    where they come.
    """
    if "image_sizes" in estimator.get_params():
        estimator.set_params(image_sizes=data.image_sizes)
    box = TrainingBox.of(data.X, data.Y)
    fitted = fitted_beside(twin, estimator, data.X, data.Y)
    rehearsed = None if twin is None else rehearse(fitted, twin)
    return FittedModel(fitted, data.cameras, data.image_sizes, box, resected, rehearsed, calibration)


def evaluate(
    points: ReconstructedPoints,
    shoot: Shoot,
    detections: Detections | None = None,
    alignment: Alignment | None = None,
) -> TruthErrors | LengthErrors:
    """Return the errors of points, against the truth where the shoot has one, else against lengths."""
    if has_truth(shoot.folder):
        return errors_against_truth(points, shoot, detections, alignment)
    return errors_of_lengths(points, shoot.target)


def epipolar_rms(rig: Rig, detections: Detections, target: AnyTarget | None = None) -> float:
    """Return the RMS distance of dots from the first camera's epipolar curves, px; NaN for one camera.

    The bias of centroids is taken off first where the target is given.
    """
    first, *others = rig.cameras
    distances = [np.empty(0)]
    for other in others:
        pair = (rig.camera(first), rig.camera(other))
        matches = match(detections, (first, other))
        if target is not None:
            matches, _ = centred(pair, matches, target)
        distances.append(epipolar_distances(*pair, matches.q[:, 0], matches.q[:, 1]))
    all_distances = np.concatenate(distances)
    known = all_distances[np.isfinite(all_distances)]
    return float(np.sqrt((known**2).mean())) if len(known) else float("nan")
