"""A pose in words: nearer or farther, where in the picture, which edge away, turned how."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.guide.next_pose.volume import middle_of_eyes
from labcal.wording import listed

_SAME = 0.08
"""Share of the distance below which a pose is neither closer nor farther."""
_KNOWN = 0.05
"""Relative standard deviation of distances up to which words give them as lengths."""
_FACING_DEG = 8.0
_THIRD = 1.0 / 3.0
_UPRIGHT_DEG, _BACK_DEG = 30.0, 150.0
_OCTANT_DEG = 22.5


@dataclass(frozen=True)
class HeldBefore:
    """The pose that was taken last, and how well distances are known.

    Attributes
    ----------
    T_world_target : float64 array, (4, 4), or None
        Mm; None where there is none.
    distance_share : float
        Relative standard deviation of distances. A calibration of few views may change them by more than a
        person would believe, and then words give them as shares of the last one.
    """

    T_world_target: Pose | None
    distance_share: float = 0.0


def pose_words(
    names: Sequence[str],
    cameras: Sequence[Camera],
    T_world_target: Pose,
    middle: Vectors3,
    before: HeldBefore,
) -> str:
    """Return a pose in words for whoever holds the target.

    Parameters
    ----------
    names : sequence of str
        Of the cameras that are to see the target.
    cameras : sequence of Camera
        These cameras.
    T_world_target : ndarray, shape (4, 4)
        The pose that is asked for, mm.
    middle : ndarray, shape (3,)
        Of the target, mm.
    before : HeldBefore
        The pose that was taken last.
    """
    eyes = middle_of_eyes(tuple(cameras))
    held = T_world_target[:3, :3] @ middle + T_world_target[:3, 3]
    distance = float(np.linalg.norm(held - eyes))
    parts = [_distance_words(distance, middle, eyes, before)]
    places = [place_in_picture(camera, held) for camera in cameras]
    if any(places):
        which = next(number for number, place in enumerate(places) if place)
        most = max(range(len(places)), key=lambda one: len(places[one].split()))
        which = most if len(places[most].split()) > len(places[which].split()) else which
        of = "" if len(cameras) == 1 else f" of camera {names[which]}"
        parts.append(f"in the {places[which]} of the picture{of}")
    else:
        parts.append("in the middle of the picture" + ("s" if len(cameras) > 1 else ""))
    parts.append(_tilt(T_world_target, held, eyes, cameras[0]))
    turned = _roll(T_world_target, cameras[0])
    if turned:
        parts.append(turned)
    return ", ".join(parts)


def place_in_picture(camera: Camera, held: Vectors3) -> str:
    """Return the part of the picture in which a place is seen: "upper left"; empty for the middle."""
    q = camera.project(held[None]).q[0]
    if not np.isfinite(q).all():
        return ""
    x, y = q / np.array(camera.size)
    across = "left" if x < _THIRD else "right" if x > 1.0 - _THIRD else ""
    upright = "upper" if y < _THIRD else "lower" if y > 1.0 - _THIRD else ""
    if across and upright:
        return f"{upright} {across}"
    return {"left": "left part", "right": "right part"}.get(across, "") or (
        f"{upright} part" if upright else ""
    )


def _distance_words(distance: float, middle: Vectors3, eyes: Vectors3, before: HeldBefore) -> str:
    """Return closer or farther, and the distance: a length, or a share of the last where it is not known."""
    length, T = f"about {_length(distance)} from the cameras", before.T_world_target
    if T is None:
        return f"Hold the target, {length}"
    share = distance / float(np.linalg.norm(T[:3, :3] @ middle + T[:3, 3] - eyes))
    if abs(share - 1.0) <= _SAME:
        words, length = "As far as before", length if before.distance_share <= _KNOWN else ""
    else:
        words = "Closer" if share < 1.0 else "Farther"
        if before.distance_share > _KNOWN:
            length = f"at about {round(20.0 * share) * 5}% of the distance before"
    return f"{words}, {length}" if length else words


def _length(mm: float) -> str:
    return f"{0.001 * mm:.1f} m" if mm >= 2000.0 else f"{round(mm / 10.0):.0f} cm"  # noqa: PLR2004 -- 2 m


def _tilt(T_world_target: Pose, held: Vectors3, eyes: Vectors3, camera: Camera) -> str:
    """Return which edge of the target, as the camera sees it, is to be farther away, and by what angle."""
    toward = (eyes - held) / np.linalg.norm(eyes - held)
    normal = T_world_target[:3, 2]
    angle = float(np.degrees(np.arccos(np.clip(normal @ toward, -1.0, 1.0))))
    if angle < _FACING_DEG:
        return "facing the cameras"
    # The normal leans the way in which the board's farther edge lies: top away, it looks up.
    right, down = camera.T_cam_world[0, :3] @ normal, camera.T_cam_world[1, :3] @ normal
    right -= camera.T_cam_world[0, :3] @ toward
    down -= camera.T_cam_world[1, :3] @ toward
    octant = round(float(np.degrees(np.arctan2(down, right))) / (2.0 * _OCTANT_DEG)) % 8
    edge = (
        "right side", "lower right corner", "bottom", "lower left corner", "left side",
        "upper left corner", "top", "upper right corner",
    )[octant]  # fmt: skip
    return f"tilt the {edge} away by about {round(angle / 5.0) * 5:.0f} degrees"


def _roll(T_world_target: Pose, camera: Camera) -> str:
    """Return how the target is to be turned in its own plane, as the camera sees it."""
    x, y = (camera.T_cam_world[:3, :3] @ T_world_target[:3, :3])[:2, 0]
    roll = float(np.degrees(np.arctan2(y, x)))  # clockwise in the picture
    if abs(roll) < _UPRIGHT_DEG:
        return ""
    if abs(roll) > _BACK_DEG:
        return "upside down"
    much = "an eighth" if abs(roll) < 3.0 * _OCTANT_DEG else "a quarter"
    return f"turned {much} {'clockwise' if roll > 0.0 else 'counter-clockwise'}"


def lacks_words(coverage: Sequence[tuple[str, np.ndarray]]) -> list[str]:
    """Return which corners of which pictures no dot was found in.

    Parameters
    ----------
    coverage : sequence of (str, ndarray of int, shape (rows, columns))
        Dots by cell of a picture.
    """
    found = []
    for name, cells in coverage:
        half, third = cells.shape[0] // 2, cells.shape[1] // 3
        parts = {
            "upper left": cells[:half, :third], "upper right": cells[:half, -third:],
            "lower left": cells[-half:, :third], "lower right": cells[-half:, -third:],
        }  # fmt: skip
        empty = [part for part, cell in parts.items() if not cell.any()]
        if empty:
            found.append(f"no dots yet in the {listed(empty)} of camera {name}")
    return found
