"""Cameras and methods from dots."""

from dataclasses import replace
from typing import TYPE_CHECKING

from labcal.arguments import one_text, settings_of
from labcal.correspond.boards_table import on_target
from labcal.correspond.detections import Detections
from labcal.correspond.view_roles import HoldOut, checked_hold_out, held_out_views, holds_none
from labcal.errors import InputError
from labcal.estimators.model import Model
from labcal.paths import AnyPath
from labcal.pipeline.given import dots_of, shown_by
from labcal.pipeline.pages import claimed_page, page_maker
from labcal.run.progress import Progress, progress_of
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role
from labcal.targets.board_set import BoardSet
from labcal.targets.catalogue import AnyTarget, AnyTargets

if TYPE_CHECKING:
    from labcal.calibrate.calibration import Calibration
    from labcal.calibrate.handheld import HandheldSettings
    from labcal.estimators.fit_settings import FitSettings
    from labcal.estimators.training import Training
    from labcal.report.page.output import PageOutput


def calibrate(  # noqa: PLR0913 -- what is calibrated from, how, and the page of it
    source: Shoot | AnyTargets,
    detections: Detections | AnyPath | None = None,
    lens: str | None = None,
    settings: "HandheldSettings | None" = None,
    hold_out: HoldOut = (),
    progress: Progress | None = None,
    *,
    page: "PageOutput | AnyPath | None" = None,
) -> "Calibration":
    """Calibrate cameras from views of a hand-held target. The first camera is the rig's world.

    Parameters
    ----------
    source : Shoot, AnyTarget, path or str
        A shoot or its folder, whose test views do not enter; or the target that the dots are of, or its name;
        several in a list are boards side by side.
    detections : Detections or path, optional
        Dots, or the table of them; those of the shoot are found in its pictures where left out.
    lens : str, optional
        A lens model; ``"auto"``: the simplest one that predicts held-out views as well as the best. Where
        left out, that of the rig to start from, or ``brown5``.
    settings : HandheldSettings, optional
    hold_out : int, str or sequence of str
        Views that do not enter, so that the result can be scored on them: how many, or which; ``"none"``: the
        test views of a shoot enter, too.
    progress : Progress, optional
    page : path, optional
        A page to write, ``.html``: a verdict in one sentence, figures and a 3-D view.

    Returns
    -------
    Calibration
        The rig, in mm and px, with standard deviations, residuals and warnings.

    Raises
    ------
    UnknownNameError, InputError
        As of :func:`~labcal.calibrate.calibrated.calibrated`; or no dots are given of a target.
    OutputError
        The page may not be written.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> pipeline.calibrate(examples.TARGET, examples.detections(), "brown5", hold_out=2)
    Calibration(cameras=['left', 'right'], lens=brown5, views=6, rms=0.0275 px, warnings=0)
    """
    from labcal.calibrate.calibrated import calibrated
    from labcal.calibrate.handheld import HandheldSettings
    from labcal.guide.diagnosis.named_causes import with_named_causes

    output = claimed_page(page, [source, detections])
    lens = None if lens is None else one_text(lens, "lens")
    settings, progress = settings_of(settings, HandheldSettings), progress_of(progress)
    hold_out = checked_hold_out(hold_out)
    shown = shown_by(source)
    dots = on_target(
        dots_of(detections, shown, progress), shown.target if isinstance(shown, Shoot) else shown
    )
    target, kept_back = shown.target if isinstance(shown, Shoot) else shown, hold_out
    if isinstance(shown, Shoot) and not holds_none(hold_out, dots.views):
        tested = {view.name for view in shown.views(Role.TEST)}
        rest = [view for view in dots.views if view not in tested]
        kept_back = [view for view in dots.views if view in tested or view in held_out_views(rest, hold_out)]
    made = calibrated(dots, target, lens, settings, kept_back, progress)
    if not isinstance(target, BoardSet):
        made = with_named_causes(made, dots, target)
    if output is not None:
        from labcal.report.calibration_page import calibration_page

        given = {"source": source, "detections": detections, "lens": lens, "hold_out": hold_out}
        maker = page_maker(output, "calibrate", {**given, "page": output.path})
        output.write(calibration_page(made, dots, target, maker))
    return made


def training_of(
    source: Shoot | AnyTarget,
    detections: Detections,
    settings: "FitSettings | None" = None,
    progress: Progress | None = None,
) -> "Training":
    """Return training data: centres of dots, and their places.

    Parameters
    ----------
    source : Shoot or AnyTarget
        A shoot, of which training views are used; or the target, held in the hand in all views.
    detections : Detections
        Centroids.
    settings : FitSettings, optional
    progress : Progress, optional

    Returns
    -------
    Training
        Pixels and points (mm), how the target was placed, and warnings.

    Raises
    ------
    InputError
        As of :func:`~labcal.correspond.training.training_data`, or of
        :func:`~labcal.calibrate.calibrated.calibrated`.

    Examples
    --------
    >>> from labcal import examples, load_target, pipeline
    >>> target, dots = load_target(examples.TARGET), examples.detections()
    >>> training = pipeline.training_of(target, dots, pipeline.FitSettings(lens="brown5"))
    >>> training.centred.data.X.shape, training.centred.data.Y.shape  # pixels of two cameras, and mm
    ((704, 4), (704, 3))
    """
    from labcal.estimators import training as of_dots
    from labcal.guide.diagnosis.named_causes import with_named_causes

    training = of_dots.training_of(source, detections, settings, progress)
    if training.held is None:
        return training
    target = source.target if isinstance(source, Shoot) else source
    if isinstance(target, BoardSet):
        return training
    held = with_named_causes(training.held, detections, target)
    return replace(training, held=held, warnings=held.warnings)


def fit(
    source: Shoot | AnyTargets,
    detections: Detections | AnyPath | None = None,
    method: object = "hybrid",
    settings: "FitSettings | None" = None,
    progress: Progress | None = None,
    *,
    page: "PageOutput | AnyPath | None" = None,
) -> Model:
    """Fit a method to the dots of a target; :func:`fit_methods` fits several to the same :func:`training_of`.

    Parameters
    ----------
    source : Shoot, AnyTarget, path or str
        A shoot or its folder, of which training views are used; or the target, held in the hand in all views,
        or its name; several in a list are boards side by side.
    detections : Detections or path, optional
        Dots, or the table of them; those of the shoot are found in its pictures where left out.
    method : str, type or object
        Its name; ``package.module:Class`` of a method of one's own; or an estimator or a class, of labcal's
        or with fit and predict as those of scikit-learn. What is given stays as it was: a copy learns.
    settings : FitSettings, optional
    progress : Progress, optional
    page : path, optional
        A page to write, ``.html``: a verdict in one sentence, figures and a 3-D view.

    Returns
    -------
    Model
        It takes pixels to points in mm: in the world of the stage, or in that of the first camera.

    Raises
    ------
    UnknownNameError, InputError
        There is no such method, it cannot learn from these dots, or no dots are given of a target.
    OutputError
        The page may not be written.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> quick = pipeline.FitSettings(lens="brown5", rehearsal=False)
    >>> pipeline.fit(examples.TARGET, examples.detections(), "dlt", quick)
    Model(method=dlt, cameras=['left', 'right'], outputs=3, calibrated_on=8 views)
    """
    from labcal.estimators.fit_settings import FitSettings
    from labcal.estimators.fitting import estimators_of, fit_methods

    output = claimed_page(page, [source, detections])
    settings, progress = settings_of(settings, FitSettings), progress_of(progress)
    shown = shown_by(source)
    estimators = estimators_of([method], settings)
    training = training_of(shown, dots_of(detections, shown, progress), settings, progress)
    (model,) = fit_methods(training, estimators, settings, progress)
    if isinstance(model, InputError):
        raise model
    if output is not None:
        from labcal.report.fit_page import fit_page
        from labcal.report.fit_result import FitOutcome

        given = {"source": source, "detections": detections, "method": method, "page": output.path}
        outcome = FitOutcome(model.estimator.method, "", model)
        output.write(fit_page(training, [outcome], page_maker(output, "fit", given)))
    return model
