"""Mistakes in a shoot that change where dots are: each with a size."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from labcal.bench.diagnose.held_shoot import HeldShoot, Picture, with_pictures
from labcal.bench.solve.pair_dots import CAMERAS
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.geometry.poses import from_rotation_vector, transform
from labcal.guide.diagnosis.check_name import CheckName

Mistaken = Callable[[HeldShoot, float, np.random.Generator], HeldShoot]


def unsynchronised(shoot: HeldShoot, size: float, random: np.random.Generator) -> HeldShoot:
    """Let the second camera expose later; `size` is the target's usual way until then, mm."""
    moves = {view: size * random.standard_normal(3) / np.sqrt(3.0) for view in shoot.views}
    turns = {view: size / _radius(shoot) * random.standard_normal(3) / np.sqrt(3.0) for view in shoot.views}
    return with_pictures(
        shoot,
        [
            replace(one, T_world_target=_carried(shoot, one, moves[one.view], turns[one.view]))
            if one.camera == CAMERAS[1]
            else one
            for one in shoot.pictures
        ],
    )


def camera_moved(shoot: HeldShoot, size: float, random: np.random.Generator) -> HeldShoot:
    """Turn the second camera by `size` degrees from a view in the middle third on."""
    later, axis = _later(shoot, random), _direction(random)
    turn = from_rotation_vector(np.radians(size) * axis, np.zeros(3))
    return _with_devices(
        shoot, later, CAMERAS[1], lambda camera: replace(camera, T_cam_world=turn @ camera.T_cam_world)
    )


def refocused(shoot: HeldShoot, size: float, random: np.random.Generator) -> HeldShoot:
    """Change the principal distance of one camera by the share `size` from a view in the middle third on."""
    later = _later(shoot, random)
    factor = np.array([1.0 + size, 1.0 + size, 1.0])
    name = CAMERAS[int(random.integers(2))]
    return _with_devices(
        shoot, later, name, lambda camera: replace(camera, K=_scaled_focus(camera.K, factor))
    )


def bent_board(shoot: HeldShoot, size: float, random: np.random.Generator) -> HeldShoot:
    """Bend the board to a cylinder about an axis in its plane; `size` is its sagitta, mm."""
    dots = shoot.dots.copy()
    angle = float(random.choice([0.0, 0.5 * np.pi, random.uniform(0.0, np.pi)]))
    across = (dots - dots.mean(axis=0))[:, :2] @ np.array([np.cos(angle), np.sin(angle)])
    dots[:, 2] += float(random.choice([-1.0, 1.0])) * size * (across / np.abs(across).max()) ** 2
    return replace(shoot, dots=dots)


def wrong_pitch(shoot: HeldShoot, size: float, random: np.random.Generator) -> HeldShoot:
    """Print the dots further apart along one axis than along the other, by the share `size`."""
    dots = shoot.dots.copy()
    axis = int(random.integers(2))
    dots[:, axis] *= 1.0 + size * float(random.choice([-1.0, 1.0]))
    return replace(shoot, dots=dots)


def rolling_shutter(shoot: HeldShoot, size: float, random: np.random.Generator) -> HeldShoot:
    """Move the target while rows are read, by usually `size` mm from the first row to the last."""
    drift = {view: size * random.standard_normal(3) / np.sqrt(3.0) for view in shoot.views}
    return with_pictures(shoot, [replace(one, drift_mm=drift[one.view]) for one in shoot.pictures])


MISTAKES: Mapping[CheckName, Mistaken] = {
    CheckName.UNSYNCHRONISED: unsynchronised,
    CheckName.CAMERA_MOVED: camera_moved,
    CheckName.REFOCUSED: refocused,
    CheckName.BENT_BOARD: bent_board,
    CheckName.WRONG_PITCH: wrong_pitch,
    CheckName.ROLLING_SHUTTER: rolling_shutter,
}
"""Those that are made of a good shoot."""


def swapped_cameras(dots: Detections, share: float, random: np.random.Generator) -> Detections:
    """Exchange the names of the two cameras in a share of the views, one at least."""
    chosen = np.isin(dots.view, _some_views(dots, share, random))
    other = np.where(dots.camera == CAMERAS[0], CAMERAS[1], CAMERAS[0])
    image = [f"{view}_{camera}.png" for view, camera in zip(dots.view, dots.camera, strict=True)]
    swapped = replace(dots, camera=np.where(chosen, other, dots.camera), image=np.array(image))
    names = [f"{view}_{camera}.png" for view, camera in zip(swapped.view, swapped.camera, strict=True)]
    return replace(swapped, image=np.array(names))


def turned_target(dots: Detections, share: float, random: np.random.Generator) -> Detections:
    """Return dots that one camera numbers from the other corner, in a share of the views, one at least."""
    chosen = np.isin(dots.view, _some_views(dots, share, random)) & (dots.camera == CAMERAS[1])
    last = dots.index.max(axis=0)
    return replace(dots, index=np.where(chosen[:, None], last - dots.index, dots.index))


def mixed_sizes(dots: Detections, factor: float, random: np.random.Generator) -> Detections:
    """Scale some pictures of one camera by a factor, as a program does that stores smaller copies."""
    views = _some_views(dots, 0.3, random)
    chosen = np.isin(dots.view, views) & (dots.camera == CAMERAS[int(random.integers(2))])
    position = np.where(chosen[:, None], factor * (dots.position + 0.5) - 0.5, dots.position)
    size = np.where(chosen[:, None], np.rint(factor * dots.size).astype(np.int64), dots.size)
    covariance = np.where(chosen[:, None, None], factor**2 * dots.covariance, dots.covariance)
    return replace(dots, position=position, size=size, covariance=covariance)


MISLABELLED: Mapping[CheckName, Callable[[Detections, float, np.random.Generator], Detections]] = {
    CheckName.SWAPPED_CAMERAS: swapped_cameras,
    CheckName.TURNED_TARGET: turned_target,
    CheckName.MIXED_SIZES: mixed_sizes,
}
"""Those that are made of the dots of a good shoot."""


def _some_views(dots: Detections, share: float, random: np.random.Generator) -> list[str]:
    views = list(dots.views)
    count = max(1, round(share * len(views)))
    return [views[place] for place in random.permutation(len(views))[:count]]


def _later(shoot: HeldShoot, random: np.random.Generator) -> frozenset[str]:
    """Return the views from one in the middle third on."""
    views = shoot.views
    third = len(views) // 3
    return frozenset(views[int(random.integers(third, len(views) - third + 1)) :])


def _with_devices(
    shoot: HeldShoot, views: frozenset[str], name: str, changed: Callable[[Camera], Camera]
) -> HeldShoot:
    return with_pictures(
        shoot,
        [
            replace(one, device=changed(one.device)) if one.camera == name and one.view in views else one
            for one in shoot.pictures
        ],
    )


def _scaled_focus(K: np.ndarray, factor: np.ndarray) -> np.ndarray:
    scaled = K.copy()
    scaled[[0, 1], [0, 1]] *= factor[:2]
    return scaled


def _carried(shoot: HeldShoot, one: Picture, move: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Return the target's pose after a motion about its own middle."""
    T = one.T_world_target
    middle = transform(T, shoot.dots.mean(axis=0)[None])[0]
    moved = from_rotation_vector(turn, np.zeros(3))
    result = moved @ T
    result[:3, 3] = moved[:3, :3] @ (T[:3, 3] - middle) + middle + move
    return np.asarray(result)


def _radius(shoot: HeldShoot) -> float:
    """Return the half-diagonal of the dots, mm."""
    return float(np.linalg.norm(shoot.dots - shoot.dots.mean(axis=0), axis=1).max())


def _direction(random: np.random.Generator) -> np.ndarray:
    drawn = random.standard_normal(3)
    return np.asarray(drawn / np.linalg.norm(drawn))
