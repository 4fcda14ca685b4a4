"""The suite: about a hundred rendered pictures, each with its own difficulties, detected and checked."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.bench.detect.design import PictureDesign, designs
from labcal.bench.detect.dot_visibility import DotVisibility, dot_visibility
from labcal.bench.detect.exposure import blur_px, exposed_picture, falling_light
from labcal.bench.detect.opencv_grid import MODES, finds_grid
from labcal.bench.detect.outcome import Outcome, outcome_table, suite_checks, suite_figures
from labcal.bench.detect.suite_scene import SuiteScene, suite_scene
from labcal.bench.detect.verdict import verdict_of
from labcal.bench.groups import Bench, Findings
from labcal.bench.held_board import blurred_scene
from labcal.detect.detector import detect_dots
from labcal.render.film import Shading
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.variant import MONO, renderer
from labcal.report.overlay import draw_overlay
from labcal.run.made import make_folder
from labcal.run.outputs import write_file
from labcal.run.progress import Progress
from labcal.shoot.pictures import write_picture
from labcal.targets.grid import DotGrid

PICTURES, QUICK_PICTURES = 320, 48
CLEAR_PX = 1.5
"""A measurable dot is this far, and two standard deviations of the blur, from what might disturb it."""


@dataclass(frozen=True)
class SuitePicture:
    """One picture, and its true values."""

    design: PictureDesign
    target: DotGrid
    picture: np.ndarray
    blur_px: float
    seen: DotVisibility


def suite_pictures(count: int, seed: int, names: frozenset[str] = frozenset()) -> Iterator[SuitePicture]:
    """Yield the suite's pictures.

    Parameters
    ----------
    count : int
        Of the whole suite.
    seed : int
    names : frozenset of str
        Only the pictures of these names; all where empty.
    """
    for design in designs(count, seed):
        if not names or design.name in names:
            stage = suite_scene(design, seed)
            first = dot_visibility(stage.scene, stage.take, CLEAR_PX)
            blur = blur_px(design, first.minor_px[first.in_frame])
            seen = dot_visibility(stage.scene, stage.take, CLEAR_PX + 2.0 * blur)
            light = _light(stage, blur, falling_light(design, seen), seed)
            picture = exposed_picture(light, design, seed)
            yield SuitePicture(design, stage.scene.grid, picture, blur, seen)


def _light(stage: SuiteScene, blur: float, shading: Shading, seed: int) -> np.ndarray:
    """Render a picture's light, shaded and then blurred (px)."""
    with renderer(MONO) as mi:
        laboratories = Laboratories(mi, blurred_scene(stage.scene, blur), seed)
        return render_light(laboratories, Case(stage.take, seed), shading)


def suite_findings(bench: Bench) -> Findings:
    """Return the checks of the suite and the figures of OpenCV on the same pictures; write its table."""
    count = QUICK_PICTURES if bench.quick else PICTURES
    outcomes = suite_outcomes(count, bench.seed, bench.folder, bench.progress)
    write_file(bench.folder / "suite.csv", outcome_table(outcomes), force=True)
    return Findings(suite_checks(outcomes), suite_figures(outcomes))


def suite_outcomes(count: int, seed: int, folder: Path, progress: Progress) -> list[Outcome]:
    """Detect dots in every picture of a suite, and keep the pictures that failed.

    Parameters
    ----------
    count : int
    seed : int
    folder : Path
        It gets in ``failures`` the pictures that a person should look at, each also with what was found drawn
        in.
    progress : Progress
        Notified of every picture.
    """
    progress.start("suite", count)
    outcomes = []
    failures = folder / "failures"
    for one in suite_pictures(count, seed):
        dots = detect_dots(one.picture, one.target)
        outcome = Outcome(
            design=one.design,
            dots=one.target.count,
            hidden=one.seen.hidden_share,
            rings_in_sight=one.seen.rings_in_sight,
            blur_px=one.blur_px,
            verdict=verdict_of(dots, one.seen, one.target.cols),
            opencv=tuple(finds_grid(one.picture, one.target, one.seen, flags) for flags in MODES.values()),
        )
        outcomes.append(outcome)
        if outcome.failed:
            name = one.design.name
            make_folder(failures)
            write_picture(failures / f"{name}.png", one.picture, force=True)
            overlay = draw_overlay(one.picture, dots, one.target)
            write_picture(failures / f"{name}-overlay.png", overlay, force=True)
        progress.advance()
    return outcomes
