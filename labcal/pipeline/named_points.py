"""Points that are not a target's: from named pixels to places, in the frame that is asked for."""

import os
from dataclasses import replace
from typing import TYPE_CHECKING

from labcal.arguments import choice_of, settings_of
from labcal.cameras.rig import Rig
from labcal.correspond.named_pixels import NamedPixels
from labcal.estimators.model import Model
from labcal.paths import AnyPath, as_path
from labcal.targets.catalogue import target_of
from labcal.targets.target import Target

if TYPE_CHECKING:
    from labcal.reconstruct.measure_settings import MeasureSettings
    from labcal.reconstruct.named_reconstruction import NamedReconstruction
    from labcal.reconstruct.point_budget import Budget


def measure(
    model: Model | Rig | AnyPath,
    pixels: NamedPixels | AnyPath,
    target: Target | AnyPath | None = None,
    settings: "MeasureSettings | None" = None,
    *,
    budget: "Budget | str | None" = None,
) -> "NamedReconstruction":
    """Return the points of named pixels, each from all cameras that measured it.

    Parameters
    ----------
    model : Model, Rig or path
        A fitted method or cameras, or the file of them.
    pixels : NamedPixels or path
        Named pixels, or the table of them. Pixels of one name in several cameras of a view are one point.
    target : Target or str, optional
        The target that lies in the frame, of a frame by a board.
    settings : MeasureSettings, optional
        Noise of pixels that state none, and the frame of the points.
    budget : {"full", "noise"}, optional
        The sources of errors in the covariances of a rig's points: noise of the pixels and the calibration,
        or the noise alone. If left out, all that the rig states: one of an older file states none.

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
    from labcal.correspond.named_pixels_csv import read_pixels
    from labcal.reconstruct.frames.requested_frame import RequestedFrame
    from labcal.reconstruct.measure_settings import MeasureSettings
    from labcal.reconstruct.named_points import reconstruct_named
    from labcal.reconstruct.named_warnings import named_warnings
    from labcal.reconstruct.point_budget import Budget, PointBudget
    from labcal.reconstruct.reconstruction import load_reconstructor
    from labcal.reconstruct.scale.adjustment import adjusted_to_bars
    from labcal.reconstruct.scale.scale_bar import ScaleBar
    from labcal.reconstruct.stated_noise import with_covariances

    how = settings_of(settings, MeasureSettings)
    wanted = None if budget is None else choice_of(budget, Budget, "budget")
    frame = None if how.frame is None else RequestedFrame.of(how.frame, how.frame_view)
    shown = target_of(target) if isinstance(target, str | os.PathLike) else target
    used = model if isinstance(model, Model | Rig) else load_reconstructor(as_path(model))
    given = pixels if isinstance(pixels, NamedPixels) else read_pixels(as_path(pixels))
    found = reconstruct_named(used, with_covariances(given, how.pixel_sigma), wanted)
    if how.scale_bars:
        ppm = how.scale_sigma_ppm
        bars = [ScaleBar.of(bar) for bar in how.scale_bars]
        found = adjusted_to_bars(found, bars, None if ppm is None else 1e-6 * ppm)
    if frame is not None:
        world = found.budget if isinstance(found.budget, PointBudget) else None
        found = found.in_frame(frame.fitted(used, found.with_noise, shown, world))
    return replace(found, warnings=named_warnings(used, found))
