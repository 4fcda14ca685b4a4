"""Good shoots of a simulated pair of cameras: a target held in the hand, in every picture."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose, Vectors3
from labcal.bench.solve.budget_rigs import KINDS, PairKind
from labcal.bench.solve.pair_dots import CAMERAS
from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose, transform
from labcal.targets.grid import DotGrid

TARGETS = ("rings", "plain")
TILT_RAD = 0.35
"""Standard deviation of the target's rotation about each axis in a good shoot."""
_NEAR, _FAR = 0.85, 1.2
"""Distances of the target in a good shoot, in units of the rig's."""
_ACROSS = np.array([1.0, 0.7])
"""By which the middle of the target moves to both sides, in units of the rig's reach."""


@dataclass(frozen=True)
class Hand:
    """The way in which a hand moves the target, in units of that of a good shoot.

    Attributes
    ----------
    tilt : float
        Of the standard deviation of rotations.
    reach : float
        Of the range of places, across and along.
    """

    tilt: float = 1.0
    reach: float = 1.0


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
        return KINDS[self.kind]


def good_shoot(
    kind: str, layout: str, views: int, random: np.random.Generator, hand: Hand | None = None
) -> HeldShoot:
    """Return a shoot of a pair.

    Parameters
    ----------
    kind : str
        One of :data:`~labcal.bench.solve.budget_rigs.KINDS`.
    layout : str
        One of :data:`TARGETS`.
    views : int
    random : numpy.random.Generator
    hand : Hand, optional
        As in a good shoot where not given.
    """
    pair = KINDS[kind]
    target = pair.target()
    if layout != TARGETS[0]:
        target = target.model_copy(
            update={"rings": None, "ring_outer_diameter_mm": None, "ring_inner_diameter_mm": None}
        )
    still = np.zeros(3)
    pictures = [
        Picture(f"view-{number:02d}", name, device, T, still)
        for number, T in enumerate(held_poses(pair, views, hand or Hand(), random))
        for name, device in zip(CAMERAS, pair.cameras(), strict=True)
    ]
    noise_px = float(random.uniform(0.02, 0.06))
    return HeldShoot(kind, target, target, target.points(), tuple(pictures), noise_px)


def held_poses(pair: PairKind, views: int, hand: Hand, random: np.random.Generator) -> list[Pose]:
    """Return ``T_world_target`` of views in which both cameras see the whole target, mm."""
    p, found = pair.target().points(), list[Pose]()
    middle = 0.5 * (_NEAR + _FAR)
    low = np.array([*(-hand.reach * _ACROSS), middle - hand.reach * (middle - _NEAR)])
    high = np.array([*(hand.reach * _ACROSS), middle + hand.reach * (_FAR - middle)])
    scale = np.array([pair.reach_mm, pair.reach_mm, pair.distance_mm])
    while len(found) < views:
        tilt = Rotation.from_rotvec(hand.tilt * TILT_RAD * random.standard_normal(3)).as_matrix()
        R = np.diag([1.0, -1.0, -1.0]) @ tilt
        T = pose(R, scale * random.uniform(low, high) - R @ p.mean(axis=0))
        if all(camera.in_picture(camera.project(transform(T, p)).q).all() for camera in pair.cameras()):
            found.append(T)
    return found


def with_pictures(shoot: HeldShoot, pictures: list[Picture]) -> HeldShoot:
    """Return the shoot with other pictures."""
    return replace(shoot, pictures=tuple(pictures))
