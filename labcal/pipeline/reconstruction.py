"""Points from dots."""

import os
from dataclasses import replace
from typing import TYPE_CHECKING, overload

from labcal.arguments import choice_of
from labcal.cameras.rig import Rig
from labcal.correspond.boards_points import points_of_boards
from labcal.correspond.boards_table import in_one_frame
from labcal.correspond.detections import Detections
from labcal.correspond.dot_source import DotSource, open_dots
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_pixels_csv import is_pixels
from labcal.errors import InputError
from labcal.estimators.model import Model
from labcal.paths import AnyPath, as_path
from labcal.pipeline.given import dots_of
from labcal.pipeline.named_points import measure
from labcal.run.progress import Progress, progress_of
from labcal.shoot.dataset import Shoot
from labcal.targets.board_set import BoardSet
from labcal.targets.catalogue import AnyTargets
from labcal.targets.target import PrintableTarget, Target

if TYPE_CHECKING:
    from labcal.reconstruct.measure_settings import MeasureSettings
    from labcal.reconstruct.named_reconstruction import NamedReconstruction
    from labcal.reconstruct.point_budget import Budget
    from labcal.reconstruct.reconstruction import Reconstruction


@overload
def reconstruct(
    model: Model | Rig | AnyPath,
    detections: NamedPixels,
    target: Target | AnyTargets | None = None,
    progress: Progress | None = None,
    settings: "MeasureSettings | None" = None,
    *,
    budget: "Budget | str | None" = None,
) -> "NamedReconstruction": ...


@overload
def reconstruct(
    model: Model | Rig | AnyPath,
    detections: Detections | Shoot,
    target: Target | AnyTargets | None = None,
    progress: Progress | None = None,
    settings: "MeasureSettings | None" = None,
    *,
    budget: "Budget | str | None" = None,
) -> "Reconstruction": ...


@overload
def reconstruct(
    model: Model | Rig | AnyPath,
    detections: AnyPath,
    target: Target | AnyTargets | None = None,
    progress: Progress | None = None,
    settings: "MeasureSettings | None" = None,
    *,
    budget: "Budget | str | None" = None,
) -> "Reconstruction | NamedReconstruction": ...


def reconstruct(
    model: Model | Rig | AnyPath,
    detections: Detections | NamedPixels | Shoot | AnyPath,
    target: Target | AnyTargets | None = None,
    progress: Progress | None = None,
    settings: "MeasureSettings | None" = None,
    *,
    budget: "Budget | str | None" = None,
) -> "Reconstruction | NamedReconstruction":
    """Return the points of all dots that every camera measured, or those of named pixels.

    Parameters
    ----------
    model : Model, Rig or path
        A fitted method or cameras, or the file of them.
    detections : Detections, NamedPixels, Shoot or path
        Dots, or the table of them; or a shoot or its folder, in whose pictures they are found. Named pixels,
        or the table of them, are reconstructed as by :func:`measure`.
    target : Target, str or sequence of these, optional
        What the dots are of, so that centroids give centres; several in a list are boards side by side. If
        left out, that of the shoot, or else the one that the rig was calibrated with. With named pixels, the
        target that lies in the frame.
    progress : Progress, optional
        Of the detection.
    settings : MeasureSettings, optional
        Of named pixels alone.
    budget : {"full", "noise"}, optional
        The sources of errors in the covariances of a rig's points: noise of the pixels and the calibration,
        or the noise alone. If left out, all that the rig states: one of an older file states none.

    Returns
    -------
    Reconstruction or NamedReconstruction
        Points in mm with covariances and flags, and warnings.

    Raises
    ------
    InputError
        As of :func:`~labcal.reconstruct.reconstruction.reconstruct_centres`, or of :func:`measure`; or
        settings are given that go with named pixels.
    UnknownNameError
        There is no such budget.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> found = pipeline.reconstruct(examples.rig(), examples.detections(), examples.TARGET)
    >>> found.points
    Points(views=8, points=704, ok=704, median_sigma=0.076 mm)
    >>> found.warnings
    ()
    """
    if isinstance(detections, NamedPixels) or (
        isinstance(detections, str | os.PathLike) and is_pixels(detections)
    ):
        named = detections if isinstance(detections, NamedPixels) else as_path(detections)
        return measure(model, named, target, settings, budget=budget)
    if settings is not None:
        raise InputError("`settings` go with named pixels, not with dots of a target. Leave them out.")
    return _of_dots(model, detections, target, progress, budget)


def _of_dots(
    model: Model | Rig | AnyPath,
    detections: Detections | Shoot | AnyPath,
    target: Target | AnyTargets | None,
    progress: Progress | None,
    budget: "Budget | str | None",
) -> "Reconstruction":
    """Return the points of dots; as :func:`reconstruct`."""
    from labcal.reconstruct.point_budget import Budget
    from labcal.reconstruct.reconstruction import load_reconstructor, reconstruct_centres
    from labcal.reconstruct.reconstruction_warnings import reconstruction_warnings

    wanted = None if budget is None else choice_of(budget, Budget, "budget")
    used = model if isinstance(model, Model | Rig) else load_reconstructor(as_path(model))
    receiver = progress_of(progress)
    given = DotSource(None, detections) if isinstance(detections, Detections) else open_dots(detections)
    rig = used if isinstance(used, Rig) else None
    shown = _reconstructed_target(given, target, rig)
    shoot = given.shoot
    if shoot is not None and shoot.manifest.target is None and isinstance(shown, PrintableTarget):
        shoot = shoot.showing(shown)
    table = dots_of(given.table, shoot, receiver)
    dots = table if shown is None else in_one_frame(table, shown)
    found = reconstruct_centres(used, dots, shown, wanted)
    points = points_of_boards(found.points, shown) if isinstance(shown, BoardSet) else found.points
    warnings = reconstruction_warnings(used, dots, found, shown)
    return replace(found, points=points, warnings=warnings)


def _reconstructed_target(
    given: DotSource, target: Target | AnyTargets | None, rig: Rig | None
) -> Target | None:
    """Return the target of dots, if it is known: places that were found are one, too."""
    if isinstance(target, Target):
        return target
    return given.target(target, rig) if target is not None or given.states_target(rig) else None
