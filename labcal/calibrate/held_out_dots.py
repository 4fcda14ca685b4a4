"""Prediction of held-out views with the dots as declared and with the dots freed."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64

from labcal.calibrate.adjustment.dot_freedom import dot_freedom
from labcal.calibrate.adjustment.free_dots import datum_constraint
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.rounds import Adjusted, adjust_in_rounds
from labcal.calibrate.adjustment.state import Freedom, Lenses, RigState
from labcal.calibrate.freed_dots import MIN_PICTURES
from labcal.calibrate.usable_dots import MIN_DOTS
from labcal.distributions import f_tail
from labcal.errors import InputError
from labcal.optim.stopping import Stopping
from labcal.targets.catalogue import AnyTarget

FOLDS = 4
"""Parts of the views, each of which is held out once."""
_NEAR = Stopping(max_epochs=50, min_gradient=0.1)
"""Within a tenth of a standard deviation of the minimum."""


@dataclass(frozen=True)
class HeldOutDots:
    """Mean squares of the residuals of held-out pictures, px squared; each picture's pose is fitted to it."""

    view: tuple[str, ...]
    """Of every picture."""
    declared: Float64[np.ndarray, " pictures"]
    freed: Float64[np.ndarray, " pictures"]

    @classmethod
    def joined(cls, cameras: list["HeldOutDots"]) -> "HeldOutDots":
        """Return the pictures of several cameras."""
        return cls(
            tuple(view for one in cameras for view in one.view),
            np.concatenate([one.declared for one in cameras]),
            np.concatenate([one.freed for one in cameras]),
        )

    @property
    def declared_px(self) -> float:
        """RMS with the dots as declared."""
        return float(np.sqrt(self.declared.mean()))

    @property
    def freed_px(self) -> float:
        """RMS with the dots freed."""
        return float(np.sqrt(self.freed.mean()))

    @property
    def chance(self) -> float:
        """Probability of such an advantage of freed dots by chance.

        Student's one-sided t-test on the logarithm of the ratio of both mean squares. Pictures of one view
        count as one: they show the same dots with the same errors.
        """
        tiny = np.finfo(np.float64).tiny
        ratio = np.log(np.maximum(self.declared, tiny) / np.maximum(self.freed, tiny))
        names, number = np.unique(np.array(self.view), return_inverse=True)
        by_view = np.bincount(number, weights=ratio) / np.bincount(number)
        mean, spread = float(by_view.mean()), float(by_view.std(ddof=1))
        if mean <= 0.0:
            return 1.0
        return 0.5 * f_tail(mean**2 * len(names) / max(spread, tiny) ** 2, 1, float(len(names) - 1))


@dataclass(frozen=True)
class BothWays:
    """One camera calibrated from all its views, with the dots as declared and with the dots freed."""

    declared: Adjusted
    freed: Adjusted
    observations: Observations
    """Centroids as measured."""
    target: AnyTarget
    views: tuple[str, ...]
    """Names, in the order of their numbers."""


def held_out_dots(camera: BothWays, number: int) -> HeldOutDots | None:
    """Predict views of one camera from the others, with the dots as declared and with the dots freed.

    Every :data:`FOLDS`-th view is held out, from view `number` on; None if there is none. From the others
    follow lens and, where freed, dots; of held-out views only the poses are fitted. Dots in too few of the
    others do not count, nor do outliers of both. All fits begin at the calibration from all views and end a
    tenth of a standard deviation from their minimum.

    Raises
    ------
    InputError
        The other views determine no camera or too few dots.
    """
    centres = camera.observations.moved(-camera.declared.eccentricity)
    held = np.arange(len(camera.views)) % FOLDS == number
    if not held.any():
        return None
    others = _of_views(centres, ~held)
    movable = np.bincount(others.dot, minlength=camera.target.count) >= MIN_PICTURES
    others = others.where(movable[others.dot])
    judged = _of_views(centres, held)
    judged = judged.where(movable[judged.dot])
    if np.bincount(judged.view, minlength=int(held.sum())).min() < MIN_DOTS:
        raise InputError("Views that are held out show too few dots that the others do.")
    fits = []
    for whole in (camera.declared, camera.freed):
        start = replace(whole.state, T_world_target=whole.state.T_world_target[~held])
        still = np.zeros((start.dots.size, 0))
        basis = still
        if whole is camera.freed:
            declared_places = replace(camera.declared, state=replace(start, dots=camera.target.points()))
            hold = datum_constraint(declared_places, others, movable, Lenses.FREE)
            basis = dot_freedom(camera.target.points(), movable, hold)
        learned = _adjusted(camera, start, others, Freedom(Lenses.FREE, basis))
        shown = replace(learned.state, T_world_target=whole.state.T_world_target[held])
        fits.append(_adjusted(camera, shown, judged, Freedom(Lenses.FIXED, still)))
    counted = ~(fits[0].outlier & fits[1].outlier)
    declared, freed = (_squares(fit, judged, counted) for fit in fits)
    views = tuple(view for view, is_held in zip(camera.views, held.tolist(), strict=True) if is_held)
    return HeldOutDots(views, declared, freed)


def _adjusted(camera: BothWays, start: RigState, observations: Observations, freedom: Freedom) -> Adjusted:
    radii = 0.5 * camera.target.outer_diameters_mm()
    return adjust_in_rounds(start, observations, freedom, radii, 0, _NEAR)


def _of_views(observations: Observations, chosen: Bool[np.ndarray, " views"]) -> Observations:
    """Return some views alone, numbered anew."""
    seen = observations.where(chosen[observations.view])
    number = np.cumsum(chosen) - 1
    return replace(seen, view=number[seen.view])


def _squares(
    fit: Adjusted, observations: Observations, counted: Bool[np.ndarray, " n"]
) -> Float64[np.ndarray, " views"]:
    """Return the mean square of the residuals of every view."""
    views = len(fit.state.T_world_target)
    square = np.where(counted, (fit.residual**2).sum(axis=1), 0.0)
    dots = np.bincount(observations.view, weights=counted, minlength=views)
    return np.asarray(np.bincount(observations.view, weights=square, minlength=views) / np.maximum(dots, 1.0))
