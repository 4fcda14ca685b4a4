"""Good shoots of a simulated pair of cameras: a target held in the hand, in every picture."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.stats.qmc import Halton

from labcal.arrays import Pose, Vectors3
from labcal.bench.solve.budget_rigs import KINDS, PairKind
from labcal.bench.solve.pair_dots import CAMERAS
from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose, transform
from labcal.targets.grid import DotGrid

TARGETS = ("rings", "plain")
TILT_RAD = 0.35
"""Standard deviation of the target's rotation about each axis in a good shoot."""
PAIRS: Mapping[str, PairKind] = {
    "wide": replace(KINDS["wide"], board_mm=600.0),
    "narrow": replace(KINDS["narrow"], board_mm=210.0),
    "webcam": replace(KINDS["webcam"], board_mm=330.0),
}
"""Pairs with boards that fill a good part of the picture, as one takes them to calibrate all of it."""
_NEAR, _FAR = 0.85, 1.2
"""Distances of the target in a good shoot, in units of the rig's."""
_SEEN = {"rings": 0.75, "plain": 1.0}
"""Share of the dots that both cameras see: a plain grid must be seen whole to be numbered."""
_INNER = 0.8
"""Share of the width and height of the pictures in which points are measured."""
_TRIED = 20000


@dataclass(frozen=True)
class Hand:
    """The way in which a hand moves the target, in units of that of a good shoot.

    Attributes
    ----------
    tilt : float
        Of the standard deviation of rotations.
    reach : float
        Of the range of places across.
    depth : float
        Of the range of distances.
    """

    tilt: float = 1.0
    reach: float = 1.0
    depth: float = 1.0


@dataclass(frozen=True)
class Picture:
    """One picture: its names, the camera as it was at that moment, and the target's place.

    Attributes
    ----------
    view, camera : str
    device : Camera
    T_world_target : ndarray, shape (4, 4)
        Mm.
    drift_mm : ndarray, shape (3,)
        By which the target moves while the rows of the picture are read, first to last; 0 with a global
        shutter.
    """

    view: str
    camera: str
    device: Camera
    T_world_target: Pose
    drift_mm: Vectors3


@dataclass(frozen=True)
class HeldShoot:
    """Pictures of a target that is printed in one way and described in another, or in the same.

    Attributes
    ----------
    kind : str
        Of the pair of cameras.
    described : DotGrid
        The target that the user names.
    printed : DotGrid
        The target in the pictures.
    dots : float64 array, (n, 3)
        Places of the dots of `printed`, mm.
    pictures : tuple of Picture
        View by view.
    noise_px : float
        Standard deviation of dots of usual size.
    """

    kind: str
    described: DotGrid
    printed: DotGrid
    dots: Vectors3
    pictures: tuple[Picture, ...]
    noise_px: float

    @property
    def views(self) -> tuple[str, ...]:
        """Names of the views, in order."""
        return tuple(dict.fromkeys(picture.view for picture in self.pictures))

    @property
    def pair(self) -> PairKind:
        """The pair of cameras as they were first."""
        return PAIRS[self.kind]


def good_shoot(
    kind: str,
    layout: str,
    views: int,
    random: np.random.Generator,
    hand: Hand | None = None,
    pair: PairKind | None = None,
) -> HeldShoot:
    """Return a shoot of a pair.

    Parameters
    ----------
    kind : str
        One of :data:`PAIRS`.
    layout : str
        One of :data:`TARGETS`.
    views : int
    random : numpy.random.Generator
    hand : Hand, optional
        As in a good shoot where not given.
    pair : PairKind, optional
        With another board.
    """
    pair = pair or PAIRS[kind]
    target = pair.target()
    if layout != TARGETS[0]:
        target = target.model_copy(
            update={"rings": None, "ring_outer_diameter_mm": None, "ring_inner_diameter_mm": None}
        )
    still = np.zeros(3)
    pictures = [
        Picture(f"view-{number:02d}", name, device, T, still)
        for number, T in enumerate(held_poses(pair, _SEEN[layout], (views, hand or Hand()), random))
        for name, device in zip(CAMERAS, pair.cameras(), strict=True)
    ]
    noise_px = float(random.uniform(0.02, 0.06))
    return HeldShoot(kind, target, target, target.points(), tuple(pictures), noise_px)


def held_poses(
    pair: PairKind, seen: float, wanted: tuple[int, Hand], random: np.random.Generator
) -> list[Pose]:
    """Return ``T_world_target`` of views, mm.

    The middle of the target goes over the first picture evenly, as a person does who fills it.

    Parameters
    ----------
    pair : PairKind
    seen : float
        Share of the dots that both cameras see in each view.
    wanted : (int, Hand)
        Number of views, and the way in which they are taken.
    random : numpy.random.Generator

    Raises
    ------
    RuntimeError
        No place shows so much of the target.
    """
    views, hand = wanted
    p, found = pair.target().points(), list[Pose]()
    first, second = pair.cameras()
    middle = first.project(np.array([[0.0, 0.0, pair.distance_mm]])).q[0]
    places = Halton(2, rng=random).random(_TRIED)
    for place in places:
        q = middle + hand.reach * (place * first.size - middle)
        depth = 1.0 + hand.depth * (random.uniform(_NEAR, _FAR) - 1.0)
        ray = first.rays(q[None]).direction[0]
        tilt = Rotation.from_rotvec(hand.tilt * TILT_RAD * random.standard_normal(3)).as_matrix()
        R = np.diag([1.0, -1.0, -1.0]) @ tilt
        T = pose(R, depth * pair.distance_mm * ray / ray[2] - R @ p.mean(axis=0))
        shares = [camera.in_picture(camera.project(transform(T, p)).q).mean() for camera in (first, second)]
        if min(shares) >= seen:
            found.append(T)
        if len(found) == views:
            return found
    raise RuntimeError(f"Only {len(found)} of {views} views show enough of the target.")


def measured_points(pair: PairKind, count: int, random: np.random.Generator) -> Vectors3:
    """Return points in the inner part of both pictures, at the distances of a good shoot, mm."""
    first, second = pair.cameras()
    found = np.empty((0, 3))
    while len(found) < count:
        share = 0.5 + _INNER * (random.random((4 * count, 2)) - 0.5)
        rays = first.rays(share * first.size).direction
        p = pair.distance_mm * random.uniform(_NEAR, _FAR, (len(rays), 1)) * rays / rays[:, 2:]
        q = second.project(p).q / np.array(second.size) - 0.5
        with np.errstate(invalid="ignore"):
            found = np.concatenate([found, p[(np.abs(q) <= 0.5 * _INNER).all(axis=1)]])
    return found[:count]


def with_pictures(shoot: HeldShoot, pictures: list[Picture]) -> HeldShoot:
    """Return the shoot with other pictures."""
    return replace(shoot, pictures=tuple(pictures))
