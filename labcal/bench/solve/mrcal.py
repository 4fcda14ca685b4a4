"""Comparison with mrcal by its own programs: the same dots, held-out views, and camera files.

Both calibrate one camera from the training views: labcal with ``rational8``, mrcal with OPENCV8, which is the
same formula, and a flat board. Then both lenses are held, and labcal's pose fitter, the same for both, lays
the target into the views that neither has seen: every other view, and of few pictures each fifth in turn.

The limit on the ratio of errors is 1.001 and not 1: where noise is all there is, both come to the same
minimum, and what noise in the training views does to a lens adds a thousandth to the error. From seed to
seed the ratio runs from 0.9999 to 1.0006, since mrcal holds what dots leave open a little tighter.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from labcal.bench.detect.bias import bench_target
from labcal.bench.detect.real import SETS, real_home
from labcal.bench.groups import Bench, Findings
from labcal.bench.hand_views import CAMERA, HandViews, dots_at, poses_in_hand
from labcal.bench.solve.mrcal_programs import (
    calibrated_by_mrcal,
    is_installed,
    projected,
    reprojected,
)
from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.eccentricity import ROUNDS
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.camera import Camera
from labcal.cameras.interop.mrcal import write_mrcal
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.measure import detections_of, measure_picture
from labcal.correspond.sources import find_sources
from labcal.geometry.poses import from_rotation_vector, transform
from labcal.report.bench import Check, Figure, at_most
from labcal.rng import generator
from labcal.run.made import make_folder
from labcal.run.outputs import write_file
from labcal.targets.catalogue import AnyTarget, load_target

LENS = "rational8"
SIZE = (2048, 1536)
VIEWS = HandViews(views=40, tilt_deg=50.0, radius_px=24.0)
NOISE_PX = 0.1
SEEDS, SEEDS_QUICK = 10, 3
RATIO_LIMIT = 1.001
PIXEL_LIMIT = 1e-6
REAL_SET = "rendered_black"
FOLDS = 5
"""Of its ten views, two are held out at a time: from five, OPENCV8 finds no camera at all."""
_DIRECTIONS = 1000


def bench_camera() -> Camera:
    """Return a camera with a rational lens of some barrel distortion."""
    K = np.array([[1900.0, 0.0, 1031.0], [0.0, 1903.0, 758.0], [0.0, 0.0, 1.0]])
    dist = np.array([0.4, -0.2, 3e-4, -2e-4, 0.01, 0.55, -0.12, 0.005])
    return Camera(K, LENS, dist, np.eye(4), SIZE)


def mrcal_findings(bench: Bench) -> Findings:
    """Return the comparison with mrcal; only a note if mrcal is not installed."""
    if not is_installed():
        missing = "mrcal: left out, since it is not installed (Debian packages mrcal, python3-mrcal)"
        return Findings([], [], (missing,))
    folder = bench.folder.resolve() / "mrcal"  # their programs run in it
    make_folder(folder)
    seeds = SEEDS_QUICK if bench.quick else SEEDS
    bench.progress.start("against mrcal", seeds)
    errors = []
    for number in range(seeds):
        errors.append(_simulated(bench.seed + number, folder / f"seed-{number}"))
        bench.progress.advance()
    simulated = _compared("simulated", errors)
    projection = Findings(_projection_checks(bench.seed, folder), [])
    home = real_home()
    if home is None:
        real = Findings([], [], (f"mrcal: {REAL_SET} left out, since it is not at hand",))
    else:
        real = _compared(REAL_SET, _real(home, folder))
    found = (simulated, projection, real)
    return Findings(
        [check for one in found for check in one.checks],
        [figure for one in found for figure in one.references],
        tuple(note for one in found for note in one.notes),
    )


def _simulated(seed: int, folder: Path) -> tuple[float, float] | None:
    """Return the held-out RMS of labcal's and mrcal's camera, px, from images of centres with noise."""
    camera, target = bench_camera(), bench_target()
    poses = poses_in_hand(camera, target, VIEWS, generator(seed, "bench mrcal", "poses"))
    noise = NOISE_PX * generator(seed, "bench mrcal", "noise").standard_normal((len(poses), target.count, 2))
    seen = [camera.project(transform(T, target.points())) for T in poses]
    noisy = [one.q + added for one, added in zip(seen, noise, strict=True)]
    dots = dots_at(noisy, [one.ok for one in seen], target, SIZE, NOISE_PX)
    even = np.isin(dots.view, dots.views[::2])
    return _held_out(dots.where(even), dots.where(~even), target, 0, folder)


def _real(home: Path, folder: Path) -> list[tuple[float, float] | None]:
    """Return the same for every camera of a set of pictures, with each fifth of the views held out once."""
    (chosen,) = (one for one in SETS if one.folder == REAL_SET)
    target = load_target(chosen.target)
    sources = find_sources([str(home / chosen.folder)], chosen.endings)
    dots = detections_of([measure_picture(source, target) for source in sources])
    found = []
    for name in dots.cameras:
        own = dots.where(dots.camera == name)
        plain = replace(own, image=np.char.add(own.view, ".png"), camera=np.full(len(own), CAMERA))
        for fold in range(FOLDS):
            held = np.isin(plain.view, plain.views[fold::FOLDS])
            place = folder / f"{REAL_SET}-{name}-{fold}"
            found.append(_held_out(plain.where(~held), plain.where(held), target, ROUNDS, place))
    return found


def _held_out(
    training: Detections, test: Detections, target: AnyTarget, eccentricity_rounds: int, folder: Path
) -> tuple[float, float] | None:
    """Return the held-out RMS of labcal's and of mrcal's camera, px; None where mrcal finds none."""
    make_folder(folder)
    ours = calibrate_handheld(
        training, target, LENS, HandheldSettings(eccentricity_rounds=eccentricity_rounds)
    ).rig
    # From where it can hardly go wrong: the focal length that labcal has found.
    focal = round(ours.camera(CAMERA).intrinsics[0])
    theirs = calibrated_by_mrcal(training, target, float(focal), folder)
    if theirs is None:
        return None
    held = [
        HandheldSettings(lenses=Lenses.FIXED, start=rig, eccentricity_rounds=eccentricity_rounds)
        for rig in (ours, Rig.of({CAMERA: theirs}))
    ]
    first, second = (calibrate_handheld(test, target, LENS, settings).rms_px for settings in held)
    return first, second


def _compared(what: str, found: Sequence[tuple[float, float] | None]) -> Findings:
    """Return the ratio of errors over all seeds or folds in which mrcal found a camera, and the errors."""
    errors = np.array([pair for pair in found if pair is not None]).reshape(-1, 2)
    notes: tuple[str, ...] = ()
    if len(errors) < len(found):
        lost = len(found) - len(errors)
        notes = (f"mrcal, {what}: {lost} of {len(found)} left out, in which mrcal found no camera",)
    if len(errors) == 0:
        return Findings([], [], notes)
    rms = np.sqrt((errors**2).mean(axis=0))
    single = errors[:, 0] / errors[:, 1]
    ratio = f"mrcal, {what}: held-out RMS of labcal over mrcal's"
    figures = (
        ("held-out RMS of labcal, px", rms[0]),
        ("held-out RMS of mrcal, px", rms[1]),
        ("least ratio of one", single.min()),
        ("greatest ratio of one", single.max()),
    )
    references = [Figure(name=f"mrcal, {what}: {name}", value=float(value)) for name, value in figures]
    return Findings([at_most(ratio, float(rms[0] / rms[1]), RATIO_LIMIT)], references, notes)


def _projection_checks(seed: int, folder: Path) -> list[Check]:
    """Return the difference of projections of mrcal and labcal, with the model that labcal writes."""
    T_cam_world = from_rotation_vector(np.array([0.2, -0.1, 0.3]), np.array([120.0, -80.0, 300.0]))
    lens = bench_camera()
    camera = Camera(lens.K, lens.lens, lens.dist, T_cam_world, lens.size)
    turned = from_rotation_vector(np.array([0.2, -0.1, 0.3]), np.zeros(3))
    model = folder / "labcal.cameramodel"
    write_file(model, write_mrcal(Rig.of({CAMERA: camera}), ".cameramodel").files[0].text, force=True)
    random = generator(seed, "bench mrcal", "directions")
    q = random.uniform([0.0, 0.0], SIZE, (_DIRECTIONS, 2))
    rays = camera.rays(q)
    points = rays.origin + random.uniform(500.0, 3000.0, (_DIRECTIONS, 1)) * rays.direction
    at_origin = Camera(lens.K, lens.lens, lens.dist, turned, lens.size)
    by_program = reprojected(model, rays.direction) - at_origin.project(rays.direction).q
    by_module = projected(model, points) - camera.project(points).q
    return [
        at_most(
            "mrcal: mrcal-reproject-points (prints 1e-6 px) from labcal, each axis, px",
            float(np.abs(by_program).max()),
            PIXEL_LIMIT,
        ),
        at_most(
            "mrcal: projection of points in space from labcal, px",
            float(np.linalg.norm(by_module, axis=1).max()),
            PIXEL_LIMIT,
        ),
    ]
