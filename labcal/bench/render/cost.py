"""Cost of lenses compared with Mitsuba's perspective camera, and cost of a whole shoot."""

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from labcal.bench.render.optics import OPTICS, PARAMETRIC, description
from labcal.geometry.poses import inverse
from labcal.render.camera_rays import CameraRays, Pixels, Shading
from labcal.render.laboratory import Draw, Laboratory, Rays
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.render.variant import MONO, Jit, renderer
from labcal.report.bench import Check, at_most
from labcal.run.progress import Progress
from labcal.scene.catalogue import load_scene
from labcal.scene.model import Scene
from labcal.scene.views import planned_views

SIZE = (1280, 960)
SPP = 16
PARAMETRIC_LIMIT = 1.15
REFRACTED_LIMIT = 2.0
OVERHEAD_LIMIT_S = 0.05
PAIRS = 40
SHOOT_SPP = 32
SHOOT_LIMIT_S = 180.0


class _MitsubasPerspective:
    """The rays of ``perspective`` of Mitsuba in place of those of labcal."""

    def __init__(self, mi: Jit, scene: Scene) -> None:
        camera = scene.cameras["left"]
        width, height = SIZE
        turn = np.diag([-1.0, -1.0, 1.0, 1.0])  # Mitsuba's x runs to the left, its y up
        pose = inverse(camera.camera().T_cam_world) @ turn
        self._mi, self._size = mi, (width, height)
        self._sensor = mi.load_dict(
            {
                "type": "perspective",
                "fov": float(np.degrees(2.0 * np.arctan(0.5 * width / camera.focal_px))),
                "to_world": mi.ScalarTransform4f(pose),
                "film": {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "luminance"},
            }
        )

    def rays(self, pixels: Pixels) -> tuple[Jit, Jit]:
        """Return Mitsuba's rays and weights."""
        mi, (width, height) = self._mi, self._size
        position = mi.Point2f(mi.Float((pixels.u + 0.5) / width), mi.Float((pixels.v + 0.5) / height))
        ray, weight = self._sensor.sample_ray(mi.Float(0.0), mi.Float(0.0), position, mi.Point2f(0.5))
        return ray, weight.x


def cost_checks(rounds: int, progress: Progress) -> list[Check]:
    """Return the time of every lens over that of the perspective of Mitsuba, and the overhead of a view.

    The two are traced in turn through the same loop, scene and samples; the ratio is the median of the
    rounds', so that what else the machine does cancels.

    Parameters
    ----------
    rounds : int
    progress : Progress
        Notified of every lens.
    """
    scene = _scene()
    view = planned_views(scene, 0)[0]
    progress.start("cost", len(OPTICS))
    checks = []
    with renderer(MONO) as mi:
        laboratory = Laboratory(mi, scene, SIZE, 0)
        laboratory.place(view.T_world_target)
        theirs = _MitsubasPerspective(mi, scene)
        place = scene.cameras["left"].model_dump(include={"eye_mm", "look_at_mm", "up"})
        for name in OPTICS:
            ours = CameraRays(mi, description(name, SIZE, place).camera(), None, Shading())
            ratio = _ratio(partial(_trace, laboratory, ours), partial(_trace, laboratory, theirs), rounds)
            limit = PARAMETRIC_LIMIT if name in PARAMETRIC else REFRACTED_LIMIT
            checks.append(at_most(f"time of {name} over Mitsuba's perspective", ratio, limit))
            progress.advance()
        checks += _view_checks(laboratory, scene)
    return checks


def _scene() -> Scene:
    """Return webcam-plane with grey pictures of 1280 x 960."""
    size = f"cameras.left.size=[{SIZE[0]}, {SIZE[1]}]"
    larger = (size, "cameras.left.focal_px=1400", "cameras.left.principal_px=null", "photometry.bayer=off")
    return load_scene("webcam-plane", larger)


def _trace(laboratory: Laboratory, camera: Rays) -> None:
    """Trace a whole picture."""
    step = laboratory.rows_at_once(SPP)
    for top in range(0, SIZE[1], step):
        laboratory.trace(camera, slice(top, min(top + step, SIZE[1])), Draw(0, SPP, 0, SPP))


def _ratio(ours: Callable[[], None], theirs: Callable[[], None], rounds: int) -> float:
    """Return the median ratio of two durations, taken in turn after a first round that compiles."""
    ratios = []
    for number in range(rounds + 1):
        began = time.perf_counter()
        ours()
        between = time.perf_counter()
        theirs()
        if number > 0:
            ratios.append((between - began) / (time.perf_counter() - between))
    return float(np.median(ratios))


def _view_checks(laboratory: Laboratory, scene: Scene) -> list[Check]:
    """Return the number of kernels compiled, and the other overhead, from the second view on."""
    import drjit as dr  # noqa: PLC0415 -- only once Dr.Jit was told where LLVM is

    camera = scene.cameras["left"].camera()
    views = planned_views(scene, 0)
    overheads, compiled = [], 0
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        for number in range(5):
            dr.kernel_history_clear()
            began = time.perf_counter()
            laboratory.place(views[number % len(views)].T_world_target)
            _trace(laboratory, laboratory.rays_of(camera))
            seconds = time.perf_counter() - began
            history = [entry for entry in dr.kernel_history() if "cache_hit" in entry]
            if number > 0:
                compiled += sum(not entry["cache_hit"] for entry in history)
                overheads.append(seconds - 1e-3 * sum(entry["execution_time"] for entry in history))
    return [
        at_most("kernels compiled after the first view", compiled, 0),
        at_most(
            "overhead of a further view over its kernels, s", float(np.median(overheads)), OVERHEAD_LIMIT_S
        ),
    ]


def shoot_check(pairs: int, progress: Progress) -> Check:
    """Return the time of a shoot of 40 pairs on two workers, extrapolated if fewer are rendered.

    Parameters
    ----------
    pairs : int
    progress : Progress
        Notified of every picture.
    """
    sizes = tuple(
        f"cameras.{name}.{key}={value}"
        for name in ("left", "right")
        for key, value in (("size", list(SIZE)), ("focal_px", 1400), ("principal_px", "null"))
    )
    more = ("placement.train=40", "placement.test=0", "photometry.bayer=off", f"spp={SHOOT_SPP}")
    scene = load_scene("webcam-handheld", (*sizes, *more))
    with TemporaryDirectory() as home:
        began = time.perf_counter()
        render_shoot(scene, Path(home) / "shoot", RenderSettings(views=pairs, workers=2), progress)
        seconds = time.perf_counter() - began
    scaled = "" if pairs == PAIRS else f", scaled up from {pairs}"
    name = f"shoot of {PAIRS} pairs of 1280 x 960 at {SHOOT_SPP} samples{scaled}, s"
    return at_most(name, seconds * PAIRS / pairs, SHOOT_LIMIT_S)
