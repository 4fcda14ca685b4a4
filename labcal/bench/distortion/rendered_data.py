"""Training and test data of a rendered case: dots that are detected in pictures of a board."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from jaxtyping import Float64

from labcal.bench.distortion.case import NO_FAULT, Case, Measured, Pictures
from labcal.bench.distortion.cell_data import CellData, RegionPoints, beyond_pinhole
from labcal.bench.distortion.rendered_scene import rendered_scene
from labcal.bench.distortion.seeing_pixels import seeing_margin
from labcal.bench.families.registry import family_by_name
from labcal.bench.faults.faulty_scene import faulty_scene
from labcal.bench.faults.registry import fault_named
from labcal.calibrate.eccentricity import centred
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.correspond.dot_source import dots_of_shoot
from labcal.correspond.matching import Matches, match, stage_points
from labcal.correspond.training import training_data
from labcal.errors import InputError
from labcal.estimators.centred_training import centred_training
from labcal.geometry.hull import inside_hull
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.run.progress import NoProgress
from labcal.scene.model import Scene
from labcal.scene.placement import Planes
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role
from labcal.shoot.truth import TrueDots, read_true_dots

_TOLERANCE_MM = 1e-3


def rendered_data(case: Case, pictures: Pictures) -> CellData:
    """Render the pictures of a case, detect their dots, and return these with the places of the stage.

    Methods get what `labcal fit` and `labcal reconstruct` give them: pixels of dots' centres, from which the
    eccentricity is subtracted with cameras that are resected from the training dots, and the covariances of
    the detector. The oracle gets the same detected pixels, and subtracts the eccentricity with the true
    cameras. Pictures are removed afterwards. Where they lack a margin, pixels are counted from the corner of
    the whole picture all the same.

    A fault is one of the pictures to train on; those to measure on are the same with it and without.

    Raises
    ------
    UnknownNameError
        There is no such family.
    InputError
        The laboratory cannot render the cameras, or too few dots were detected.
    DeviceError
        There is no LLVM library for the renderer.
    """
    scene = rendered_scene(case.cell, pictures, case.seed)
    usual = _pictured(scene, case.seed)
    trained = usual
    if case.cell.fault != NO_FAULT:
        trained = _pictured(faulty_scene(_to_train_on(scene), fault_named(case.cell.fault)), case.seed)
    data = _data(case, trained, usual, tuple(scene.true_cameras().values()))
    margin = seeing_margin(family_by_name(case.cell.family).pair(case.cell.strength, case.seed))
    return from_whole_corner(data, margin)


@dataclass(frozen=True)
class _Pictured:
    """Pictures that were rendered and removed: what the shoot states of them, their dots, and the truth."""

    shoot: Shoot
    found: Detections
    true_dots: Sequence[TrueDots]

    @property
    def seen(self) -> Matches:
        """The dots that both cameras see."""
        return match(self.found, self.shoot.cameras)


def _pictured(scene: Scene, seed: int) -> _Pictured:
    with TemporaryDirectory(prefix="labcal-distortion-") as home:
        shoot = render_shoot(scene, Path(home, "shoot"), RenderSettings(seed=seed), NoProgress())
        return _Pictured(shoot, dots_of_shoot(shoot, 1, NoProgress()), read_true_dots(shoot.folder))


def _to_train_on(scene: Scene) -> Scene:
    """Return the scene without its test views."""
    if not isinstance(scene.placement, Planes):
        raise TypeError(scene.name)
    placement = scene.placement.model_copy(update={"test_shifts_pitches": ()})
    return scene.model_copy(update={"placement": placement})


def _data(case: Case, to_train: _Pictured, to_test: _Pictured, pair: tuple[Camera, ...]) -> CellData:
    shoot = to_test.shoot
    poses, target = shoot.nominal_poses(), shoot.target
    trained = training_data(to_train.shoot, to_train.found)
    training = centred_training(trained, target, to_train.shoot.nominal_poses())
    seen = to_test.seen
    tested = seen.where(np.isin(seen.view, [view.name for view in shoot.views(Role.TEST)]))
    p = stage_points(tested, target, poses)
    usual = training_data(shoot, to_test.found)
    inside = inside_hull(p, usual.Y, _TOLERANCE_MM)
    if not inside.any():
        raise InputError(f"No dot of a test view of '{case.key}' was measured by both cameras.")
    centres = tested if training.cameras is None else centred(training.cameras, tested, target)[0]
    for_oracle, _ = centred(pair, tested, target)
    oracle = triangulate(pair, for_oracle.q, for_oracle.covariance).point
    points = RegionPoints(p[inside], centres.q[inside], oracle[inside], covariance=centres.covariance[inside])
    exact = np.stack([camera.project(trained.Y).q for camera in pair], axis=1)
    return CellData(
        training.data.X,
        trained.Y,
        {Measured.WITHIN: points},
        beyond_pinhole(trained.Y, exact),
        pixel_error_px=pixel_error(to_train.seen, to_train.true_dots),
    )


def from_whole_corner(data: CellData, margin: Float64[np.ndarray, " 2"]) -> CellData:
    """Return data with pixels counted from the corner of a picture with its margin."""
    tests = {region: replace(points, q=points.q + margin) for region, points in data.tests.items()}
    return replace(data, X=data.X + np.tile(margin, data.X.shape[1] // 2), tests=tests)


def pixel_error(seen: Matches, true_dots: Sequence[TrueDots]) -> float:
    """Return the RMS of each coordinate of detected minus true centroids, px."""
    truth = {
        (picture.view, picture.camera, *index): q
        for picture in true_dots
        for index, q in zip(picture.index.tolist(), picture.centroid, strict=True)
    }
    lines = zip(seen.view.tolist(), seen.index.tolist(), strict=True)
    exact = np.array([[truth[view, name, *index] for name in seen.cameras] for view, index in lines])
    return float(np.sqrt(((seen.q - exact) ** 2).mean()))
