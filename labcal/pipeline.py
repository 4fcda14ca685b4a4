"""The chain from pictures to errors in millimetres, each step a function of plain values.

::

    render ─► SHOOT ─► detect ─► fit, or calibrate ─► reconstruct ─► evaluate

What a command does is the function of its name; the command line adds reading, writing and printing. What a
person should not miss is in the `warnings` of what is returned.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.points import Points
from labcal.correspond.view_roles import HoldOut, held_out_views
from labcal.errors import InputError
from labcal.estimators.model import Model
from labcal.run.progress import NoProgress, Progress
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role
from labcal.shoot.tone_curve import AnyToneCurve, ToneCurve
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces
from labcal.targets.target import Target

if TYPE_CHECKING:
    from labcal.calibrate.calibration import Calibration
    from labcal.calibrate.handheld import HandheldSettings
    from labcal.correspond.measure import Measurement, detections_of
    from labcal.correspond.sources import Source, find_sources
    from labcal.estimators.fitting import FitSettings, estimators_of, fit_methods, training_of
    from labcal.evaluate.against_truth import Alignment, TruthErrors
    from labcal.evaluate.own_lengths import LengthErrors
    from labcal.reconstruct.reconstruction import Reconstruction
    from labcal.render.shoot import RenderSettings

__all__ = [
    "FitSettings",
    "HandheldSettings",
    "RenderSettings",
    "calibrate",
    "detect",
    "detections_of",
    "epipolar_rms",
    "estimators_of",
    "evaluate",
    "find_sources",
    "fit",
    "fit_methods",
    "measure",
    "reconstruct",
    "render",
    "training_of",
]

_HOMES = {
    "FitSettings": "labcal.estimators.fitting",
    "HandheldSettings": "labcal.calibrate.handheld",
    "RenderSettings": "labcal.render.shoot",
    "detections_of": "labcal.correspond.measure",
    "estimators_of": "labcal.estimators.fitting",
    "find_sources": "labcal.correspond.sources",
    "fit_methods": "labcal.estimators.fitting",
    "training_of": "labcal.estimators.fitting",
}
"""Public names, imported when first asked for: detection needs no SciPy, a rig no scikit-learn."""


def __getattr__(name: str) -> object:
    """Return what is at home elsewhere."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted({*globals(), *_HOMES})


def render(scene: str, folder: Path, settings: "RenderSettings | None" = None) -> Shoot:
    """Render a scene, by name or from a YAML file, into a new shoot; see :func:`render_shoot` for errors."""
    from labcal.render.shoot import RenderSettings, render_shoot
    from labcal.scene.catalogue import load_scene

    return render_shoot(load_scene(scene), folder, settings or RenderSettings(), NoProgress())


def measure(
    sources: "Sequence[Source]",
    target: AnyTarget,
    workers: int = 1,
    progress: Progress | None = None,
    tone_curve: AnyToneCurve = ToneCurve.LINEAR,
) -> "list[Measurement]":
    """Find the dots in pictures; a picture that cannot be used is a result with a reason."""
    from labcal.correspond.measure import measure_pictures
    from labcal.run.executor import open_executor

    with open_executor(workers) as executor:
        return measure_pictures(sources, target, executor, progress or NoProgress(), tone_curve)


def detect(shoot: Shoot, workers: int = 1, progress: Progress | None = None) -> Detections:
    """Return the dots of a shoot, found by its own target; :func:`measure` tells of each picture.

    Raises
    ------
    InputError
        No picture could be read at all.
    """
    from labcal.correspond.measure import detections_of
    from labcal.correspond.sources import shoot_sources

    return detections_of(measure(shoot_sources(shoot), shoot.target, workers, progress))


def calibrate(
    source: Shoot | AnyTarget,
    detections: Detections,
    lens: str | None = None,
    settings: "HandheldSettings | None" = None,
    hold_out: HoldOut = (),
    progress: Progress | None = None,
) -> "Calibration":
    """Calibrate cameras from a target in the hand.

    Parameters
    ----------
    source : Shoot or AnyTarget
        A shoot, whose test views do not enter; or the target that the dots are of.
    detections : Detections
    lens, settings, hold_out, progress
        As in :func:`~labcal.calibrate.calibration.calibrated`, where errors are told, too.
    """
    from labcal.calibrate.calibration import calibrated

    if not isinstance(source, Shoot):
        return calibrated(detections, source, lens, settings, hold_out, progress)
    tested = {view.name for view in source.views(Role.TEST)}
    rest = [view for view in detections.views if view not in tested]
    kept_back = [
        view for view in detections.views if view in tested or view in held_out_views(rest, hold_out)
    ]
    return calibrated(detections, source.target, lens, settings, kept_back, progress)


def fit(
    source: Shoot | AnyTarget,
    detections: Detections,
    method: object = "hybrid",
    settings: "FitSettings | None" = None,
) -> Model:
    """Teach a method the dots of a target; :func:`fit_methods` teaches several the same :func:`training_of`.

    Parameters
    ----------
    source : Shoot or AnyTarget
        A shoot, of which training views are used; or the target, held in the hand in all views.
    detections : Detections
    method : str, type or object
        Its name; ``package.module:Class`` of a method of one's own; or an estimator or a class, of labcal's
        or with fit and predict as those of scikit-learn. What is given stays as it was: a copy learns.
    settings : FitSettings, optional

    Raises
    ------
    UnknownNameError, InputError
        There is no such method, or it cannot learn from these dots.
    """
    from labcal.estimators.fitting import FitSettings, estimators_of, fit_methods, training_of

    settings = settings or FitSettings()
    estimators = estimators_of([method], settings)
    (model,) = fit_methods(training_of(source, detections, settings), estimators, settings)
    if isinstance(model, InputError):
        raise model
    return model


def reconstruct(
    model: Model | Rig, detections: Detections, target: Target | None = None
) -> "Reconstruction":
    """Return the points of all dots that every camera measured; see :func:`reconstruct_centres`."""
    from labcal.reconstruct.reconstruction import reconstruct_centres
    from labcal.reconstruct.reconstruction_warnings import reconstruction_warnings

    found = reconstruct_centres(model, detections, target)
    known = None if target is None else target.name
    return replace(found, warnings=reconstruction_warnings(model, detections, found, known))


def evaluate(
    points: Points,
    source: Shoot | AnyTarget | DotPlaces,
    detections: Detections | None = None,
    alignment: "Alignment | None" = None,
    learned: Collection[str] | None = None,
) -> "TruthErrors | LengthErrors":
    """Return the errors of points, against the truth where a shoot has one, else against lengths.

    `learned` names the views that the cameras were calibrated from or the method was taught, where known:
    `calibrated_on` of the rig or model.
    """
    from labcal.evaluate.against_truth import errors_against_truth
    from labcal.evaluate.own_lengths import errors_of_lengths
    from labcal.evaluate.scored_views import ScoredViews
    from labcal.shoot.truth import has_truth

    if not isinstance(source, Shoot):
        return errors_of_lengths(points, source, learned)
    if has_truth(source.folder):
        return errors_against_truth(points, source, detections, alignment, learned)
    if learned is None:
        points = points.where(ScoredViews.by_role(points.view, source).holds(points.view))
    return errors_of_lengths(points, source.target, learned)


def epipolar_rms(rig: Rig, detections: Detections, target: AnyTarget | None = None) -> float:
    """Return the RMS distance of dots from the first camera's epipolar curves, px; NaN for one camera.

    The bias of centroids is taken off first where the target is given.
    """
    from labcal.calibrate.centre_bias import centred
    from labcal.cameras.triangulation import epipolar_distances
    from labcal.correspond.matching import match

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
