"""Points that are not a target's: from named pixels, or marks, to places, in the frame that is asked for."""

import os
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from labcal.arguments import choice_of, settings_of, wrong_type
from labcal.cameras.rig import Rig
from labcal.correspond.named_pixels import NamedPixels
from labcal.errors import InputError
from labcal.estimators.model import Model
from labcal.paths import AnyPath, as_path
from labcal.pipeline.marks import AnyMarkers, find_marks, refuse_pixel_sigma
from labcal.shoot.pictures import SUFFIXES
from labcal.targets.catalogue import AnyTargets, target_of
from labcal.targets.kept_target import kept_target
from labcal.targets.target import Target

if TYPE_CHECKING:
    from labcal.correspond.picture_set import AnyPictures
    from labcal.reconstruct.found_marks import FoundMarks
    from labcal.reconstruct.measure_settings import MeasureSettings
    from labcal.reconstruct.named_reconstruction import NamedReconstruction
    from labcal.reconstruct.point_budget import Budget


def measure(
    model: Model | Rig | AnyPath,
    pixels: "NamedPixels | FoundMarks | AnyPictures",
    target: Target | AnyTargets | None = None,
    settings: "MeasureSettings | None" = None,
    *,
    budget: "Budget | str | None" = None,
    markers: AnyMarkers | None = None,
) -> "NamedReconstruction":
    """Return the points of named pixels, or of marks in pictures, each from all cameras that measured it.

    Parameters
    ----------
    model : Model, Rig or path
        A fitted method or cameras, or the file of them.
    pixels : NamedPixels, FoundMarks, path or pictures
        Named pixels, or the table of them; or what :func:`find_marks` returned; or, with `markers`, pictures
        as it takes them. Pixels of one name in several cameras of a view are one point.
    target : Target, str or sequence of these, optional
        The target that lies in the frame, of a frame by a board; if left out, the one that the rig was
        calibrated with.
    settings : MeasureSettings, optional
        Noise of pixels that state none, and the frame of the points.
    budget : {"full", "noise"}, optional
        The sources of errors in the covariances of a rig's points: noise of the pixels and the calibration,
        or the noise alone. If left out, all that the rig states: one of an older file states none.
    markers : MarkSearch, str or sequence of str, optional
        Marks to look for in pictures, as of :func:`find_marks`.

    Returns
    -------
    NamedReconstruction
        Points in mm with covariances and flags, and warnings. A point that fewer than two cameras measured
        (all, of a fitted method) has no place.

    Raises
    ------
    InputError
        Something cannot be read, the model has no such camera, a pixel has no covariance and no noise is
        stated, no point was measured by enough cameras, or the frame is not determined; a budget is named for
        a fitted method, or the full one for a rig that states no covariance.
    UnknownNameError
        There is no such budget.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> found = pipeline.measure(examples.rig(), examples.pixels())
    >>> found
    NamedReconstruction(points=5, ok=5, median_residual=0.0053 px, budget=noise, warnings=0)
    >>> found.points.point[0].round(1)
    array([-40.,  30., 600.])
    """
    from labcal.reconstruct.found_marks import FoundMarks
    from labcal.reconstruct.frames.fitted_frame import FrameKind
    from labcal.reconstruct.frames.requested_frame import RequestedFrame
    from labcal.reconstruct.measure_settings import MeasureSettings
    from labcal.reconstruct.named_points import reconstruct_named
    from labcal.reconstruct.named_warnings import named_warnings
    from labcal.reconstruct.point_budget import Budget, PointBudget
    from labcal.reconstruct.reconstruction import load_reconstructor
    from labcal.reconstruct.scale.adjustment import adjusted_to_bars
    from labcal.reconstruct.scale.scale_bar import ScaleBar
    from labcal.reconstruct.scale.scaled_budget import ScaledBudget
    from labcal.reconstruct.stated_noise import with_covariances

    how = settings_of(settings, MeasureSettings)
    wanted = None if budget is None else choice_of(budget, Budget, "budget")
    frame = None if how.frame is None else RequestedFrame.of(how.frame, how.frame_view)
    shown = target if target is None or isinstance(target, Target) else target_of(target)
    used = model if isinstance(model, Model | Rig) else load_reconstructor(as_path(model))
    if shown is None and frame is not None and frame.kind is FrameKind.BOARD and isinstance(used, Rig):
        shown = kept_target(used)
    if markers is not None:
        refuse_pixel_sigma(how.pixel_sigma)
        pixels = find_marks(used, cast("AnyPictures", pixels), markers)
    marks = pixels if isinstance(pixels, FoundMarks) else None
    given = _named(pixels) if marks is None else marks.pixels
    found = reconstruct_named(used, with_covariances(given, how.pixel_sigma), wanted)
    if marks is not None:
        found = replace(found, points=marks.flagged(found.points), marks=marks)
    if how.scale_bars:
        ppm = how.scale_sigma_ppm
        bars = [ScaleBar.of(bar) for bar in how.scale_bars]
        found = adjusted_to_bars(found, bars, None if ppm is None else 1e-6 * ppm)
    if frame is not None:
        world = found.budget if isinstance(found.budget, PointBudget | ScaledBudget) else None
        found = found.in_frame(frame.fitted(used, found.with_noise, shown, world))
    return replace(found, warnings=named_warnings(used, found))


def _named(given: object) -> NamedPixels:
    """Return named pixels that are given, or read."""
    from labcal.correspond.named_pixels_csv import read_pixels

    if isinstance(given, NamedPixels):
        return given
    if isinstance(given, str | os.PathLike):
        refuse_pictures(given)
        return read_pixels(as_path(given))
    raise wrong_type(given, "named pixels, the path of their table, or with `markers` pictures", "pixels")


def refuse_pictures(given: AnyPath) -> None:
    """Raise where pictures are given in place of a table of named pixels.

    Raises
    ------
    InputError
        The path is that of a folder or of a picture.
    """
    path = as_path(given)
    if path.is_dir() or path.suffix.lower() in SUFFIXES:
        raise InputError(
            f"{path} holds pictures, not named pixels. Name the marks to look for in them: "
            "`markers='apriltag-36h11'`, `markers='coded-8x6'` or `markers='dots'`."
        )
