"""Duration of the bundle adjustment compared with ``cv2.stereoCalibrate``, and its growth."""

import resource
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import cv2
import numpy as np

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.corruption import corruption_checks
from labcal.bench.solve.held_rig import CAMERAS, SIZE, TARGET, HeldRig
from labcal.calibrate.adjustment.problem import AdjustmentProblem
from labcal.calibrate.adjustment.rounds import DAMPING, STOPPING
from labcal.calibrate.adjustment.state import Freedom, Lenses, RigState
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.lens_start import start_from_camera
from labcal.calibrate.rig_start import SingleCamera, rig_start
from labcal.optim.levenberg_marquardt import minimize
from labcal.optim.solution import Solution
from labcal.report.bench import Check, Figure, at_most
from labcal.run.executor import open_pool
from labcal.run.threads import one_blas_thread

SIZES = (200, 1000, 4000)
"""Views."""
GROWTH_LIMITS = (6.0, 4.8)
"""1.2 times as many times more views."""
TIME_LIMIT, MEMORY_LIMIT_GIB = 0.1, 4.0
COST_LIMIT = 1.0 + 1e-9
"""The same but for rounding."""
ROUNDS, QUICK_ROUNDS, GROWTH_ROUNDS = 3, 2, 3
_TERMINATION = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-9)
_FIXED_DOTS = Freedom(Lenses.FREE, np.zeros((3 * TARGET.count, 0)))


def adjustment_findings(bench: Bench) -> Findings:
    """Return the ratios of times and costs to OpenCV's, and of times with more views to those with fewer.

    Both start from the same lenses and find the poses of target and cameras by themselves; both estimate all
    lenses (Brown with five coefficients), all poses of the target and the cameras' relative pose.
    """
    sizes = SIZES[:2] if bench.quick else SIZES
    bench.progress.start("adjustment", 3)
    checks, references = _compare_with_opencv(bench.seed, QUICK_ROUNDS if bench.quick else ROUNDS)
    bench.progress.advance()
    # In a process of its own, so that its memory is not shared.
    with open_pool(1) as child:
        growth = child.submit(measured_growth, sizes, bench.seed).result()
    bench.progress.advance()
    name = "adjustment: time with {} views over that with {}"
    for number, limit in zip(range(1, len(sizes)), GROWTH_LIMITS, strict=False):
        more, fewer = sizes[number], sizes[number - 1]
        ratio = growth.seconds[number] / growth.seconds[number - 1]
        checks.append(at_most(name.format(more, fewer), ratio, limit))
    checks.append(at_most(f"adjustment, {sizes[-1]} views: memory, GiB", growth.peak_gib, MEMORY_LIMIT_GIB))
    checks += corruption_checks(bench.seed)
    bench.progress.advance()
    references.append(Figure(name=f"adjustment, {sizes[-1]} views, s", value=growth.seconds[-1]))
    left_out = ("adjustment: 4,000 views are left out by --quick",) if bench.quick else ()
    return Findings(checks, references, left_out)


def _compare_with_opencv(seed: int, rounds: int) -> tuple[list[Check], list[Figure]]:
    """Return time and cost relative to OpenCV at the smallest number of views."""
    held = HeldRig.drawn(SIZES[0], seed)
    points, lenses = held.detections(), held.lenses_off()
    pictures = [points.where(points.camera == name).by_view() for name in CAMERAS]
    dots = [TARGET.points().astype(np.float32)] * SIZES[0]
    seen = [[picture.position.astype(np.float32) for picture in of_camera] for of_camera in pictures]

    def ours() -> Solution[RigState]:
        with one_blas_thread():
            single = []
            for name, lens, of_camera in zip(CAMERAS, lenses, pictures, strict=True):
                start = start_from_camera(of_camera, TARGET, lens)
                single.append(SingleCamera(name, start.camera, np.arange(SIZES[0]), start.T_cam_target))
            problem = AdjustmentProblem(replace(held.observations), _FIXED_DOTS)
            return minimize(problem, rig_start(single, TARGET.points()), STOPPING, DAMPING)

    def theirs() -> float:
        (first, second), (left, right) = seen, lenses
        rms, *_ = cv2.stereoCalibrate(
            dots, first, second, left.K.copy(), left.dist.copy(), right.K.copy(), right.dist.copy(), SIZE,
            flags=cv2.CALIB_USE_INTRINSIC_GUESS, criteria=_TERMINATION,
        )  # fmt: skip
        return float(rms)

    def whole() -> object:
        return calibrate_handheld(points, TARGET, "brown5", HandheldSettings(eccentricity_rounds=0))

    times = np.array([[_seconds(call) for call in (ours, theirs, whole)] for _ in range(rounds)])
    our_s, their_s, whole_s = times.min(axis=0)
    squares = (ours().parameters.residuals(held.observations) ** 2).sum()
    cost = squares / (len(held.observations) * theirs() ** 2)
    name = f"adjustment, {SIZES[0]} views of {TARGET.count} dots by 2 cameras"
    return [
        at_most(f"{name}: time over that of cv2.stereoCalibrate", our_s / their_s, TIME_LIMIT),
        at_most(f"{name}: cost over that of cv2.stereoCalibrate", cost, COST_LIMIT),
    ], [
        Figure(name=f"{name}: labcal, 1 thread, s", value=our_s),
        Figure(name=f"{name}: cv2.stereoCalibrate, {cv2.getNumThreads()} threads, s", value=their_s),
        Figure(name=f"{name}: the whole of labcal calibrate without centre bias, s", value=whole_s),
    ]


@dataclass(frozen=True)
class Growth:
    """Durations of adjustments of several sizes."""

    seconds: tuple[float, ...]
    """By size, the best of all rounds."""
    peak_gib: float
    """Most memory that the process had at any time."""


def measured_growth(sizes: tuple[int, ...], seed: int) -> Growth:
    """Adjust rigs of several numbers of views in turn."""
    rigs = [HeldRig.drawn(views, seed) for views in sizes]
    starts = [rig.start(seed) for rig in rigs]
    times = np.full((GROWTH_ROUNDS, len(sizes)), np.nan)
    with one_blas_thread():
        for row in times:
            for number, (rig, start) in enumerate(zip(rigs, starts, strict=True)):
                problem = AdjustmentProblem(replace(rig.observations), _FIXED_DOTS)
                row[number] = _seconds(partial(minimize, problem, start, STOPPING, DAMPING))
    peak_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return Growth(tuple(times.min(axis=0).tolist()), peak_kib / 2**20)


def _seconds(call: Callable[[], object]) -> float:
    """Return the duration of a call."""
    began = time.perf_counter()
    call()
    return time.perf_counter() - began
