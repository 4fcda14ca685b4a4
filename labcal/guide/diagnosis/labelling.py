"""Pictures that bear the other camera's name, and targets that are numbered the other way round."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import Pose
from labcal.calibrate.agreement.exchange.by_poses import with_exchanged
from labcal.calibrate.agreement.exchange.decision import LEFT_OF_POSES, explains
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.lens_start import start_from_camera
from labcal.calibrate.prepared_cameras import PreparedCameras
from labcal.calibrate.rig_start import SharedViews
from labcal.calibrate.single_calibration import HandheldSettings, SingleCalibration, calibrate_single
from labcal.calibrate.view_agreement import target_residuals
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, inverse, pose
from labcal.targets.catalogue import AnyTarget

_CANDIDATES = 12
"""Views that are tried for a reference."""
_FEWEST = 3
"""Shared views: of two both would be right or wrong alike."""
_ROUNDS = 5
_LESS = 0.5
"""Share of the residual of a view as it is that another reading must leave at most."""
_READINGS = tuple(product((False, True), (False, True)))
"""Exchanged or not, and turned or not; the first one is the pictures as they are."""
_LEAST_PX = 2.0
_HALF = 0.5
"""Share of the views: of two readings that differ everywhere, the one of the larger part is right."""


@dataclass(frozen=True)
class Labelling:
    """Views of two cameras with wrong labels.

    Attributes
    ----------
    cameras : (str, str)
    exchanged, turned : tuple of str
        Views of which pictures are exchanged; of which the second camera's dots are numbered from the other
        corner, or the first one's.
    """

    cameras: tuple[str, str]
    exchanged: tuple[str, ...]
    turned: tuple[str, ...]

    def corrected(self, dots: Detections, target: AnyTarget) -> Detections:
        """Return the dots with the labels corrected."""
        found = with_exchanged(dots, self.cameras, self.exchanged) if self.exchanged else dots
        of_second = np.isin(found.view, self.turned) & (found.camera == self.cameras[1])
        last = np.array([target.cols - 1, target.rows - 1])
        index = np.where(of_second[:, None], last - found.index, found.index)
        return replace(found, index=index)


def half_turn(target: AnyTarget) -> Pose:
    """Return a half turn of the target's frame about the middle of its dots, which renumbers them."""
    middle = target.points().mean(axis=0)
    turn = from_rotation_vector(np.array([0.0, 0.0, np.pi]), np.zeros(3))
    return pose(turn[:3, :3], middle - turn[:3, :3] @ middle)


@dataclass(frozen=True)
class Pair:
    """Two cameras that are calibrated alone, and the poses of the target by each other's pictures.

    Attributes
    ----------
    first, second : SingleCalibration
    shared : SharedViews
    exchanged : SharedViews or None
        Poses by the pictures of the other camera; None where their sizes differ.
    """

    first: SingleCalibration
    second: SingleCalibration
    shared: SharedViews
    exchanged: SharedViews | None

    @classmethod
    def of(cls, first: SingleCalibration, second: SingleCalibration, target: AnyTarget) -> "Pair":
        """Return the pair of two cameras."""
        shared = SharedViews.of(first.single, second.single)
        if first.single.camera.size != second.single.camera.size or not len(shared.views):
            return cls(first, second, shared, None)
        by_other = []
        for camera, other in ((first, second), (second, first)):
            pictures = dict(zip(other.single.views.tolist(), other.dots.by_view(), strict=True))
            chosen = [pictures[view] for view in shared.views.tolist()]
            start = start_from_camera(chosen, target, camera.single.camera)
            by_other.append(start.T_cam_target)
        return cls(first, second, shared, SharedViews(shared.views, by_other[0], by_other[1]))

    def residuals(self, T_second_first: Pose, target: AnyTarget) -> Float64[np.ndarray, "4 n"]:
        """Return the residuals of each view by each reading, px; infinite where one is impossible."""
        points, turn = target.points(), half_turn(target)
        found = np.full((len(_READINGS), len(self.shared.views)), np.inf)
        for number, (exchanged, turned) in enumerate(_READINGS):
            views = self.exchanged if exchanged else self.shared
            if views is None:
                continue
            read = replace(views, second=views.second @ turn) if turned else views
            found[number] = target_residuals(self.second.single, T_second_first, read, points)
        return found

    def misfit(self, target: AnyTarget) -> Float64[np.ndarray, " n"]:
        """Return the residuals of the views as they are, by the reference that suits them best, px."""
        references = (reference for turned, reference in self.references(target) if not turned)
        points = target.points()
        found = [
            target_residuals(self.second.single, reference, self.shared, points) for reference in references
        ]
        return min(found, key=lambda one: float(one.mean()))

    def references(self, target: AnyTarget) -> Iterator[tuple[bool, Pose]]:
        """Yield ``T_second_first`` by some views, as they are and with the target turned."""
        for at in range(0, len(self.shared.views), -(-len(self.shared.views) // _CANDIDATES)):
            backward = inverse(self.shared.first[at])
            yield False, np.asarray(self.shared.second[at] @ backward)
            yield True, np.asarray(self.shared.second[at] @ half_turn(target) @ backward)


def labelling(prepared: PreparedCameras, camera: int, target: AnyTarget) -> Labelling | None:
    """Return the wrong labels of the pictures of a camera and the first; None where nothing tells of any.

    Lenses that are calibrated from exchanged pictures are a mixture of both cameras', so that labels are
    corrected and lenses are calibrated again until labels stay as they are.

    Parameters
    ----------
    prepared : PreparedCameras
        Each camera calibrated alone.
    camera : int
        Number of the second camera, from 1.
    target : AnyTarget
    """
    first, second = prepared.alone[0], prepared.alone[camera]
    dots = prepared.dots.entering
    views = np.array(dots.views)
    names = (first.name, second.name)
    if len(SharedViews.of(first.single, second.single).views) < _FEWEST:
        return None
    labels = Labelling(names, (), ())
    settings = HandheldSettings(dot_places=DotTreatment.DECLARED)
    pair = Pair.of(first, second, target)
    given = pair.misfit(target)
    if given.max() < _LEAST_PX:
        return None
    for _ in range(_ROUNDS):
        new = _better(pair, labels, views, target)
        if new == labels:
            break
        labels = new
        corrected = labels.corrected(dots, target)
        try:
            again = [calibrate_single(name, corrected, target, prepared.lens, settings) for name in names]
        except InputError:
            return None
        pair = Pair.of(again[0], again[1], target)
    left = pair.misfit(target)
    if not (labels.exchanged or labels.turned):
        return None
    bound = LEFT_OF_POSES * first.single.camera.size[0]
    mended = explains(float(given.mean()), float(left.mean()), bound, LEFT_OF_POSES)
    return labels if mended else None


def _better(pair: Pair, labels: Labelling, views: np.ndarray, target: AnyTarget) -> Labelling:
    """Return the labels by the reading of each view that fits the others best, beside those given."""
    best: tuple[float, bool, Float64[np.ndarray, "4 n"]] | None = None
    for turned, reference in pair.references(target):
        left = pair.residuals(reference, target)
        least = left.min(axis=0)
        total = float(np.median(least) + least.mean())
        if best is None or total < (0.5 if turned else 1.0) * best[0]:
            best = (total, turned, left)
    if best is None:
        return labels
    _, all_turned, left = best
    number, least = np.argmin(left, axis=0), left.min(axis=0)
    number = np.where((left[0] > _LEAST_PX) & (least < _LESS * left[0]), number, 0)
    table = np.array(_READINGS)
    exchanged, turned_views = table[number, 0], table[number, 1]
    names = views[pair.shared.views]
    exchanged ^= np.isin(names, labels.exchanged)
    turned_views ^= np.isin(names, labels.turned)
    exchanged = _smaller_part(exchanged)
    turned_views = turned_views if all_turned or labels.turned else _smaller_part(turned_views)
    return Labelling(labels.cameras, tuple(names[exchanged].tolist()), tuple(names[turned_views].tolist()))


def _smaller_part(part: Bool[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
    """Return the smaller one of two parts of the views; of equal ones the later."""
    share = part.mean()
    return ~part if share > _HALF or (share == _HALF and part[0]) else part
