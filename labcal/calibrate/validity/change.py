"""Kinds of changes of a rig since it was calibrated, and the parameters that they move."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.camera import Camera
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.poses import from_rotation_vector, inverse, pose

TURN_RAD = np.radians(1.0)
"""Standard deviation of a turn about each axis, before the pictures are seen."""
SHIFT_OF_DISTANCE = 0.01
"""The same of a shift along each axis, in units of the distance of the target."""
FOCUS = 0.02
"""The same of the relative change of the focal length."""
PRINCIPAL_POINT_OF_WIDTH = 0.005
"""The same of the principal point, which a refocus moves, too, in units of the width of the picture."""


class ChangeKind(StrEnum):
    """Kinds of changes of one camera, or of all."""

    TURNED = "turned"
    """About its centre of projection."""
    SHIFTED = "shifted"
    MOVED = "moved"
    """Turned and shifted."""
    REFOCUSED = "refocused"
    """The focal length alone."""
    MOVED_AND_REFOCUSED = "moved-and-refocused"
    """Turned, shifted, another focal length and principal point."""
    SEVERAL = "several"
    """The same of all cameras."""
    TOGETHER = "together"
    """All cameras moved in the room as one body: the rig itself is as it was."""


class Element(StrEnum):
    """Parts of a change of one camera."""

    TURN = "turn"
    SHIFT = "shift"
    FOCUS = "focus"
    PRINCIPAL_POINT = "principal point"


_ELEMENTS = {
    ChangeKind.TURNED: (Element.TURN,),
    ChangeKind.SHIFTED: (Element.SHIFT,),
    ChangeKind.MOVED: (Element.TURN, Element.SHIFT),
    ChangeKind.REFOCUSED: (Element.FOCUS,),
    ChangeKind.MOVED_AND_REFOCUSED: tuple(Element),
    ChangeKind.SEVERAL: tuple(Element),
    ChangeKind.TOGETHER: (Element.TURN, Element.SHIFT),
}
ALL_CAMERAS = (ChangeKind.SEVERAL, ChangeKind.TOGETHER)
"""Kinds of changes that are of all cameras."""
_PAIR = 2
_WIDTH = {Element.TURN: 3, Element.SHIFT: 3, Element.FOCUS: 1, Element.PRINCIPAL_POINT: 2}


@dataclass(frozen=True)
class Change:
    """A change of a rig; its size is a vector of rad, mm, relative focal lengths and px.

    Attributes
    ----------
    kind : ChangeKind
    cameras : tuple of int
        The cameras that change.
    suspects : tuple of int
        The cameras of which each could be the one: a shift between two cameras is one of either.
    """

    kind: ChangeKind
    cameras: tuple[int, ...]
    suspects: tuple[int, ...]

    @property
    def count(self) -> int:
        """Number of its parameters."""
        return sum(_WIDTH[element] for _, element, _ in self.parts())

    def parts(self) -> Iterator[tuple[int, Element, slice]]:
        """Return each camera's elements, and where they are in the vector.

        Of all cameras the first one stays where it is: it is the world. Cameras that move together have one
        motion, along the axes of the first of them.
        """
        first = 0
        together = self.kind is ChangeKind.TOGETHER
        for camera in self.cameras[:1] if together else self.cameras:
            for element in _ELEMENTS[self.kind]:
                stays = self.kind is ChangeKind.SEVERAL and camera == 0
                if stays and element in (Element.TURN, Element.SHIFT):
                    continue
                yield camera, element, slice(first, first + _WIDTH[element])
                first += _WIDTH[element]

    def sizes(self, cameras: tuple[Camera, ...], distance_mm: float) -> Float64[np.ndarray, " count"]:
        """Return the standard deviations of the parameters before the pictures are seen."""
        found = np.empty(self.count)
        for camera, element, at in self.parts():
            found[at] = {
                Element.TURN: TURN_RAD,
                Element.SHIFT: SHIFT_OF_DISTANCE * distance_mm,
                Element.FOCUS: FOCUS,
                Element.PRINCIPAL_POINT: PRINCIPAL_POINT_OF_WIDTH * cameras[camera].size[0],
            }[element]
        return found

    def columns(self, state: RigState) -> Float64[np.ndarray, "shared count"]:
        """Return the derivatives of the parameters of ``rig.json`` by those of the change.

        A first camera that moves takes the world with it: then the poses of all others change.
        """
        layout = Layout(state, Freedom(Lenses.FREE, np.zeros((state.dots.size, 0))))
        B = np.zeros((layout.count, self.count))
        for camera, element, at in self.parts():
            lens = layout.lens[camera].start
            if element is Element.FOCUS:
                B[lens : lens + 2, at.start] = state.cameras[camera].intrinsics[:2]
            elif element is Element.PRINCIPAL_POINT:
                B[lens + 2 : lens + 4, at] = np.eye(2)
            else:
                moved = _moved_together if self.kind is ChangeKind.TOGETHER else _poses_moved
                for other, turn, shift in moved(state.cameras, camera, element):
                    place = layout.pose[other].start
                    B[place : place + 3, at], B[place + 3 : place + 6, at] = turn, shift
        return B

    def applied(self, state: RigState, size: Float64[np.ndarray, " count"]) -> RigState:
        """Return the rig after a change, and the target where it is seen in nearly the same places.

        Raises
        ------
        InputError
            There is no such camera.
        """
        cameras = list(state.cameras)
        moved = [camera.T_cam_world for camera in cameras]
        for camera, element, at in self.parts():
            value = size[at]
            if element in (Element.TURN, Element.SHIFT):
                turns = element is Element.TURN
                motion = from_rotation_vector(value, np.zeros(3)) if turns else pose(np.eye(3), value)
                here, back = moved[camera], inverse(moved[camera])
                for number in self.cameras if self.kind is ChangeKind.TOGETHER else (camera,):
                    moved[number] = moved[number] @ back @ motion @ here
            else:
                cameras[camera] = _with_lens(cameras[camera], element, value)
        world = moved[0]
        back = inverse(world)
        placed = [np.eye(4), *(T @ back for T in moved[1:])]
        pairs = zip(cameras, placed, strict=True)
        changed = tuple(replace(camera, T_cam_world=T) for camera, T in pairs)
        return replace(state, cameras=changed, T_world_target=world @ state.T_world_target)


def _poses_moved(
    cameras: tuple[Camera, ...], camera: int, element: Element
) -> Iterator[tuple[int, Float64[np.ndarray, "3 3"], Float64[np.ndarray, "3 3"]]]:
    """Yield the cameras whose poses change, and the derivatives of their turns and shifts."""
    if camera:
        t = cameras[camera].T_cam_world[:3, 3]
        if element is Element.TURN:
            yield camera, np.eye(3), -cross_matrices(t[None])[0]
        else:
            yield camera, np.zeros((3, 3)), np.eye(3)
        return
    for number, other in enumerate(cameras[1:], start=1):
        R = other.T_cam_world[:3, :3]
        if element is Element.TURN:
            yield number, -R, np.zeros((3, 3))
        else:
            yield number, np.zeros((3, 3)), -R


def _moved_together(
    cameras: tuple[Camera, ...], camera: int, element: Element
) -> Iterator[tuple[int, Float64[np.ndarray, "3 3"], Float64[np.ndarray, "3 3"]]]:
    """Yield the same of a motion of all cameras but the world, along the axes of `camera`."""
    T = cameras[camera].T_cam_world
    for number, other in enumerate(cameras[1:], start=1):
        Q = other.T_cam_world[:3, :3] @ T[:3, :3].T
        if element is Element.TURN:
            yield number, Q, -Q @ cross_matrices(T[None, :3, 3])[0]
        else:
            yield number, np.zeros((3, 3)), Q


def _with_lens(camera: Camera, element: Element, value: np.ndarray) -> Camera:
    """Return a camera with another focal length or principal point."""
    fx, fy, cx, cy = camera.intrinsics
    if element is Element.FOCUS:
        fx, fy = (1.0 + float(value[0])) * np.array([fx, fy])
    else:
        cx, cy = np.array([cx, cy]) + value
    return replace(camera, K=np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]))


def possible_changes(cameras: tuple[int, ...]) -> tuple[Change, ...]:
    """Return all changes that are looked for.

    Parameters
    ----------
    cameras : tuple of int
        Cameras with pictures.
    """
    if len(cameras) == 1:
        return (Change(ChangeKind.REFOCUSED, cameras, cameras),)
    pair = len(cameras) == _PAIR
    found = [Change(ChangeKind.TURNED, (camera,), (camera,)) for camera in cameras]
    for kind in (ChangeKind.SHIFTED, ChangeKind.MOVED):
        # Between two cameras the one that moved is not observable; with more, the others tell.
        found += (
            [Change(kind, cameras[1:], cameras)]
            if pair
            else [Change(kind, (camera,), (camera,)) for camera in cameras]
        )
    for kind in (ChangeKind.REFOCUSED, ChangeKind.MOVED_AND_REFOCUSED):
        found += [Change(kind, (camera,), (camera,)) for camera in cameras]
    return (*found, Change(ChangeKind.SEVERAL, cameras, cameras))


def changes_in_room(cameras: tuple[int, ...]) -> tuple[Change, ...]:
    """Return all changes that are looked for by marks that stay where they are.

    Parameters
    ----------
    cameras : tuple of int
        Cameras with pictures; the room is none of them.
    """
    kinds = [kind for kind in ChangeKind if kind not in ALL_CAMERAS]
    found = [Change(kind, (camera,), (camera,)) for kind in kinds for camera in cameras]
    if len(cameras) > 1:
        found.append(Change(ChangeKind.TOGETHER, cameras, cameras))
    return (*found, Change(ChangeKind.SEVERAL, cameras, cameras))
