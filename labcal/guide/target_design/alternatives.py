"""Easier questions that have an answer, where one has none: less tilt, a shorter distance, larger paper."""

from collections.abc import Callable, Iterator
from dataclasses import replace

from labcal.guide.target_design.question import TargetQuestion
from labcal.targets.paper import PAPERS

_TILT_STEP_DEG, _DISTANCE_STEP = 5.0, 0.05


def alternatives(question: TargetQuestion, is_answered: Callable[[TargetQuestion], bool]) -> list[str]:
    """Return in words by what change alone a question has an answer, the least change of each kind.

    Parameters
    ----------
    question : TargetQuestion
    is_answered : callable
        Tells whether there is a target for a question.
    """
    found = []
    for kind in (_less_tilted, _nearer, _larger):
        words = next((words for changed, words in kind(question) if is_answered(changed)), None)
        if words is not None:
            found.append(words)
    return found


def _less_tilted(question: TargetQuestion) -> Iterator[tuple[TargetQuestion, str]]:
    tilt = _TILT_STEP_DEG * (question.tilt_max_deg // _TILT_STEP_DEG)
    while tilt >= 0.0:
        if tilt < question.tilt_max_deg:
            yield replace(question, tilt_max_deg=tilt), f"a tilt of at most {tilt:g} degrees"
        tilt -= _TILT_STEP_DEG


def _nearer(question: TargetQuestion) -> Iterator[tuple[TargetQuestion, str]]:
    share = 1.0 - _DISTANCE_STEP
    while share > _DISTANCE_STEP:
        far = float(round(share * question.far_mm, -1 if question.far_mm > 200.0 else 0))  # noqa: PLR2004 -- of people
        if far < 1.0:
            return
        yield (
            replace(question, near_mm=min(question.near_mm, far), far_mm=far),
            f"a distance of at most {far:g} mm",
        )
        share -= _DISTANCE_STEP


def _larger(question: TargetQuestion) -> Iterator[tuple[TargetQuestion, str]]:
    area = question.paper.width_mm * question.paper.height_mm
    for paper in PAPERS.values():
        if paper.width_mm * paper.height_mm > 1.05 * area:
            yield replace(question, paper=paper), f"paper of the size {paper.name} (or tiles)"
