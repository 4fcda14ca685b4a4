"""The eccentricity of projected circles: centroid minus centre, and its correction.

A detector measures the centre of area of a dot's outline in the picture. Camera models speak of the image of
the dot's centre. The difference depends on lens, pose and size of the dot, all of which a calibration knows
well enough after a first round, so it is predicted and subtracted.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.cameras.triangulation import triangulate
from labcal.correspond.matching import Matches, rows_by_name
from labcal.errors import InputError
from labcal.geometry.poses import rigid_alignment
from labcal.targets.board_set import BoardSet
from labcal.targets.target import Target

_MOST_TIMES = 1.4
"""Beyond this, no method is so wrong: the target is another one."""
ROUNDS = 2
"""Number of computations of the eccentricity: after two it changes by less than a thousandth of itself."""


@dataclass(frozen=True)
class CorrectedEccentricity:
    """RMS and maximum of the corrected eccentricity, px, as 2-D lengths."""

    rms: float
    max: float

    @classmethod
    def of(cls, eccentricity: Float64[np.ndarray, "*n 2"]) -> "CorrectedEccentricity":
        """Return the figures of an eccentricity, px; 0 for none."""
        length = np.linalg.norm(eccentricity, axis=-1).ravel()
        if len(length) == 0:
            return cls(0.0, 0.0)
        return cls(float(np.sqrt((length**2).mean())), float(length.max()))


@dataclass(frozen=True)
class DiscShapes:
    """The dots of a target as discs, wherever they are."""

    radii: Float64[np.ndarray, " dots"]
    """Of the outer outlines, mm; 0 of corners."""
    rotation: Float64[np.ndarray, "dots 3 3"] | None = None
    """From the plane of each disc to the target's frame; None where all are parallel to its x-y plane."""

    @classmethod
    def of(cls, target: Target) -> "DiscShapes":
        """Return the shapes of a target's dots; those of several boards lie in the planes of these."""
        radii = 0.5 * target.outer_diameters_mm()
        if not isinstance(target, BoardSet):
            return cls(radii)
        return cls(radii, target.poses[target.board_number, :3, :3])

    def at(self, centres: Vectors3) -> "Discs":
        """Return the discs with their centres at these places, mm."""
        return Discs(centres, self.radii, self.rotation)


@dataclass(frozen=True)
class Discs:
    """The dots of a target as discs."""

    centres: Float64[np.ndarray, "dots 3"]
    """In the target's frame, mm."""
    radii: Float64[np.ndarray, " dots"]
    """Of the outer outlines, mm."""
    rotation: Float64[np.ndarray, "dots 3 3"] | None = None
    """From the plane of each disc to the target's frame; None where all are parallel to its x-y plane."""

    @classmethod
    def of(cls, target: Target) -> "Discs":
        """Return the dots where the target's description has them."""
        return DiscShapes.of(target).at(target.points())


def dot_eccentricities(
    camera: Camera, T_world_target: Pose, discs: Discs, dots: Int64[np.ndarray, " n"]
) -> Float64[np.ndarray, "n 2"]:
    """Return the eccentricity of dots in one picture, px.

    Parameters
    ----------
    camera : Camera
    T_world_target : ndarray, shape (4, 4)
        Pose of the target, mm.
    discs : Discs
    dots : ndarray of int, shape (n,)
        Which of the discs.

    Returns
    -------
    ndarray, shape (n, 2)
        0 for a dot of which the camera cannot image all; such a dot is not measured either.
    """
    turned = None if discs.rotation is None else discs.rotation[dots]
    images = dot_images(camera, T_world_target, discs.centres[dots], discs.radii[dots], turned)
    return np.where(images.ok[:, None], images.centroid - images.centre, 0.0)


def eccentricities_at_poses(
    cameras: Sequence[Camera],
    view: np.ndarray,
    dots: Int64[np.ndarray, " n"],
    T_world_target: Mapping[str, Pose],
    discs: Discs,
) -> Float64[np.ndarray, "n cameras 2"]:
    """Return the eccentricity of dots in several views, px.

    Parameters
    ----------
    cameras : sequence of Camera
    view : ndarray of str, shape (n,)
    dots : ndarray of int, shape (n,)
        Which of the discs.
    T_world_target : mapping of str to ndarray of shape (4, 4)
        Pose of the target by view, mm.
    discs : Discs

    Returns
    -------
    ndarray, shape (n, cameras, 2)
        0 in views without a pose.
    """
    return _eccentricities(cameras, rows_by_name(view), dots, T_world_target, discs)


def _eccentricities(
    cameras: Sequence[Camera],
    rows_by_view: Mapping[str, Int64[np.ndarray, " rows"]],
    dots: Int64[np.ndarray, " n"],
    T_world_target: Mapping[str, Pose],
    discs: Discs,
) -> Float64[np.ndarray, "n cameras 2"]:
    """Return the result of :func:`eccentricities_at_poses` by the rows of each view."""
    eccentricity = np.zeros((len(dots), len(cameras), 2))
    for name, rows in rows_by_view.items():
        if name in T_world_target:
            for number, camera in enumerate(cameras):
                eccentricity[rows, number] = dot_eccentricities(
                    camera, T_world_target[name], discs, dots[rows]
                )
    return eccentricity


def eccentricities_of_matches(
    cameras: Sequence[Camera], matches: Matches, p: Float64[np.ndarray, "n 3"], target: Target
) -> Float64[np.ndarray, "n cameras 2"]:
    """Return the eccentricity of matched dots, with the target pose from its reconstructed points.

    Parameters
    ----------
    cameras : sequence of Camera
        In the order of the matches.
    matches : Matches
    p : ndarray, shape (n, 3)
        Where the dots are, more or less, in the world of the cameras, mm; NaN where not known.
    target : Target
        Of a set of boards, each board has the pose of its own points.

    Returns
    -------
    ndarray, shape (n, cameras, 2)
        Pixels; 0 in views with fewer than three points or all on one line, where the target has no pose.

    Raises
    ------
    InputError
        The points are not of such a target.
    """
    if isinstance(target, BoardSet):
        return _eccentricities_of_boards(cameras, matches, p, target)
    discs = Discs.of(target)
    dots = matches.index[:, 1] * target.cols + matches.index[:, 0]
    T_world_target: dict[str, Pose] = {}
    for view, rows in matches.rows_by_view.items():
        known = rows[np.isfinite(p[rows]).all(axis=1)]
        try:
            T_world_target[view] = rigid_alignment(p[known], discs.centres[dots[known]])
        except InputError:
            continue
        _refuse_other_size(p[known], discs.centres[dots[known]], target)
    return _eccentricities(cameras, matches.rows_by_view, dots, T_world_target, discs)


def _eccentricities_of_boards(
    cameras: Sequence[Camera], matches: Matches, p: Float64[np.ndarray, "n 3"], boards: BoardSet
) -> Float64[np.ndarray, "n cameras 2"]:
    """Return the result of :func:`eccentricities_of_matches`, board by board."""
    eccentricity = np.zeros((len(matches), len(cameras), 2))
    numbers = matches.index[:, 0]
    for board, span in zip(boards.targets, boards.spans, strict=True):
        mine = (numbers >= span.start) & (numbers < span.stop)
        on_board = replace(matches.where(mine), index=board.indices()[numbers[mine] - span.start])
        eccentricity[mine] = eccentricities_of_matches(cameras, on_board, p[mine], board)
    return eccentricity


def _refuse_other_size(
    p: Float64[np.ndarray, "n 3"], declared: Float64[np.ndarray, "n 3"], target: Target
) -> None:
    """Raise if the extent of points is far from that of the target."""
    spread = np.linalg.norm(p - p.mean(axis=0)) / np.linalg.norm(declared - declared.mean(axis=0))
    if not 1.0 / _MOST_TIMES < spread < _MOST_TIMES:
        raise InputError(
            f"The points are {spread:.3g} times as far apart as the dots of the target '{target.name}'. Name "
            "the target that the pictures show."
        )


def centred(
    cameras: Sequence[Camera], matches: Matches, target: Target
) -> tuple[Matches, CorrectedEccentricity | None]:
    """Return matches at the images of centres, and the eccentricity that was subtracted; None for corners.

    Parameters
    ----------
    cameras : sequence of Camera
        At least two, in the order of the matches.
    matches : Matches
        Centroids.
    target : Target
        What they are dots of.

    Notes
    -----
    The target's pose comes from the points that the centroids themselves give: the eccentricity moves them so
    little that one prediction is enough.
    """
    p = triangulate(cameras, matches.q, matches.covariance).point
    eccentricity = eccentricities_of_matches(cameras, matches, p, target)
    corrected = CorrectedEccentricity.of(eccentricity) if has_discs(target) else None
    return replace(matches, q=matches.q - eccentricity), corrected


def has_discs(target: Target) -> bool:
    """Tell whether any place of a target has an extent, and so an eccentricity: corners have none."""
    return bool(target.outer_diameters_mm().any())
