"""Plain dots of several cameras: matched by their rays, and by the order of those that are certain."""

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool

from labcal.arrays import Mask
from labcal.calibrate.triangulation_check import scatter_of
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.correspond.mark_measurement import MarkPixels
from labcal.correspond.named_pixels import NamedPixels
from labcal.reconstruct.dot_order import resolved_by_order
from labcal.reconstruct.pair_candidates import Candidates, Pair, pair_candidates, parameter_columns
from labcal.reconstruct.same_disc import same_discs

_PREFIX = "dot"


@dataclass(frozen=True)
class MatchedDots:
    """Marks whose plain dots have names that cameras agree on.

    Attributes
    ----------
    marks : MarkPixels
        Dots that two cameras or more show are ``dot-NUMBER``, the others ``dot-CAMERA-NUMBER``.
    ambiguous : ndarray of bool, shape (n,)
        Mask of the dots that could be several of another camera.
    other_mm : float or None
        Median diameter of candidates that are left out since they have not the stated one; None if there are
        none.
    """

    marks: MarkPixels
    ambiguous: Bool[np.ndarray, " n"]
    other_mm: float | None


def matched_dots(rig: Rig, marks: MarkPixels) -> MatchedDots:
    """Match plain dots between the cameras of a rig, view by view; other marks keep their names.

    A dot is matched where its ray meets that of one dot only, within the noise of pixels and the
    calibration's budget, and the other way round. Where several do, those are left out whose tilt or size
    no flat round dot explains, and then those that contradict the order of dots around that are certain. What
    is not certain then is no match.

    Parameters
    ----------
    rig : Rig
    marks : MarkPixels
        Outlines and stated diameters of dots count, too.

    Notes
    -----
    Views know nothing of each other: ``dot-7`` of one view and of another are different dots.
    """
    names = marks.pixels.point.astype(object)
    ambiguous = np.zeros(len(names), dtype=bool)
    cameras = [rig.camera(name) for name in rig.cameras]
    place = {name: number for number, name in enumerate(rig.cameras)}
    camera = np.array([place.get(name, -1) for name in marks.pixels.camera.tolist()], dtype=np.int64)
    other: list[float] = []
    for view in range(len(marks.pixels.views)):
        lines = np.flatnonzero(marks.is_plain & (marks.pixels.view_number == view) & (camera >= 0))
        group, doubtful = _groups(_Scene(rig, cameras, marks, camera, lines, other))
        ambiguous[lines] = doubtful
        sizes = Counter(group.tolist())
        joint: dict[int, int] = {}
        apart: Counter[int] = Counter()
        for line, own in zip(lines.tolist(), group.tolist(), strict=True):
            if sizes[own] > 1:
                names[line] = f"{_PREFIX}-{joint.setdefault(own, len(joint))}"
            else:
                name = marks.pixels.camera[line]
                names[line] = f"{_PREFIX}-{name}-{apart[camera[line]]}"
                apart[camera[line]] += 1
    pixels = marks.pixels
    named = NamedPixels(pixels.view, pixels.camera, names.astype(np.str_), pixels.position, pixels.covariance)
    other_mm = float(np.median(other)) if other else None
    return MatchedDots(replace(marks, pixels=named), ambiguous, other_mm)


@dataclass(frozen=True)
class _Scene:
    """The plain dots of one view."""

    rig: Rig
    cameras: list[Camera]
    marks: MarkPixels
    camera: np.ndarray
    lines: np.ndarray
    other_mm: list[float]
    """Diameters of candidates that are left out for their size; filled in."""

    def pair(self, first: int, second: int) -> Pair:
        """Return two cameras, with what is known of their errors."""
        parameters = None
        if self.rig.covariance is not None:
            columns = np.array(parameter_columns(self.cameras, first, second))
            known = columns >= 0
            parameters = self.rig.covariance.matrix[np.ix_(columns, columns)] * np.outer(known, known)
        scatter = scatter_of(self.rig.calibration)
        return Pair((self.cameras[first], self.cameras[second]), parameters, scatter)


def _groups(scene: _Scene) -> tuple[np.ndarray, Mask]:
    """Return the group of every dot of a view, and which dots are ambiguous."""
    group = np.arange(len(scene.lines))
    doubtful = np.zeros(len(scene.lines), dtype=bool)
    camera = scene.camera[scene.lines]
    for first in range(len(scene.cameras)):
        for second in range(first + 1, len(scene.cameras)):
            of = np.flatnonzero(camera == first), np.flatnonzero(camera == second)
            if not (len(of[0]) and len(of[1])):
                continue
            certain, open_ = _matched_pair(scene, scene.pair(first, second), of)
            for i, j in zip(of[0][certain.first].tolist(), of[1][certain.second].tolist(), strict=True):
                group[group == group[j]] = group[i]
            doubtful[of[0][open_.first]] = True
            doubtful[of[1][open_.second]] = True
    taken = Counter(zip(group.tolist(), camera.tolist(), strict=True))
    clashing = {own for (own, _), count in taken.items() if count > 1}
    clash = np.isin(group, list(clashing))
    sizes = np.array([(group == own).sum() for own in group.tolist()])
    group = np.where(clash, len(group) + np.arange(len(group)), group)
    return group, clash | (doubtful & (sizes < 2))  # noqa: PLR2004 -- matched by another pair of cameras


def _matched_pair(
    scene: _Scene, pair: Pair, of: tuple[np.ndarray, np.ndarray]
) -> tuple[Candidates, Candidates]:
    """Return the matches of two cameras that are certain, and the candidates that are not."""
    lines = scene.lines[of[0]], scene.lines[of[1]]
    pixels = scene.marks.pixels
    q = pixels.position[lines[0]], pixels.position[lines[1]]
    found = pair_candidates(pair, q, (pixels.covariance[lines[0]], pixels.covariance[lines[1]]))
    if not len(found.first):
        return found, found
    at = np.stack([lines[0][found.first], lines[1][found.second]], axis=1)
    likely, other_size, diameter = same_discs(pair.cameras, found.point, scene.marks, at)
    scene.other_mm.extend(diameter[other_size].tolist())
    return resolved_by_order(pair.cameras, q, found.where(likely))
