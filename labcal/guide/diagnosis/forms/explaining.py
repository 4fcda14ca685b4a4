"""Explanations of the residuals of a shoot: as few mistakes as make the rest look like noise."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from labcal.distributions import f_tail
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.finding import LEVEL
from labcal.guide.diagnosis.forms.hypotheses import (
    Hypothesis,
    any_shape,
    each_focus,
    free_poses,
    hypotheses,
    shape_controls,
)
from labcal.guide.diagnosis.forms.model import Fit, Term
from labcal.guide.diagnosis.forms.shoot_model import ShootModel

_PRICE = 4.0
"""Gain that each parameter must bring when explanations compete, in variances."""
_MOST = 8
"""Mistakes that are looked for in one shoot."""
CHANGES = {CheckName.CAMERA_MOVED, CheckName.REFOCUSED}
"""Mistakes after which the cameras are others than before."""
BY_VIEW = {CheckName.UNSYNCHRONISED, CheckName.ROLLING_SHUTTER}
"""Mistakes that are others in each view."""
SHAPES = {CheckName.BENT_BOARD, CheckName.WRONG_PITCH}
"""Mistakes that are smooth shapes of the board."""


@dataclass(frozen=True)
class Explanation:
    """A mistake that explains a part of the residuals.

    Attributes
    ----------
    hypothesis : Hypothesis
    p_value : float
        That a shoot without the mistake shows as much, beside the other explanations.
    gain : float
        Decrease of chi-square by it, in units of the noise.
    size : float64 array
        Values of its parameters.
    bias_mm : float or None
        RMS 3-D error over the volume that it adds; None of one camera.
    budget_mm : float or None
        Expected RMS 3-D error without any mistake.
    declared_mm : float or None
        As `bias_mm`, by the linear model, with the dots as declared.
    """

    hypothesis: Hypothesis
    p_value: float
    gain: float
    size: np.ndarray
    bias_mm: float | None = None
    budget_mm: float | None = None
    declared_mm: float | None = None

    @property
    def harm_percent(self) -> float | None:
        """Relative increase of the expected 3-D error, %."""
        return self._increase(self.bias_mm)

    @property
    def declared_harm_percent(self) -> float | None:
        """Relative increase of the expected 3-D error with the dots as declared, %."""
        return self._increase(self.declared_mm)

    def _increase(self, bias_mm: float | None) -> float | None:
        if bias_mm is None or not self.budget_mm:
            return None
        return 100.0 * float(np.hypot(1.0, bias_mm / self.budget_mm) - 1.0)

    def of_views(self, views: tuple[int, ...], bias_mm: float | None) -> "Explanation":
        """Return it as one of several views."""
        return replace(self, hypothesis=replace(self.hypothesis, views=views), bias_mm=bias_mm)


@dataclass(frozen=True)
class Explained:
    """All explanations of a shoot.

    Attributes
    ----------
    found : tuple of Explanation
    by_themselves : tuple of Explanation
        The best of each kind, were it the only mistake; significant ones.
    noise : float
        Variance of dots over the stated one, with the explanations.
    """

    found: tuple[Explanation, ...]
    by_themselves: tuple[Explanation, ...]
    noise: float


def explained(model: ShootModel) -> Explained:
    """Return the mistakes that explain the residuals of a shoot.

    Mistakes are added one by one, the one that explains most first, as long as the next is significant;
    those that the later ones have made superfluous are removed, and those that another one explains better
    beside the later ones are exchanged for it.
    """
    chosen: list[Hypothesis] = []
    first: tuple[Explanation, ...] = ()
    everything = list(hypotheses(model.forms))
    for _ in range(_MOST):
        tested = _tested(model, chosen, everything)
        significant = [one for one in tested if one.p_value < LEVEL]
        first = first or tuple(significant)
        if not significant:
            break
        best = max(significant, key=_score)
        chosen.append(best.hypothesis)
        chosen = _without_superfluous(model, chosen)
        chosen = _exchanged(model, chosen, everything)
    return _judged(model, chosen, first)


def _score(one: Explanation) -> float:
    return one.gain - _PRICE * len(one.size)


def _terms(chosen: Iterable[Hypothesis]) -> tuple[Term, ...]:
    return tuple(term for one in chosen for term in one.terms)


def _tested(
    model: ShootModel, chosen: Sequence[Hypothesis], everything: Sequence[Hypothesis]
) -> list[Explanation]:
    """Return the best hypothesis of each kind beside those that are chosen already."""
    current = _terms(chosen)
    before = model.fit(current)
    best: dict[tuple[CheckName, int | None, bool], tuple[float, Hypothesis, Fit]] = {}
    for one in everything:
        if any(_same(one, other) for other in chosen):
            continue
        fit = model.fit((*current, *one.terms))
        kind = (one.check, one.camera, len(one.views) == 1)
        if kind not in best or before.chi2 - fit.chi2 > best[kind][0]:
            best[kind] = (before.chi2 - fit.chi2, one, fit)
    return [_explanation(model, current, before, one, fit) for _, one, fit in best.values()]


def _same(one: Hypothesis, other: Hypothesis) -> bool:
    """Tell whether a hypothesis adds nothing to one that is chosen."""
    if one.check is not other.check:
        return False
    if one.check in CHANGES:
        return one.camera == other.camera and one.views[0] == other.views[0]
    if one.check is CheckName.UNSYNCHRONISED and other.camera == one.camera:
        return not other.views or one.views == other.views
    return True


def _explanation(
    model: ShootModel, current: tuple[Term, ...], before: Fit, one: Hypothesis, fit: Fit
) -> Explanation:
    """Return the test of a hypothesis beside terms that are in the model already.

    What is no shape of the board must be significant, too, where the board may have any smooth shape: an
    uneven print leaves residuals that poses of single pictures would explain as well.
    """
    found = _tested_beside(model, current, before, one, fit)
    if found.p_value >= LEVEL or one.check in SHAPES:
        return found
    uneven = (*current, any_shape(model.forms))
    beside = _tested_beside(model, uneven, model.fit(uneven), one, model.fit((*uneven, *one.terms)))
    return replace(found, p_value=max(found.p_value, beside.p_value))


def _tested_beside(
    model: ShootModel, current: tuple[Term, ...], before: Fit, one: Hypothesis, fit: Fit
) -> Explanation:
    """Return the test of a hypothesis beside given terms alone."""
    with_it = (*current, *one.terms)
    count = max(1, fit.freedom - before.freedom)
    own = model.own_noise(with_it)
    width = sum(term.count for term in one.terms)
    if own <= 0.0:  # poses of each camera's own leave nothing of so few dots to test with
        return Explanation(one, 1.0, 0.0, fit.values[-width:])
    noise, freedom = _noise(model, with_it, one, (fit, own))
    gain = max(0.0, before.chi2 - fit.chi2)
    p_value = min(1.0, one.alternatives * f_tail(gain / noise / count, count, freedom))
    return Explanation(one, p_value, gain / own, fit.values[-width:])


def _noise(
    model: ShootModel, terms: tuple[Term, ...], one: Hypothesis, found: tuple[Fit, float]
) -> tuple[float, float]:
    """Return the variance that a gain is compared with, and its degrees of freedom.

    It is what is left where the hypothesis is given still more freedom of the same kind: a change at one view
    is compared with differences between all views, a bend with other shapes of the board.
    """
    fit, own = found
    freedom = model.freedom(fit)
    if one.check in SHAPES:
        more = model.fit((*terms, shape_controls(model.forms)))
    elif one.check is CheckName.REFOCUSED and one.camera is not None:
        more = model.fit((*terms, each_focus(model.forms, one.camera)))
    elif one.check is CheckName.CAMERA_MOVED:
        more = model.fit((*terms, *free_poses(model.forms)))
    else:
        return own * model.smooth_inflation, freedom
    count = more.freedom - fit.freedom
    larger = (fit.chi2 - more.chi2) / max(1, count)
    return (larger, float(count)) if count > 0 and larger > own else (own, freedom)


def _without_superfluous(model: ShootModel, chosen: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Return the hypotheses that stay significant beside all others; the newest one does."""
    kept = list(chosen)
    for one in chosen[:-1]:
        others = [other for other in kept if other is not one]
        if len(others) == len(kept):
            continue
        redundant = any(_same(one, other) for other in others)
        current = _terms(others)
        before, fit = model.fit(current), model.fit((*current, *one.terms))
        if redundant or _explanation(model, current, before, one, fit).p_value >= LEVEL:
            kept = others
    return kept


def _exchanged(
    model: ShootModel, chosen: Sequence[Hypothesis], everything: Sequence[Hypothesis]
) -> list[Hypothesis]:
    """Return the hypotheses, each exchanged for the one that explains most beside all others.

    A camera that moved is not significant beside a board that is not yet known to be bent, which makes all
    views differ; what was taken in its place then is not what explains the shoot best.
    """
    kept = list(chosen)
    for one in chosen if len(chosen) > 1 else ():
        others = [other for other in kept if other is not one]
        rivals = [rival for rival in _tested(model, others, everything) if rival.p_value < LEVEL]
        if rivals:
            kept = [*others, max(rivals, key=_score).hypothesis]
    return kept


def _judged(
    model: ShootModel, chosen: Sequence[Hypothesis], by_themselves: tuple[Explanation, ...]
) -> Explained:
    """Return the explanations with what each costs in 3-D beside the others."""
    whole = _terms(chosen)
    noise = model.own_noise(whole)
    budget = model.budget_mm(noise)
    found = []
    for one in chosen:
        others = _terms(other for other in chosen if other is not one)
        without, fit = model.fit(others), model.fit((*others, *one.terms))
        explanation = _explanation(model, others, without, one, fit)
        if one.check in BY_VIEW:
            bias = model.scattered_bias_mm(without, others, noise)
        else:
            later = np.zeros(sum(term.count for term in model.base))
            if one.check in CHANGES:
                later = model.in_rig(one.terms[0].columns, explanation.size)
            rig = _terms(other for other in chosen if other is not one and other.check not in BY_VIEW)
            bias = model.bias_mm(one.terms, fit, rig, noise, later)
        found.append(replace(explanation, bias_mm=bias, budget_mm=budget, declared_mm=bias))
    return Explained(tuple(found), by_themselves, noise)
