"""Findings from the explanations of a shoot's residuals."""

from collections.abc import Callable

import numpy as np

from labcal.calibrate.adjustment.state import POSE
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding, NotJudged
from labcal.guide.diagnosis.forms.explaining import SHAPES, Explained, Explanation
from labcal.guide.diagnosis.forms.hypotheses import PAIR
from labcal.guide.diagnosis.forms.shoot_model import ShootModel
from labcal.wording import listed

LEAST_HARM_PERCENT = 3.0
"""Increase of the expected 3-D error from which on a mistake is reported that residuals show beyond doubt."""
_REST = 1e-3
"""Share of the largest gain below which another one may be what the linear model leaves of it, at least.

Of a turn by a rad the second order is about a times the first, and its gain the square of that: this is the
share of mistakes of 3%, two degrees or so. Of larger ones it is the square of their own size.
"""
_SHOWN = 4
"""Pictures that are named for a finding."""


def residual_findings(
    evidence: Evidence,
    check: CheckName,
    words: Callable[[ShootModel, Explanation], tuple[str, str]],
) -> CheckResult:
    """Return the findings of one kind.

    Parameters
    ----------
    evidence : Evidence
    check : CheckName
    words : callable
        Returns what is wrong with a shoot, and how to mend it.
    """
    model, found = evidence.model, evidence.explained
    if model is None or found is None:
        return NotJudged(check, f"Cameras could not be calibrated. {evidence.why_not_alone}".strip())
    worth = _worth_a_word(model, found)
    mine = [one for one in worth if one.hypothesis.check is check]
    by_itself = [one for one in found.by_themselves if one.hypothesis.check is check]
    others = [one for one in worth if one.hypothesis.check is not check]
    if not mine and by_itself and others:
        best = max(others, key=lambda one: one.gain)
        what, mend = words(model, max(by_itself, key=lambda one: one.gain))
        explained = Finding(
            check, (), (), what, mend, by_itself[0].p_value, explained_by=best.hypothesis.check
        )
        return (explained,)
    return tuple(_finding(evidence, model, one, words(model, one)) for one in _together(mine))


def camera_names(model: ShootModel, one: Explanation) -> tuple[str, ...]:
    """Return the cameras of an explanation; of a relative pose of two cameras both."""
    camera = one.hypothesis.camera
    if camera is None:
        return model.names
    both = one.hypothesis.check in (CheckName.CAMERA_MOVED, CheckName.UNSYNCHRONISED)
    if both and len(model.names) == PAIR:
        return model.names
    return (model.names[camera],)


def view_names(model: ShootModel, one: Explanation) -> tuple[str, ...]:
    """Return the views of an explanation; all of one that concerns all."""
    return tuple(model.views[at] for at in one.hypothesis.views) or model.views


def picture_words(model: ShootModel, one: Explanation) -> str:
    """Return the cameras of an explanation for people, as in ``camera 'left' or 'right'``."""
    return "Camera " + " or ".join(f"'{name}'" for name in camera_names(model, one))


def view_words(model: ShootModel, one: Explanation) -> str:
    """Return the views of an explanation for people; ``all views`` of one that concerns all."""
    if not one.hypothesis.views:
        return "all views"
    return listed([f"'{model.views[at]}'" for at in one.hypothesis.views])


def _worth_a_word(model: ShootModel, found: Explained) -> list[Explanation]:
    """Return the explanations that do harm, and are not the rest of a far larger one.

    Of a large mistake its second order is left, which the linear model does not hold. Harm is that with the
    dots as declared: a calibration that frees them hides a bent board, which the next one may suffer from.
    """
    if not found.found:
        return []
    largest = max(found.found, key=lambda one: one.gain)
    rest = max(_REST, _relative_size(model, largest) ** 2) * largest.gain
    kept = [one for one in found.found if one is largest or one.gain >= rest]
    harms = [(one, (one.harm_percent, one.declared_harm_percent)) for one in kept]
    return [
        one
        for one, harm in harms
        if None in harm or max(value for value in harm if value is not None) >= LEAST_HARM_PERCENT
    ]


def _relative_size(model: ShootModel, one: Explanation) -> float:
    """Return the size of a mistake as a turn, rad, or as a share of a length."""
    check, size = one.hypothesis.check, np.abs(one.size)
    if check in SHAPES:
        return float(size.max()) / model.half_side_mm
    if check is CheckName.REFOCUSED:
        return float(size[0])
    return float(size.reshape(-1, POSE)[:, :3].max())


def _together(found: list[Explanation]) -> list[Explanation]:
    """Return explanations of the same cameras that concern single views as one."""
    single: dict[int | None, list[Explanation]] = {}
    rest = []
    for one in found:
        if len(one.hypothesis.views) == 1:
            single.setdefault(one.hypothesis.camera, []).append(one)
        else:
            rest.append(one)
    for several in single.values():
        worst = max(several, key=lambda one: one.bias_mm or 0.0)
        views = tuple(sorted(view for one in several for view in one.hypothesis.views))
        biases = [one.bias_mm for one in several if one.bias_mm is not None]
        bias = float(np.linalg.norm(biases)) if biases else None
        rest.append(worst.of_views(views, bias))
    return rest


def _finding(evidence: Evidence, model: ShootModel, one: Explanation, words: tuple[str, str]) -> Finding:
    cameras, views = camera_names(model, one), view_names(model, one)
    what, mend = words
    shown = views if one.hypothesis.views else _clearest(model, views)
    return Finding(
        check=one.hypothesis.check,
        cameras=cameras,
        views=views,
        words=what,
        mend=mend,
        p_value=one.p_value,
        harm_mm=one.bias_mm,
        harm_percent=one.harm_percent,
        pictures=evidence.images(shown, cameras)[:_SHOWN],
    )


def _clearest(model: ShootModel, views: tuple[str, ...]) -> tuple[str, ...]:
    """Return the views by their residuals in the rig without the mistake, the largest first."""
    order = np.argsort(-model.view_misfits, kind="stable")
    return tuple(views[at] for at in order.tolist() if at < len(views))
