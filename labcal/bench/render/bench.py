"""``labcal bench render``: all checks of the rendered laboratory."""

from pathlib import Path

import numpy as np

from labcal.bench.render.cost import PAIRS, cost_checks, shoot_check
from labcal.bench.render.dots import TILTS_DEG, dot_checks
from labcal.bench.render.rays import opencv_checks, ray_checks
from labcal.bench.render.reproducibility import reproducibility_checks
from labcal.bench.render.sensors import SIDE, sensor_checks
from labcal.bench.settings import BenchSettings
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.variant import MONO, renderer
from labcal.report.bench import BenchResult
from labcal.run.json_text import to_json
from labcal.run.outputs import write_file
from labcal.run.progress import Progress
from labcal.run.unfinished import unfinished_folder
from labcal.scene.catalogue import load_scene
from labcal.scene.plan import planned_takes
from labcal.scene.views import planned_views

QUICK_TILTS_DEG = (0.0, 60.0)
QUICK_PAIRS = 4
ROUNDS, QUICK_ROUNDS = 5, 2


def bench_render(folder: Path, settings: BenchSettings, progress: Progress) -> BenchResult:
    """Measure every check and write ``results.json``.

    Parameters
    ----------
    folder : Path
        It appears when all is measured.
    settings : BenchSettings
    progress : Progress

    Raises
    ------
    OutputError
        The folder exists already.
    DeviceError
        There is no LLVM library for the renderer.
    """
    seed, quick = settings.seed, settings.quick
    with unfinished_folder(folder, f"bench render {quick} {seed}", force=settings.force) as working:
        checks = [
            *ray_checks(seed),
            *opencv_checks(seed),
            *sensor_checks(_even_light(seed), seed),
            *dot_checks(seed, QUICK_TILTS_DEG if quick else TILTS_DEG, progress),
            *cost_checks(QUICK_ROUNDS if quick else ROUNDS, progress),
            shoot_check(QUICK_PAIRS if quick else PAIRS, progress),
            *reproducibility_checks(seed, progress),
        ]
        result = BenchResult(bench="render", quick=quick, checks=tuple(checks))
        write_file(working / "results.json", to_json(result) + "\n", force=True)
    return result


def _even_light(seed: int) -> np.ndarray:
    """Render a flat field: the middle of a board without dots under even light."""
    size = f"cameras.left.size=[{SIDE}, {SIDE}]"
    board = ("board.dark=[0.85, 0.85, 0.85]", "lamps=[{kind: ambient, radiance: 1}]", "photometry.bayer=off")
    near = ("cameras.left.focal_px=3000", "cameras.left.principal_px=null", "cameras.left.dist=[]", "spp=4")
    scene = load_scene("webcam-plane", (size, *board, *near))
    take = planned_takes(scene, planned_views(scene, seed)[:1], seed).takes[0]
    with renderer(MONO) as mi:
        return render_light(Laboratories(mi, scene, seed), Case(take, seed))
