"""Evidence of a shoot with one or several mistakes, or none."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from labcal.bench.diagnose.drawn_shoot import Fault, drawn_shoot
from labcal.bench.diagnose.harmful_size import harmful_size
from labcal.bench.diagnose.held_shoot import PAIRS, Hand, HeldShoot, good_shoot
from labcal.bench.diagnose.mistakes import MISLABELLED, MISTAKES
from labcal.bench.diagnose.simulated_dots import simulated_dots
from labcal.bench.diagnose.sizes import TIMES, size_of
from labcal.bench.solve.pair_dots import CAMERAS
from labcal.correspond.measure import detections_of
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.targets.grid import DotGrid, Rings

DRAWN = (CheckName.BLURRED, CheckName.EXPOSURE, CheckName.WRONG_TARGET)
"""Mistakes that only pictures show."""
_DRAWN_VIEWS = 12
"""As many as `diagnose` asks for: of 6 views it says with reason that they are few."""
_VIEWS = (10, 22)
_MOTION = 4.0
"""Length of a blur of motion, in standard deviations of a defocus that is as wide."""
_SMALL_BOARD = 0.5
_SINGLE_HAND = {
    CheckName.TOO_LITTLE_TILT: lambda size: Hand(tilt=size, depth=0.02),
    CheckName.POOR_COVERAGE: lambda size: Hand(reach=size),
}


def evidence_of(
    mistakes: Sequence[tuple[CheckName, int]], rig: tuple[str, str], folder: Path, random: np.random.Generator
) -> Evidence:
    """Return the evidence of a shoot.

    Parameters
    ----------
    mistakes : sequence of (CheckName, int)
        Each with the level of its size; several only of geometry and labels.
    rig : (str, str)
        Kind of the pair, and layout of the target.
    folder : Path
        For pictures.
    random : numpy.random.Generator
    """
    kind, layout = rig
    drawn = [one for one in mistakes if one[0] in DRAWN]
    if drawn:
        (check, level), *_ = drawn
        return _drawn(check, level, (good_shoot(kind, layout, _DRAWN_VIEWS, random), folder), random)
    shoot = good = _held(mistakes, rig, random)
    for check, level in mistakes:
        if check in MISTAKES:
            pattern = int(random.integers(2**31))
            size = TIMES[level] * harmful_size(check, good, pattern)
            shoot = MISTAKES[check](shoot, size, np.random.default_rng(pattern))
    dots = simulated_dots(shoot, random)
    for check, level in mistakes:
        if check in MISLABELLED:
            dots = MISLABELLED[check](dots, size_of(check, kind, level), random)
    return Evidence(shoot.described, dots)


def drawn_evidence(rig: tuple[str, str], folder: Path, random: np.random.Generator) -> Evidence:
    """Return the evidence of a good shoot with its pictures."""
    return _shown(good_shoot(*rig, _DRAWN_VIEWS, random), Fault(), folder, random)


def _held(
    mistakes: Sequence[tuple[CheckName, int]], rig: tuple[str, str], random: np.random.Generator
) -> HeldShoot:
    """Return the shoot as the hand takes it, with mistakes of the hand."""
    views, hand, pair = int(random.integers(*_VIEWS)), Hand(), PAIRS[rig[0]]
    for check, level in mistakes:
        size = size_of(check, rig[0], level)
        if check is CheckName.TOO_FEW_VIEWS:
            views, pair = round(size), replace(pair, board_mm=_SMALL_BOARD * pair.board_mm)
        elif check in _SINGLE_HAND:
            hand = _SINGLE_HAND[check](size)
    return good_shoot(*rig, views, random, hand, pair)


def _drawn(check: CheckName, level: int, of: tuple[HeldShoot, Path], random: np.random.Generator) -> Evidence:
    shoot, folder = of
    size = size_of(check, shoot.kind, level)
    if check is CheckName.WRONG_TARGET:
        named = replace(shoot, described=_another(shoot.printed, level))
        return _shown(named, Fault(), folder, random)
    camera = CAMERAS[int(random.integers(2))]
    count = int(random.choice([1, 3, len(shoot.views)]))
    views = frozenset(random.permutation(shoot.views)[:count].tolist())
    if check is CheckName.EXPOSURE:
        fault = Fault(camera, views, stops=size)
    elif random.random() < 0.5:  # noqa: PLR2004 -- as often
        fault = Fault(camera, views, blur_px=size)
    else:
        fault = Fault(camera, views, motion_px=_MOTION * size)
    return _shown(shoot, fault, folder, random)


def _shown(shoot: HeldShoot, fault: Fault, folder: Path, random: np.random.Generator) -> Evidence:
    measured = drawn_shoot(shoot, fault, folder, random)
    return Evidence(shoot.described, detections_of(measured), None, tuple(measured))


def _another(printed: DotGrid, level: int) -> DotGrid:
    """Return a target that is not the printed one: rings elsewhere, or none, or another number of dots."""
    if level == 0 and printed.rings is not None:
        return printed.model_copy(update={"rings": Rings(origin=(2, 3), x=(9, 3), y=(2, 8))})
    cols, rows = (2, 1) if level == 1 else (-1, -1)
    size = {"cols": printed.cols + cols, "rows": printed.rows + rows}
    return printed.model_copy(
        update={**size, "rings": None, "ring_outer_diameter_mm": None, "ring_inner_diameter_mm": None}
    )
