"""The making of a twin: poses, a first look, every picture rendered again, and what that explains."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.sources import Source
from labcal.errors import InputError, UnknownNameError
from labcal.guide.twin.again import TwinJob
from labcal.guide.twin.causes import explained
from labcal.guide.twin.first_look import FirstLook, first_look, joint_growth
from labcal.guide.twin.known_print import KnownPrint
from labcal.guide.twin.picture import DIFFERENCE, RENDERING, SHOOT, TwinPicture, twin_picture
from labcal.guide.twin.posed import PosedViews, posed_views
from labcal.guide.twin.residuals import dot_residuals, predicted_residuals
from labcal.guide.twin.settings import TwinSettings
from labcal.guide.twin.twin import DeclaredPrint, Twin
from labcal.guide.twin.unexplained import unexplained
from labcal.guide.twin.unexplained_positions import unexplained_positions
from labcal.guide.twin.verdicts import picture_verdicts
from labcal.run.executor import finished, open_executor
from labcal.run.progress import Progress
from labcal.shoot.tone_curve import ToneCurve
from labcal.targets.board_set import BoardSet
from labcal.targets.catalogue import AnyTarget
from labcal.targets.grid import DotGrid
from labcal.targets.one_kind import single_board
from labcal.targets.places import DotPlaces
from labcal.wording import counted, listed

_INTRINSICS, _POSE = 4, 6
_LOOKS = 2


@dataclass(frozen=True)
class Photographs:
    """The pictures that are rendered again.

    Attributes
    ----------
    sources : tuple of Source
    detections : Detections
        Their dots.
    rays : int or None
        Rays a pixel, where they are renderings that say so.
    lamp_variance : mapping of str to float
        By view, the variance of the light of such a ray by the choice of lamps; 0 where nothing is said.
    has_mosaic : bool
        True where they are renderings that say that a Bayer mosaic was before the sensor.
    """

    sources: tuple[Source, ...]
    detections: Detections
    rays: int | None = None
    lamp_variance: Mapping[str, float] = field(default_factory=dict)
    has_mosaic: bool = False


def known_print(given: AnyTarget | DotPlaces) -> KnownPrint:
    """Return the print of a target, as declared or as it was measured.

    Raises
    ------
    InputError
        It is not one of dots.
    """
    target = given.target if isinstance(given, DotPlaces) else given
    if isinstance(target, BoardSet):
        single_board(target, "A twin takes", "It should be one of dots.")
    if not isinstance(target, DotGrid):
        raise InputError(
            f"A twin renders targets of dots, but '{target.name}' is of another kind. Give a shoot of one "
            "that 'labcal target list' shows with dots."
        )
    return KnownPrint(target, given.points())


def chosen_views(names: Sequence[str], views: int | tuple[str, ...] | None) -> tuple[str, ...]:
    """Return the views that are rendered: all, some by name, or so many, spread evenly.

    Raises
    ------
    UnknownNameError
        There is no view of a name.
    """
    if views is None:
        return tuple(names)
    if isinstance(views, int):
        at = np.unique(np.linspace(0, len(names) - 1, min(views, len(names))).round().astype(int))
        return tuple(names[i] for i in at)
    for name in views:
        if name not in names:
            raise UnknownNameError("view in the shoot", name, names)
    return tuple(name for name in names if name in views)


def made_twin(
    rig: Rig,
    photographs: Photographs,
    known: KnownPrint,
    how: TwinSettings,
    place: tuple[Path | None, Progress],
) -> Twin:
    """Render the pictures of a shoot again, and compare.

    Parameters
    ----------
    rig : Rig
    photographs : Photographs
    known : KnownPrint
    how : TwinSettings
    place : (Path or None, Progress)
        Folder where pictures are written, and the receiver of the state of the work.

    Raises
    ------
    InputError
        As of :func:`~labcal.guide.twin.posed.posed_views`, or no picture can be compared.
    OutputError, DeviceError
        As of writing and rendering.
    """
    folder, progress = place
    detections = photographs.detections
    if folder is not None:
        for inside in (SHOOT, f"{SHOOT}/images", "pictures", RENDERING, DIFFERENCE):
            (folder / inside).mkdir(exist_ok=True)
    posed = posed_views(rig, detections, known.target, known.dots)
    jobs = _jobs(photographs, posed, known, how, folder)
    with open_executor(how.workers) as pool:
        looks: dict[str, FirstLook] = {}
        grown, growth_mm, first = known, 0.0, _first_of_cameras(jobs)
        progress.start("first look", _LOOKS * len(first))
        for _ in range(_LOOKS):
            again = [(_printed(job, grown),) for job in first]
            for _, future in finished(pool, first_look, again):
                look = future.result()
                looks[look.camera] = look
                progress.advance()
            step = joint_growth(list(looks.values()))
            growth_mm, grown = growth_mm + step, grown.grown(step)
        jobs = [_printed(job, grown, looks[job.source.camera].curve) for job in jobs]
        progress.start("rendering again", len(jobs))
        made: list[TwinPicture | None] = [None] * len(jobs)
        refused: list[str] = []
        for number, picture in finished(pool, twin_picture, [(job,) for job in jobs]):
            try:
                made[number] = picture.result()
            except InputError as error:
                refused.append(str(error))
            progress.advance()
    pictures = tuple(one for one in made if one is not None)
    if not pictures:
        raise InputError(f"No picture can be compared with its rendering. {refused[0]}")
    found = dot_residuals(posed, pictures)
    if len(found) == 0:
        raise InputError("The detector finds no dots in the renderings, so that none can be compared.")
    absorbed = _absorbed(rig, posed, known)
    explanation = explained(found, known.dots, absorbed)
    freedom = max(0.2, 1.0 - (absorbed + _POSE * len(posed.names)) / (2.0 * len(found)))
    verdicts = picture_verdicts(pictures, found, freedom)
    declared = None
    if known.is_measured:
        places = known.target.points()
        plain = predicted_residuals(posed_views(rig, detections, known.target, places), found.scale)
        declared = DeclaredPrint(plain.rms_px, unexplained_positions(explained(plain, places), plain))
    return Twin(
        rig, grown, 1e3 * growth_mm, posed, pictures, found, explanation, verdicts,
        unexplained(pictures, verdicts, explanation, found), declared, tuple(_warnings(posed, refused)),
    )  # fmt: skip


def _jobs(
    photographs: Photographs,
    posed: PosedViews,
    known: KnownPrint,
    how: TwinSettings,
    folder: Path | None,
) -> list[TwinJob]:
    """Return a job for each picture with dots."""
    by_key = {(source.view, source.camera): source for source in photographs.sources}
    jobs = []
    for picture in sorted(posed.observations.pictures, key=lambda one: (one.view, one.camera)):
        view, camera = posed.names[picture.view], posed.cameras[picture.camera]
        if (view, camera) in by_key:
            jobs.append(TwinJob(
                source=by_key[view, camera], known=known, camera=posed.state.cameras[picture.camera],
                T_world_target=posed.state.T_world_target[picture.view],
                dots=posed.observations.dot[picture.rows], curve=ToneCurve.LINEAR,
                spp=how.spp, draws=how.draws, seed=how.seed, rays=photographs.rays,
                lamp_variance=photographs.lamp_variance.get(view, 0.0), has_mosaic=photographs.has_mosaic,
                folder=folder, name=f"{view}_{camera}.png",
            ))  # fmt: skip
    if not jobs:
        raise InputError("None of the pictures is one of which dots are given. Give the shoot of these dots.")
    return jobs


def _printed(job: TwinJob, known: KnownPrint, curve: ToneCurve | None = None) -> TwinJob:
    return replace(job, known=known, curve=job.curve if curve is None else curve)


def _first_of_cameras(jobs: Sequence[TwinJob]) -> list[TwinJob]:
    """Return the picture of each camera with most dots."""
    best: dict[str, TwinJob] = {}
    for job in jobs:
        if job.source.camera not in best or len(job.dots) > len(best[job.source.camera].dots):
            best[job.source.camera] = job
    return list(best.values())


def _absorbed(rig: Rig, posed: PosedViews, known: KnownPrint) -> float:
    """Return the degrees of freedom that went into the calibration from these same views."""
    shared = set(posed.names) & set(rig.calibrated_on)
    if not shared:
        return 0.0
    cameras = posed.state.cameras
    own = sum(_INTRINSICS + camera.model.coefficients for camera in cameras) + _POSE * (len(cameras) - 1)
    dots = 3 * len(known.dots) if known.is_measured else 0
    return (own + dots) * len(shared) / max(1, len(rig.calibrated_on))


def _warnings(posed: PosedViews, refused: Sequence[str]) -> list[str]:
    words = list(posed.skipped) + list(refused)
    if posed.outliers:
        some = listed(posed.outliers[:3])
        words.append(
            f"{counted(len(posed.outliers), 'dot')} left out, far off by "
            f"{'itself' if len(posed.outliers) == 1 else 'themselves'}: {some}"
            f"{' and others' if len(posed.outliers) > 3 else ''}"  # noqa: PLR2004 -- shown
        )
    return words
