"""A rendered shoot: the pictures of a scene, the manifest, and the truth in a separate folder."""

import json
import time
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

from labcal.arguments import set_checked, truth_value, whole_number
from labcal.cameras.record import CameraRecord, matrix4_record
from labcal.errors import WorkerError
from labcal.paths import AnyPath, as_path
from labcal.render.irradiance import Case
from labcal.render.picture import Job, render_picture
from labcal.render.sensor_response import exposure_for
from labcal.run.executor import finished, open_executor
from labcal.run.failed_cases import raise_failed_cases
from labcal.run.machine import package_version
from labcal.run.made import PROVENANCE, make_folder, provenance_text
from labcal.run.outputs import write_file
from labcal.run.progress import Progress
from labcal.run.unfinished import is_finished, unfinished_folder
from labcal.scene.check import check_scene
from labcal.scene.lighting import brightest_board
from labcal.scene.mistakes import Outcome
from labcal.scene.model import Scene
from labcal.scene.plan import built_scene, planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.truth import true_dots, true_view
from labcal.scene.views import PlannedView, planned_views
from labcal.shoot.dataset import Shoot, open_shoot, write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, ViewEntry
from labcal.shoot.truth import FOLDER, Truth, write_truth

_ADVICE = "Free memory, render smaller pictures (or fewer at a time: `workers`), or leave those views out."
PACKAGES = ("labcal", "mitsuba", "drjit", "numpy", "opencv-contrib-python-headless")


@dataclass(frozen=True)
class RenderSettings:
    """Settings of the rendering of a scene.

    Examples
    --------
    >>> from labcal.pipeline import RenderSettings
    >>> quick = RenderSettings(spp=16, views=4)
    >>> quick.spp, quick.seed
    (16, 0)
    """

    spp: int | None = None
    """Rays a pixel; the scene's own number where left out."""
    views: int | None = None
    """Only the first so many views; all where left out."""
    seed: int = 0
    """Seed of noise, fixed patterns and places that are drawn."""
    workers: int = 1
    """Processes that render side by side, one thread each."""
    force: bool = False
    """Replace a shoot that is there already."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, or a number is too small.
        """
        optional = {name: getattr(self, name) for name in ("spp", "views")}
        numbers = {
            **{n: None if value is None else whole_number(value, n, 1) for n, value in optional.items()},
            "seed": whole_number(self.seed, "seed", 0),
            "workers": whole_number(self.workers, "workers", 1),
        }
        set_checked(self, {**numbers, "force": truth_value(self.force, "force")})


def render_shoot(scene: Scene, folder: AnyPath, settings: RenderSettings, progress: Progress) -> Shoot:
    """Render a scene into a new shoot folder.

    The folder appears when everything is in it. A run that was interrupted leaves ``<folder>.unfinished``;
    the same call goes on with it and keeps the pictures that are there. A shoot that the same call made
    already, and in which nothing has changed since, is opened: a script can run twice.

    Parameters
    ----------
    scene : Scene
    folder : str or os.PathLike
        The shoot to appear.
    settings : RenderSettings
    progress : Progress
        Notified of every picture.

    Returns
    -------
    Shoot
        The same scene, samples and seed give the same bytes in all of its files but ``run.json``, however
        many workers there are.

    Raises
    ------
    InputError
        Something in the scene or the settings cannot be; nothing was rendered.
    OutputError
        The folder exists already, or the disk refuses.
    DeviceError
        There is no LLVM library for the renderer, or a picture ends each worker process that renders it.
    """
    folder = as_path(folder)
    if settings.spp is not None:
        scene = scene.with_spp(settings.spp)
    command = _command(scene, settings)
    if not settings.force and is_finished(folder, command):
        return open_shoot(folder)
    check_scene(scene, settings.seed, settings.views)
    every_view = planned_views(scene, settings.seed)
    views = every_view[: settings.views]
    outcome = planned_takes(scene, views, settings.seed)
    exposure = exposure_for(scene.photometry, brightest_board(scene, every_view))
    built = built_scene(scene)
    began = time.time()
    with unfinished_folder(folder, command, force=settings.force) as working:
        images = working / "images"
        make_folder(images)
        jobs = [
            Job(built, Case(take, settings.seed), exposure, working / _image(scene, take.view, take.camera))
            for take in outcome.takes
        ]
        seconds = _render(jobs, settings.workers, progress)
        write_manifest(working, _manifest(scene, views))
        _write_truth(working, scene, outcome, settings.seed)
        _write_run(working, seconds, time.time() - began, replace(settings, spp=scene.spp))
    return open_shoot(folder)


def _render(jobs: list[Job], workers: int, progress: Progress) -> dict[str, float]:
    """Render the missing pictures, and return the duration of each in seconds by file name."""
    # A power cut may leave an empty file of that name.
    missing = [job for job in jobs if not (job.path.exists() and job.path.stat().st_size > 0)]
    progress.start("render", len(jobs))
    progress.advance(len(jobs) - len(missing))
    seconds: dict[str, float] = {}
    given_up: dict[str, WorkerError] = {}
    with open_executor(min(workers, max(1, len(missing)))) as pool:
        for number, future in finished(pool, render_picture, [(job,) for job in missing]):
            name = missing[number].path.name
            try:
                seconds[name] = future.result()
            except WorkerError as error:
                given_up[name] = error
            else:
                progress.advance()
    raise_failed_cases(given_up, len(jobs), "pictures", _ADVICE)
    return dict(sorted(seconds.items()))


def _image(scene: Scene, view: str, camera: str) -> str:
    """Return the path of a picture in the shoot."""
    return f"images/{view}_{camera}.{scene.photometry.format.value}"


def _command(scene: Scene, settings: RenderSettings) -> str:
    """Return the text of everything that determines the bytes."""
    return "render " + json.dumps(
        {"render": scene.model_dump(mode="json"), "seed": settings.seed, "views": settings.views},
        sort_keys=True,
    )


def _manifest(scene: Scene, views: tuple[PlannedView, ...]) -> Manifest:
    """Return the manifest, which holds no truth."""
    entries = []
    for view in views:
        nominal = view.T_world_target_nominal
        entries.append(
            ViewEntry(
                name=view.name,
                images={camera: _image(scene, view.name, camera) for camera in scene.cameras},
                role=view.role,
                T_world_target_nominal=None if nominal is None else matrix4_record(nominal),
            )
        )
    sizes = {name: CameraEntry(size=camera.size) for name, camera in scene.cameras.items()}
    return Manifest(target=scene.target, cameras=sizes, views=tuple(entries))


def _write_truth(working: Path, scene: Scene, outcome: Outcome, seed: int) -> None:
    """Write the scene, cameras, poses, and every dot."""
    cameras = {name: CameraRecord.of(camera) for name, camera in scene.true_cameras().items()}
    truth = Truth(
        cameras=cameras,
        views={
            view: true_view(list(takes), cameras)
            for view, takes in groupby(outcome.takes, key=lambda take: take.view)
        },
        mistake=scene.mistake,
        mistake_description=outcome.wrong,
        mistake_views=outcome.wrong_views,
    )
    built = built_scene(scene)
    made = TruePrint.of(built.target, built.board, seed)
    write_truth(working, truth, [true_dots(built, made, take) for take in outcome.takes])
    write_file(working / FOLDER / "scene.yaml", scene.to_yaml(), force=True)


def _write_run(working: Path, seconds: dict[str, float], total: float, settings: RenderSettings) -> None:
    """Write ``run.json``: times and provenance, which differ between runs."""
    run = {
        "format": "labcal-run",
        "format_version": 1,
        "seconds": total,
        "picture_seconds": seconds,
        "workers": settings.workers,
        "seed": settings.seed,
        "spp": settings.spp,
        "versions": {package: package_version(package) for package in PACKAGES},
    }
    write_file(working / PROVENANCE, provenance_text(run), force=True)
