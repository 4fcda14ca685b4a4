"""The chain from pictures to errors in millimetres: the work of every command as one function.

::

    render ─► SHOOT ─► detect ─► fit, or calibrate ─► reconstruct ─► evaluate

A command line parses, calls the function of its verb's name, and prints; a notebook calls the same functions.
Paths are text or :class:`os.PathLike`; where a shoot, a table, cameras or points are wanted, their path does,
too. Nothing is printed: what a person should not miss is in the `warnings` of what is returned, and
`progress` is told how far the work has come.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING

from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.points import Points
from labcal.correspond.view_roles import HoldOut, held_out_views
from labcal.errors import InputError
from labcal.estimators.model import Model
from labcal.paths import AnyPath, as_path
from labcal.run.progress import NoProgress, Progress
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.shoot.manifest import Role
from labcal.shoot.tone_curve import AnyToneCurve, ToneCurve, find_tone_curve
from labcal.targets.catalogue import AnyTarget, load_target
from labcal.targets.places import DotPlaces
from labcal.targets.target import Target

if TYPE_CHECKING:
    from labcal.bench.settings import BenchSettings
    from labcal.calibrate.calibration import Calibration
    from labcal.calibrate.epipolar_residual import epipolar_rms
    from labcal.calibrate.handheld import HandheldSettings
    from labcal.cameras.interop.conversion import Conversion, ConvertSettings
    from labcal.correspond.measure import Measurement, detections_of
    from labcal.correspond.picture_set import AnyPictures, open_pictures
    from labcal.correspond.undistortion import Undistorted, UndistortSettings
    from labcal.detect.settings import DetectSettings, detect_settings
    from labcal.estimators.fitting import FitSettings, estimators_of, fit_methods, training_of
    from labcal.evaluate.against_truth import Alignment, TruthErrors
    from labcal.evaluate.own_lengths import LengthErrors
    from labcal.paper.reproduce import ReproduceSettings
    from labcal.reconstruct.reconstruction import Reconstruction
    from labcal.render.shoot import RenderSettings
    from labcal.report.bench import BenchResult
    from labcal.report.inspection import Inspection
    from labcal.report.reproduction import Reproduction

__all__ = [
    "BenchSettings",
    "ConvertSettings",
    "DetectSettings",
    "FitSettings",
    "HandheldSettings",
    "RenderSettings",
    "ReproduceSettings",
    "UndistortSettings",
    "bench",
    "calibrate",
    "convert",
    "detect",
    "detect_settings",
    "detections_of",
    "epipolar_rms",
    "estimators_of",
    "evaluate",
    "fit",
    "fit_methods",
    "inspect",
    "measure",
    "open_pictures",
    "reconstruct",
    "render",
    "reproduce",
    "training_of",
    "undistort",
]

_HOMES = {
    "BenchSettings": "labcal.bench.settings",
    "ConvertSettings": "labcal.cameras.interop.conversion",
    "DetectSettings": "labcal.detect.settings",
    "FitSettings": "labcal.estimators.fitting",
    "HandheldSettings": "labcal.calibrate.handheld",
    "RenderSettings": "labcal.render.shoot",
    "ReproduceSettings": "labcal.paper.reproduce",
    "UndistortSettings": "labcal.correspond.undistortion",
    "detect_settings": "labcal.detect.settings",
    "detections_of": "labcal.correspond.measure",
    "epipolar_rms": "labcal.calibrate.epipolar_residual",
    "estimators_of": "labcal.estimators.fitting",
    "open_pictures": "labcal.correspond.picture_set",
    "fit_methods": "labcal.estimators.fitting",
    "training_of": "labcal.estimators.fitting",
}
"""Public names, imported when first asked for: detection needs no SciPy, a rig no scikit-learn."""


def __getattr__(name: str) -> object:
    """Return what is at home elsewhere."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted({*globals(), *_HOMES})


def render(
    scene: AnyPath,
    folder: AnyPath,
    settings: "RenderSettings | None" = None,
    overrides: Sequence[str] = (),
    progress: Progress | None = None,
) -> Shoot:
    """Render a scene into a new shoot: pictures, a manifest, and the truth in a folder apart.

    Parameters
    ----------
    scene : str or path
        The name of a scene that labcal ships, or the path of a YAML file.
    folder : path
        The folder to appear. What an interrupted run left is gone on with.
    settings : RenderSettings, optional
    overrides : sequence of str
        Values of the scene to change, as in ``"cameras.left.focal_px=800"``.
    progress : Progress, optional

    Returns
    -------
    Shoot
        The folder, opened.

    Raises
    ------
    UnknownNameError, InputError
        There is no such scene, or something in it is not allowed.
    OutputError
        The folder exists already, or may not be made.
    DeviceError
        The renderer does not work on this machine.

    Examples
    --------
    >>> from labcal import pipeline
    >>> quick = pipeline.RenderSettings(spp=16, views=2)
    >>> pipeline.render("webcam-plane", "shoot", quick, ["cameras.left.focal_px=800"])  # doctest: +SKIP
    Shoot(folder=shoot, target=paper-13x10, cameras=['left', 'right'], train=1, test=1)
    """
    from labcal.render.shoot import RenderSettings, render_shoot
    from labcal.scene.catalogue import load_scene

    loaded = load_scene(str(scene), tuple(overrides))
    return render_shoot(loaded, as_path(folder), settings or RenderSettings(), progress or NoProgress())


def measure(
    pictures: "AnyPictures",
    target: str | AnyTarget | None = None,
    settings: "DetectSettings | None" = None,
    tone_curve: str | AnyToneCurve = ToneCurve.LINEAR,
    workers: int = 1,
    progress: Progress | None = None,
) -> "list[Measurement]":
    """Find the dots in pictures, and tell of each picture what came of it.

    Parameters
    ----------
    pictures : PictureSet, Shoot, path or sequence of paths
        As for :func:`~labcal.correspond.picture_set.open_pictures`, which takes the cameras' names, too.
    target : str or AnyTarget, optional
        What the pictures show; a shoot brings its own.
    settings : DetectSettings, optional
        Thresholds, sizes and counts of the detector; the defaults where left out.
    tone_curve : str or AnyToneCurve
        The camera's, which is undone first.
    workers : int
        Processes at work; the results are the same for any number.
    progress : Progress, optional

    Returns
    -------
    list of Measurement
        In the order of the pictures; one that cannot be used is a result with a reason.

    Raises
    ------
    InputError
        There are no such pictures, or the target is not known.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot")
    >>> first, *others = pipeline.measure(shoot)
    >>> first.indexed, first.source.view, first.source.camera, first.dots.flag.count("ok")
    (True, 'hand-0', 'left', 88)
    """
    from labcal.correspond.measure import measure_pictures
    from labcal.correspond.picture_set import open_pictures
    from labcal.run.executor import open_executor

    curve = find_tone_curve(tone_curve) if isinstance(tone_curve, str) else tone_curve
    opened = open_pictures(pictures)
    shown = opened.target(target)
    with open_executor(workers) as executor:
        return measure_pictures(opened.sources, shown, executor, progress or NoProgress(), curve, settings)


def detect(
    pictures: "AnyPictures",
    target: str | AnyTarget | None = None,
    settings: "DetectSettings | None" = None,
    tone_curve: str | AnyToneCurve = ToneCurve.LINEAR,
    workers: int = 1,
    progress: Progress | None = None,
) -> Detections:
    """Find the dots in pictures, and return the table of them.

    Parameters
    ----------
    pictures, target, settings, tone_curve, workers, progress
        As of :func:`measure`, which tells of each picture by itself.

    Returns
    -------
    Detections
        The dots of all pictures that could be read; positions in px.

    Raises
    ------
    InputError
        As of :func:`measure`; or no picture could be read at all.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot")
    >>> pipeline.detect(shoot)
    Detections(views=2, cameras=['left', 'right'], dots=352, ok=352)
    >>> loose = pipeline.open_pictures("shoot/images", "_left=a,_right=b")
    >>> pipeline.detect(loose, examples.TARGET).cameras
    ('a', 'b')
    """
    from labcal.correspond.measure import detections_of

    return detections_of(measure(pictures, target, settings, tone_curve, workers, progress))


def inspect(
    pictures: "AnyPictures",
    target: str | AnyTarget | None = None,
    settings: "DetectSettings | None" = None,
    workers: int = 1,
    progress: Progress | None = None,
) -> "Inspection":
    """Return pictures at a glance: exposure, sharpness and dots of each, and a contact sheet of all.

    Parameters
    ----------
    pictures, target, settings, workers, progress
        As of :func:`measure`.

    Returns
    -------
    Inspection
        Figures of every picture and camera, and the contact sheet, which its `save` writes.

    Raises
    ------
    InputError
        There are no such pictures, the target is not known, or no picture could be read at all.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> found = pipeline.inspect(examples.shoot("shoot"))
    >>> found.pictures[0].dots, found.pictures[0].saturated_share
    (88, 0.0)
    >>> round(found.cameras["left"].coverage, 2)
    0.52
    >>> found.save("sheet.png")
    """
    from labcal.correspond.picture_set import open_pictures
    from labcal.report.inspection import inspection

    opened, progress = open_pictures(pictures), progress or NoProgress()
    shown = opened.target(target)
    measurements = measure(opened, shown, settings, workers=workers, progress=progress)
    return inspection(opened, measurements, shown, progress)


def calibrate(
    source: Shoot | AnyTarget | AnyPath,
    detections: Detections | AnyPath | None = None,
    lens: str | None = None,
    settings: "HandheldSettings | None" = None,
    hold_out: HoldOut = (),
    progress: Progress | None = None,
) -> "Calibration":
    """Calibrate cameras from a target that was held in free poses. The first camera is the rig's world.

    Parameters
    ----------
    source : Shoot, AnyTarget, path or str
        A shoot or its folder, whose test views do not enter; or the target that the dots are of, or its name.
    detections : Detections or path, optional
        Dots, or the table of them; those of the shoot are found in its pictures where left out.
    lens : str, optional
        A lens model; ``"auto"``: views held out choose it. That of the rig to start from, or
        ``brown5``, where left out.
    settings : HandheldSettings, optional
    hold_out : int, str or sequence of str
        Views that do not enter, so that the result can be scored on them: how many, or which.
    progress : Progress, optional

    Returns
    -------
    Calibration
        The rig, in mm and px, with standard deviations, residuals and warnings.

    Raises
    ------
    UnknownNameError, InputError
        As of :func:`~labcal.calibrate.calibration.calibrated`; or no dots are given of a target.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> pipeline.calibrate(examples.TARGET, examples.detections(), "brown5", hold_out=2)
    Calibration(cameras=['left', 'right'], lens=brown5, views=6, rms=0.0275 px, warnings=0)
    """
    from labcal.calibrate.calibration import calibrated

    shown = _shown(source)
    dots = _dots(detections, shown)
    if not isinstance(shown, Shoot):
        return calibrated(dots, shown, lens, settings, hold_out, progress)
    tested = {view.name for view in shown.views(Role.TEST)}
    rest = [view for view in dots.views if view not in tested]
    kept_back = [view for view in dots.views if view in tested or view in held_out_views(rest, hold_out)]
    return calibrated(dots, shown.target, lens, settings, kept_back, progress)


def fit(
    source: Shoot | AnyTarget | AnyPath,
    detections: Detections | AnyPath | None = None,
    method: object = "hybrid",
    settings: "FitSettings | None" = None,
    progress: Progress | None = None,
) -> Model:
    """Fit a method to the dots of a target; :func:`fit_methods` fits several to the same :func:`training_of`.

    Parameters
    ----------
    source : Shoot, AnyTarget, path or str
        A shoot or its folder, of which training views are used; or the target, held in the hand in all views,
        or its name.
    detections : Detections or path, optional
        Dots, or the table of them; those of the shoot are found in its pictures where left out.
    method : str, type or object
        Its name; ``package.module:Class`` of a method of one's own; or an estimator or a class, of labcal's
        or with fit and predict as those of scikit-learn. What is given stays as it was: a copy learns.
    settings : FitSettings, optional
    progress : Progress, optional

    Returns
    -------
    Model
        It takes pixels to points in mm: in the world of the stage, or in that of the first camera.

    Raises
    ------
    UnknownNameError, InputError
        There is no such method, it cannot learn from these dots, or no dots are given of a target.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> quick = pipeline.FitSettings(lens="brown5", rehearsal=False)
    >>> pipeline.fit(examples.TARGET, examples.detections(), "dlt", quick)
    Model(method=dlt, cameras=['left', 'right'], outputs=3, calibrated_on=8 views)
    """
    from labcal.estimators.fitting import FitSettings, estimators_of, fit_methods, training_of

    settings = settings or FitSettings()
    shown = _shown(source)
    estimators = estimators_of([method], settings)
    training = training_of(shown, _dots(detections, shown), settings, progress)
    (model,) = fit_methods(training, estimators, settings, progress)
    if isinstance(model, InputError):
        raise model
    return model


def reconstruct(
    model: Model | Rig | AnyPath,
    detections: Detections | AnyPath,
    target: Target | str | None = None,
) -> "Reconstruction":
    """Return the points of all dots that every camera measured.

    Parameters
    ----------
    model : Model, Rig or path
        A fitted method or cameras, or the file of them.
    detections : Detections or path
        Dots, or the table of them.
    target : Target or str, optional
        What the dots are of, so that centroids give centres.

    Returns
    -------
    Reconstruction
        Points in mm with covariances and flags, and warnings.

    Raises
    ------
    InputError
        As of :func:`~labcal.reconstruct.reconstruction.reconstruct_centres`.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> found = pipeline.reconstruct(examples.rig(), examples.detections(), examples.TARGET)
    >>> found.points
    Points(views=8, points=704, ok=704, median_sigma=0.076 mm)
    >>> found.warnings
    ()
    """
    from labcal.reconstruct.reconstruction import load_reconstructor, reconstruct_centres
    from labcal.reconstruct.reconstruction_warnings import reconstruction_warnings

    used = model if isinstance(model, Model | Rig) else load_reconstructor(as_path(model))
    shown = load_target(target) if isinstance(target, str) else target
    dots = _dots(detections, None)
    found = reconstruct_centres(used, dots, shown)
    known = None if shown is None else shown.name
    return replace(found, warnings=reconstruction_warnings(used, dots, found, known))


def evaluate(
    points: Points | AnyPath,
    source: Shoot | AnyTarget | DotPlaces | AnyPath,
    detections: Detections | AnyPath | None = None,
    alignment: "Alignment | None" = None,
    rig: Rig | Model | Collection[str] | AnyPath | None = None,
) -> "TruthErrors | LengthErrors":
    """Return the errors of points in mm, against the truth where a shoot has one, else against lengths.

    Parameters
    ----------
    points : Points or path
    source : Shoot, AnyTarget, DotPlaces, path or str
        The shoot that the points are of, or its folder; or, to compare with the target's own lengths, the
        target or its name, or the places of its dots (``RIG-dots.json``).
    detections : Detections or path, optional
        What the points came from; gives the limit of triangulation.
    alignment : {"none", "rigid"}, optional
        How the points are brought onto the truth; rigid for a target in the hand, else none.
    rig : Rig, Model, path or collection of str, optional
        What the points were reconstructed with, or the views that it was calibrated from: these are not
        scored, or are said to be.

    Returns
    -------
    TruthErrors or LengthErrors
        Errors in mm: of points where the shoot has a truth, else of lengths.

    Raises
    ------
    InputError
        The points are not of that target or shoot, or something is given that needs a truth.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> pipeline.evaluate(examples.points(), examples.TARGET)
    LengthErrors(n=30624, rms=0.0431 mm, max=0.332 mm, scale=-2.8 ppm)
    """
    from labcal.cameras.rig import Rig
    from labcal.correspond.points import read_points
    from labcal.evaluate.against_truth import errors_against_truth
    from labcal.evaluate.own_lengths import errors_of_lengths
    from labcal.evaluate.scored_views import ScoredViews
    from labcal.reconstruct.reconstruction import calibration_views
    from labcal.shoot.truth import has_truth

    shown = source if isinstance(source, DotPlaces) else _shown(source)
    if not (isinstance(shown, Shoot) and has_truth(shown.folder)):
        for name, given in (("detections", detections), ("alignment", alignment)):
            if given is not None:
                raise InputError(
                    f"`{name}` goes with the truth of a rendered shoot, which is not given here. "
                    "Leave it out."
                )
    found = points if isinstance(points, Points) else read_points(as_path(points))
    learned: Collection[str] | None
    if isinstance(rig, Rig | Model):
        learned = rig.calibrated_on or None
    elif rig is None or (isinstance(rig, Collection) and not isinstance(rig, str)):
        learned = rig
    else:
        learned = calibration_views(as_path(rig)) or None
    if not isinstance(shown, Shoot):
        return errors_of_lengths(found, shown, learned)
    if has_truth(shown.folder):
        dots = None if detections is None else _dots(detections, None)
        return errors_against_truth(found, shown, dots, alignment, learned)
    if learned is None:
        found = found.where(ScoredViews.by_role(found.view, shown).holds(found.view))
    return errors_of_lengths(found, shown.target, learned)


def convert(
    inputs: AnyPath | Sequence[AnyPath],
    output: AnyPath,
    settings: "ConvertSettings | None" = None,
    *,
    force: bool = False,
) -> "Conversion":
    """Convert cameras, or detections, from and to the files of other systems.

    Parameters
    ----------
    inputs : path or sequence of paths
        A file, one a camera, or a folder.
    output : path
        File to write; of COLMAP, a folder. Its ending tells cameras from detections (``.csv``, ``.vnl``).
    settings : ConvertSettings, optional
    force : bool
        Replace what labcal wrote there.

    Returns
    -------
    Conversion
        The files that were written, the unit that was read, and notes.

    Raises
    ------
    InputError
        The files cannot be read, or what is in them cannot be held by the other format.
    OutputError
        The output may not be written.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> examples.rig().save("rig.json")
    >>> done = pipeline.convert("rig.json", "cameras.yaml", pipeline.ConvertSettings(to_format="opencv"))
    >>> done.files, done.cameras
    (['cameras.yaml'], ['left', 'right'])
    >>> round(pipeline.convert("cameras.yaml", "again.json").baseline_mm, 3)
    200.0
    """
    from labcal.cameras.interop.conversion import ConvertSettings, convert_cameras
    from labcal.correspond.interop.conversion import convert_detections, is_of_detections
    from labcal.correspond.paths_read import paths_read

    given = [inputs] if isinstance(inputs, str) or not isinstance(inputs, Sequence) else inputs
    paths, place, settings = [as_path(one) for one in given], as_path(output), settings or ConvertSettings()
    converted = convert_detections if is_of_detections([*paths, place]) else convert_cameras
    return converted(paths, place, settings, paths_read([*paths, settings.target]), force=force)


def undistort(
    model: Rig | AnyPath,
    pictures: "AnyPictures",
    folder: AnyPath,
    settings: "UndistortSettings | None" = None,
    progress: Progress | None = None,
) -> "Undistorted":
    """Make pictures as pinhole cameras in the same places would have taken them, with maps and cameras.

    Parameters
    ----------
    model : Rig or path
        The cameras.
    pictures : PictureSet, Shoot, path or sequence of paths
        As for :func:`~labcal.correspond.picture_set.open_pictures`.
    folder : path
        The folder to appear.
    settings : UndistortSettings, optional
    progress : Progress, optional

    Returns
    -------
    Undistorted
        The pictures that were written, and those that could not be used.

    Raises
    ------
    InputError, OutputError
        As of :func:`~labcal.correspond.undistortion.undistort_pictures`.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot")
    >>> done = pipeline.undistort(examples.rig(), shoot, "new", pipeline.UndistortSettings(rectify=True))
    >>> done.images[:2]
    ['images/hand-0_left.png', 'images/hand-0_right.png']
    """
    from labcal.cameras.rig import read_rig
    from labcal.correspond.paths_read import paths_read
    from labcal.correspond.picture_set import open_pictures
    from labcal.correspond.undistortion import UndistortSettings, undistort_pictures

    rig = model if isinstance(model, Rig) else read_rig(as_path(model))
    opened = open_pictures(pictures)
    given = [None if isinstance(model, Rig) else model, *opened.given]
    read, place = paths_read(given, opened.sources), as_path(folder)
    return undistort_pictures(
        rig, opened, place, settings or UndistortSettings(), read, progress or NoProgress()
    )


def reproduce(
    folder: AnyPath, settings: "ReproduceSettings | None" = None, progress: Progress | None = None
) -> "Reproduction":
    """Reproduce the experiments of the paper, all 22 rows or some, and write the results and a page.

    Parameters
    ----------
    folder : path
        The folder to appear. What an interrupted run left is gone on with.
    settings : ReproduceSettings, optional
    progress : Progress, optional

    Returns
    -------
    Reproduction
        The rows with their verdicts; errors in mm, and in m where the paper prints them.

    Raises
    ------
    OutputError, DeviceError
        As of :func:`labcal.paper.reproduce.reproduce`.

    Examples
    --------
    >>> from labcal import pipeline
    >>> found = pipeline.reproduce("out", pipeline.ReproduceSettings(quick=True))  # doctest: +SKIP
    >>> len(found.rows)  # doctest: +SKIP
    22
    """
    from labcal.paper.reproduce import ReproduceSettings, reproduce
    from labcal.run.claims import FolderOutput, claim_outputs

    place, settings = as_path(folder), settings or ReproduceSettings()
    claim_outputs([FolderOutput(place)], (), force=settings.force)
    return reproduce(place, settings, progress or NoProgress())


def bench(
    what: str,
    folder: AnyPath,
    settings: "BenchSettings | None" = None,
    progress: Progress | None = None,
) -> "BenchResult":
    """Measure how good labcal is, every figure against its limit, and write the results.

    Parameters
    ----------
    what : {"render", "detect", "solve"}
    folder : path
        The folder to appear.
    settings : BenchSettings, optional
    progress : Progress, optional

    Returns
    -------
    BenchResult
        Every figure as a check, with its limit.

    Raises
    ------
    UnknownNameError, InputError
        There is no such benchmark, or a setting does not apply to it.
    OutputError
        The folder may not be made.

    Examples
    --------
    >>> from labcal import pipeline
    >>> found = pipeline.bench("detect", "out", pipeline.BenchSettings(quick=True))  # doctest: +SKIP
    >>> [check.name for check in found.checks if not check.ok]  # doctest: +SKIP
    []
    """
    from labcal.bench.benchmarks import run_benchmark
    from labcal.bench.settings import BenchSettings

    return run_benchmark(what, as_path(folder), settings or BenchSettings(), progress or NoProgress())


def _shown(source: Shoot | AnyTarget | AnyPath) -> Shoot | AnyTarget:
    """Return what dots are of: a shoot, by its folder, too, or a target, by its name, too."""
    if isinstance(source, Shoot | Target):
        return source
    return open_shoot(as_path(source)) if is_shoot(as_path(source)) else load_target(str(source))


def _dots(detections: Detections | AnyPath | None, shown: Shoot | AnyTarget | None) -> Detections:
    """Return dots that are given, by the table's path, too, or those of a shoot."""
    if isinstance(detections, Detections):
        return detections
    if detections is not None:
        from labcal.correspond.detections import read_detections

        return read_detections(as_path(detections))
    if isinstance(shown, Shoot):
        return detect(shown)
    raise InputError("No dots are given. Give `detections`, or a shoot, in whose pictures they are found.")
