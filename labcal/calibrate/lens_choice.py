"""The choice of a lens model by its residuals on held-out views."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.calibrate.adjustment.free_dots import adjust_dots
from labcal.calibrate.adjustment.observations import Observations, observations_of
from labcal.calibrate.adjustment.rounds import Adjusted, adjust_in_rounds
from labcal.calibrate.adjustment.state import Freedom, Lenses, RigState
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.freed_dots import FreedDots
from labcal.calibrate.handheld import HandheldSettings
from labcal.calibrate.lens_candidates import DEFAULT_LENS, LARGE, OF_VIEWS, PLENTY
from labcal.calibrate.lens_start import LensStart, start_from_camera, start_from_pictures
from labcal.calibrate.lens_support import undetermined
from labcal.calibrate.parallel_views import refuse_parallel_views
from labcal.calibrate.usable_dots import MIN_DOTS, in_full_pictures, usable_dots
from labcal.correspond.detections import Detections
from labcal.correspond.gathering import joined
from labcal.errors import InputError
from labcal.run.progress import Progress
from labcal.run.threads import one_blas_thread
from labcal.targets.catalogue import AnyTarget
from labcal.wording import counted

FOLDS = 4
MIN_VIEWS = 5
"""Of every camera: four to calibrate from, one to judge by."""


@dataclass(frozen=True)
class LensTrial:
    """The result of one lens model."""

    lens: str
    held_out_px: float
    """RMS of the 2-D distance in views that were not fitted to, without outliers; NaN where not tried."""
    worse_px2: float
    """Mean over these pictures by how much the mean square is larger than the best lens's, px squared."""
    chance_px2: float
    """Standard error of that."""
    refused: str | None
    """The reason why the views do not determine it."""

    @property
    def as_good(self) -> bool:
        """True if it is not significantly worse than the best."""
        return self.refused is None and self.worse_px2 <= self.chance_px2


@dataclass(frozen=True)
class LensChoice:
    """The lens model that was chosen.

    Attributes
    ----------
    lens : str
        Of the models that were tried, the simplest that is as good as the best.
    trials : tuple of LensTrial
        None where nothing was tried: the views do not ask for another lens than the usual one.
    why : str
        The reason, for people.
    """

    lens: str
    trials: tuple[LensTrial, ...]
    why: str


@dataclass(frozen=True)
class LensCandidates:
    """The lens models to try."""

    lenses: tuple[str, ...]
    """The simplest first."""
    needed: tuple[str, ...] = ()
    """Those that are not refused for coefficients which the views leave open: others of theirs are needed."""


@one_blas_thread()
def choose_lens(
    detections: Detections,
    target: AnyTarget,
    settings: HandheldSettings,
    progress: Progress,
    among: LensCandidates | None = None,
) -> LensChoice:
    """Try lens models on views that they were not fitted to, each camera alone, as it will be calibrated.

    Views are split into :data:`FOLDS` parts, each of which is held out once: only its poses are estimated,
    with the lens, and where dots are freed with their places on the print, that the other views give. Of the
    models that chance does not tell from the best (by one standard error of the difference, picture by
    picture) the first of :data:`OF_VIEWS` is chosen.

    Parameters
    ----------
    detections : Detections
        Only dots flagged ``ok`` enter.
    target : AnyTarget
    settings : HandheldSettings
        Of the calibration to come; lenses are free, dots are as declared unless they are ``freed``, and the
        rig to start from does not count.
    progress : Progress
    among : LensCandidates, optional
        Lens models to try; :data:`OF_VIEWS` where left out.

    Raises
    ------
    InputError
        A camera has fewer than :data:`MIN_VIEWS` views or parallel rays, no model can be fitted, or as in
        :func:`~labcal.calibrate.handheld.calibrate_handheld`.
    """
    entering, _ = in_full_pictures(settings.measured(usable_dots(detections, target), target))
    cameras = [entering.where(entering.camera == name).by_view() for name in entering.cameras]
    for name, pictures in zip(entering.cameras, cameras, strict=True):
        if len(pictures) < MIN_VIEWS:
            raise InputError(
                f"Camera '{name}' has {counted(len(pictures), 'usable view')}, but to choose a lens model "
                f"needs {MIN_VIEWS}. Take more views, or name the model with `lens`."
            )
    for pictures in cameras:
        _refuse_parallel(pictures, target, settings.eccentricity_rounds)
    if among is None:
        plenty = min(map(len, cameras)) >= PLENTY
        among = LensCandidates(tuple(lens for lens in OF_VIEWS if plenty or lens != LARGE))
    lenses = among.lenses
    progress.start("lens models", len(lenses))
    squares: dict[str, Float64[np.ndarray, " pictures"]] = {}
    refused: dict[str, str] = {}
    for lens in lenses:
        try:
            squares[lens] = np.concatenate(
                [_held_out(pictures, target, (lens, lens in among.needed), settings) for pictures in cameras]
            )
        except InputError as error:
            refused[lens] = str(error)
        progress.advance()
    if not squares:
        raise InputError("The views support no lens model. " + " ".join(dict.fromkeys(refused.values())))
    best = min(squares.values(), key=lambda square: float(square.mean()))
    trials = tuple(_trial(lens, squares.get(lens), best, refused.get(lens)) for lens in lenses)
    chosen = next(trial for trial in trials if trial.as_good)
    why = f"the simplest model that predicts held-out views as well as any (RMS {chosen.held_out_px:.3g} px)"
    return LensChoice(chosen.lens, trials, why)


def _refuse_parallel(pictures: list[Detections], target: AnyTarget, eccentricity_rounds: int) -> None:
    """Raise where the rays of a camera are parallel, so that no candidate suits it."""
    try:
        first = start_from_pictures(pictures, target, DEFAULT_LENS).camera
    except InputError:
        return  # each lens model says why
    refuse_parallel_views(pictures, target, first, eccentricity_rounds)


def _trial(
    lens: str,
    square: Float64[np.ndarray, " pictures"] | None,
    best: Float64[np.ndarray, " pictures"],
    refused: str | None,
) -> LensTrial:
    if square is None:
        return LensTrial(lens, float("nan"), float("nan"), float("nan"), refused)
    apart = square - best
    chance = float(apart.std(ddof=1) / np.sqrt(len(apart)))
    return LensTrial(lens, float(np.sqrt(square.mean())), float(apart.mean()), chance, None)


def _held_out(
    pictures: Sequence[Detections], target: AnyTarget, of: tuple[str, bool], settings: HandheldSettings
) -> Float64[np.ndarray, " pictures"]:
    """Return the mean square residual of every picture of one camera when it was held out, px squared.

    `of` is a lens model, and whether it is needed whatever of it is left open.

    Raises
    ------
    InputError
        The other views determine no camera, leave coefficients of the lens open, or cannot free the dots.
    """
    squares, rounds, (lens, needed) = [], settings.eccentricity_rounds, of
    for fold in range(FOLDS):
        held = list(pictures[fold::FOLDS])
        others = [picture for number, picture in enumerate(pictures) if number % FOLDS != fold]
        learned = _Problem.of(others, target, settings.dots_of(target))
        fitted = learned.adjusted(start_from_pictures(others, target, lens), Lenses.FREE, rounds)
        entered, judged = learned.observations, _Problem.of(held, target, settings.dots_of(target))
        if settings.dot_places is DotTreatment.FREED:
            free = adjust_dots(fitted, entered, target, Lenses.FREE, rounds)
            fitted, entered, judged = free.adjusted, free.observations, judged.at(free.dots)
        left_open = () if needed else undetermined(fitted, entered)
        if left_open:
            raise InputError(f"The views do not determine its coefficients {', '.join(left_open)}.")
        known = start_from_camera(held, target, fitted.state.cameras[0])
        squares.append(judged.squares(judged.adjusted(known, Lenses.FIXED, rounds)))
    return np.concatenate(squares)


@dataclass(frozen=True)
class _Problem:
    """Pictures of one camera."""

    observations: Observations
    target: AnyTarget
    dots: Vectors3
    """Their places on the print, mm."""

    @classmethod
    def of(cls, pictures: Sequence[Detections], target: AnyTarget, places: Vectors3) -> "_Problem":
        """Return them as numbers."""
        dots = joined(pictures)
        return cls(observations_of(dots, target, dots.cameras, dots.views), target, places)

    def at(self, freed: FreedDots) -> "_Problem":
        """Return the same pictures of dots that were found elsewhere; only those count.

        Raises
        ------
        InputError
            A picture has too few of them.
        """
        observations = self.observations.where(freed.freed[self.observations.dot])
        views = len({picture.view for picture in self.observations.pictures})
        if np.bincount(observations.view, minlength=views).min() < MIN_DOTS:
            raise InputError("Views that are held out show too few dots that the others do.")
        return _Problem(observations, self.target, freed.place)

    def adjusted(self, start: LensStart, lenses: Lenses, eccentricity_rounds: int) -> Adjusted:
        """Adjust from a start."""
        state = RigState((start.camera,), start.T_cam_target, self.dots)
        freedom = Freedom(lenses, np.zeros((3 * self.target.count, 0)))
        radii = 0.5 * self.target.outer_diameters_mm()
        return adjust_in_rounds(state, self.observations, freedom, radii, eccentricity_rounds)

    def squares(self, adjusted: Adjusted) -> Float64[np.ndarray, " pictures"]:
        """Return the mean square of each picture's residuals that are no outliers, px squared."""
        square = np.where(adjusted.outlier, 0.0, (adjusted.residual**2).sum(axis=1))
        views = len(adjusted.state.T_world_target)
        kept = np.bincount(self.observations.view, weights=~adjusted.outlier, minlength=views)
        summed = np.bincount(self.observations.view, weights=square, minlength=views)
        return np.asarray(summed / np.maximum(kept, 1.0))
