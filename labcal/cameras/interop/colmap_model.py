"""COLMAP's model of cameras, images, rigs and frames, whichever files it comes from, and labcal's rig of it.

COLMAP counts pixels from the corner of the top-left one, whose centre is (0.5, 0.5): the principal point is
shifted in :mod:`labcal.cameras.interop.colmap_lenses` and nowhere else. An image's quaternion (w x y z) and
translation map world to camera, whose axes are labcal's. From version 3.12 on a rig gives places to its
sensors, in the frame of its reference sensor, and a frame is one place of the rig. COLMAP has no units;
labcal writes millimetres and takes a model for millimetres.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.colmap_lenses import camera_of, parameters_of
from labcal.cameras.interop.exchange import ReadRig, SourceText
from labcal.cameras.interop.placement import rig_of
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.geometry.poses import from_quaternion, inverse, pose, quaternion

PLACE = 7
"""Numbers of a place: a quaternion, its real part first, and a translation."""
_ROUNDED = 1e-3
_AGREES = 1e-6
"""Largest difference of two statements of one pose, relative to its largest number."""


@dataclass(frozen=True)
class ModelCamera:
    """One line of ``cameras.txt``."""

    number: int
    model: str
    size: tuple[int, int]
    parameters: tuple[float, ...]


@dataclass(frozen=True)
class ModelImage:
    """One image."""

    number: int
    camera: int
    name: str
    T_cam_world: Pose


@dataclass(frozen=True)
class ModelRig:
    """One rig; sensors that are no cameras are left out."""

    number: int
    T_cam_rig: Mapping[int, Pose | None]
    """By camera; None where COLMAP has not found it. The reference sensor comes first."""


@dataclass(frozen=True)
class ModelFrame:
    """One place of a rig."""

    number: int
    rig: int
    T_rig_world: Pose
    images: tuple[tuple[int, int], ...]
    """Camera and image."""


@dataclass(frozen=True)
class ColmapModel:
    """Content of a folder of COLMAP, but for points."""

    cameras: tuple[ModelCamera, ...]
    images: tuple[ModelImage, ...] = ()
    rigs: tuple[ModelRig, ...] = ()
    frames: tuple[ModelFrame, ...] = ()


@dataclass(frozen=True)
class ModelReaders:
    """Readers of the files of a folder, which are alike but for their form."""

    ending: str
    """Of their names."""
    cameras: Callable[[SourceText], Iterable[ModelCamera]]
    images: Callable[[SourceText], Iterable[ModelImage]]
    rigs: Callable[[SourceText], Iterable[ModelRig]]
    frames: Callable[[SourceText], Iterable[ModelFrame]]


def rig_of_files(sources: Mapping[str, SourceText], readers: ModelReaders) -> ReadRig:
    """Return labcal's rig of the files of a folder, by name; of one camera the list of cameras is enough.

    Raises
    ------
    InputError
        The list of cameras is missing, or that of images of several cameras, or as of :func:`rig_of_model`.
    """
    cameras, images, rigs, frames = (
        f"{what}{readers.ending}" for what in ("cameras", "images", "rigs", "frames")
    )
    if cameras not in sources:
        raise InputError(f"A model of COLMAP is a folder with {cameras} and {images}. Give the folder.")
    listed, path = tuple(readers.cameras(sources[cameras])), sources[cameras].path
    if images not in sources and len(listed) > 1:
        raise InputError(
            f"{path} holds {len(listed)} cameras, whose places stand in {images}. Give the folder with both."
        )
    model = ColmapModel(
        listed,
        tuple(readers.images(sources[images])) if images in sources else (),
        tuple(readers.rigs(sources[rigs])) if rigs in sources else (),
        tuple(readers.frames(sources[frames])) if frames in sources else (),
    )
    return rig_of_model(model, path)


def rig_of_seats(number: int, seats: Sequence[tuple[int, Pose | None]], source: Path) -> ModelRig:
    """Return a rig of its cameras and their places.

    Raises
    ------
    InputError
        A camera occurs twice.
    """
    twice, count = Counter(camera for camera, _ in seats).most_common(1)[0] if seats else (0, 1)
    if count > 1:
        raise InputError(f"{source}: camera {twice} occurs twice in rig {number}.")
    return ModelRig(number, dict(seats))


def placed(numbers: Sequence[float], what: str, source: Path) -> Pose:
    """Return a pose from seven numbers.

    Raises
    ------
    InputError
        The quaternion is none of a rotation; `what` names the line or the entry.
    """
    wxyz = np.array(numbers[:4])
    if not abs(np.linalg.norm(wxyz) - 1.0) <= _ROUNDED:
        raise InputError(f"{source}: the quaternion of {what} has not the length 1.")
    return pose(from_quaternion(wxyz), np.array(numbers[4:]))


def place_of(T: Pose) -> tuple[float, ...]:
    """Return the seven numbers of a pose."""
    return (*quaternion(T[:3, :3]).tolist(), *T[:3, 3].tolist())


def model_of(rig: Rig) -> ColmapModel:
    """Return a rig as one rig of COLMAP in one frame, with an image of each camera.

    Raises
    ------
    InputError
        COLMAP has no such lens.
    """
    cameras, images, seats = [], [], {}
    poses = [np.array(record.T_cam_world) for record in rig.cameras.values()]
    T_world_first = inverse(poses[0])
    for number, ((name, record), T) in enumerate(zip(rig.cameras.items(), poses, strict=True), start=1):
        cameras.append(ModelCamera(number, *parameters_of(name, record)))
        images.append(ModelImage(number, number, f"{name}.png", T))
        seats[number] = np.eye(4) if number == 1 else T @ T_world_first
    frame = ModelFrame(1, 1, poses[0], tuple((number, number) for number in seats))
    return ColmapModel(tuple(cameras), tuple(images), (ModelRig(1, seats),), (frame,))


def rig_of_model(model: ColmapModel, source: Path) -> ReadRig:
    """Return labcal's rig of a model, in the world of its images, or in the frame of its rig.

    Raises
    ------
    InputError
        There is no camera, something contradicts itself, or a camera of several has no place, or many.
    """
    _require_consistent(model, source)
    taken = {camera.number: [one for one in model.images if one.camera == camera.number]
             for camera in model.cameras}  # fmt: skip
    notes: tuple[str, ...] = ()
    seats = _seats(model, source)
    if all(len(images) == 1 for images in taken.values()):
        _require_agreement(model, seats, source)
        poses = {number: images[0].T_cam_world for number, images in taken.items()}
    elif seats is not None and len(model.cameras) > 1:
        poses = seats
        note = (
            f"{source}: the cameras took several images, or none; their places are those of the rig, whose "
            "reference sensor is the world."
        )
        notes = (note,)
    elif len(model.cameras) == 1:
        (number,) = taken
        notes = (f"Camera {number} took {len(taken[number])} images: its lens is read, no place of it.",)
        poses = {number: np.eye(4)}
    else:
        number, images = next((number, images) for number, images in taken.items() if len(images) != 1)
        raise InputError(
            f"{source}: camera {number} took {len(images)} images, and no rig gives it a place. A rig's "
            "camera has one place: keep one image of each camera, or give the model with rigs and frames "
            "(COLMAP 3.12 or later)."
        )
    records = [
        camera_of(camera.model, camera.size, camera.parameters, poses[camera.number], source)
        for camera in model.cameras
    ]
    return ReadRig(rig_of(_names(taken), records), notes)


def _seats(model: ColmapModel, source: Path) -> dict[int, Pose] | None:
    """Return ``T_cam_rig`` of all cameras if one rig has them all; None if none has."""
    wanted = {camera.number for camera in model.cameras}
    whole = [rig for rig in model.rigs if set(rig.T_cam_rig) == wanted]
    if not whole:
        return None
    seats = {}
    for camera, T in whole[0].T_cam_rig.items():
        if T is None:
            raise InputError(f"{source}: rig {whole[0].number} does not state where its camera {camera} is.")
        seats[camera] = T
    return seats


def _require_agreement(model: ColmapModel, seats: Mapping[int, Pose] | None, source: Path) -> None:
    """Raise where images and rig state different places of the cameras to each other, or to the world."""
    by_number = {image.number: image for image in model.images}
    rigs = {rig.number: rig for rig in model.rigs}
    for frame in model.frames:
        for camera, number in frame.images:
            T_cam_rig = rigs[frame.rig].T_cam_rig[camera]
            if T_cam_rig is None:
                continue
            _require_same(by_number[number].T_cam_world, T_cam_rig @ frame.T_rig_world, camera, source)
    if seats is None or model.frames:
        return
    first = model.images[0]
    T_rig_world = inverse(seats[first.camera]) @ first.T_cam_world
    for image in model.images:
        _require_same(image.T_cam_world, seats[image.camera] @ T_rig_world, image.camera, source)


def _require_same(first: Pose, second: Pose, camera: int, source: Path) -> None:
    """Raise where two statements of a camera's pose differ by more than rounding."""
    if np.abs(first - second).max() > _AGREES * max(1.0, np.abs(first).max()):
        raise InputError(
            f"{source}: the image of camera {camera} has another place than its rig and frame give it. "
            "Export the model anew, or leave out the files of rigs and frames."
        )


def _require_consistent(model: ColmapModel, source: Path) -> None:
    """Raise where a number stands for two things, or for nothing."""
    if not model.cameras:
        raise InputError(f"{source} lists no camera.")
    for what, entries in (
        ("camera", model.cameras), ("image", model.images), ("rig", model.rigs), ("frame", model.frames)
    ):  # fmt: skip
        number, count = Counter(one.number for one in entries).most_common(1)[0] if entries else (0, 1)
        if count > 1:
            raise InputError(f"{source}: the {what} {number} occurs {count} times.")
    cameras = {camera.number for camera in model.cameras}
    taken = {(image.camera, image.number) for image in model.images}
    _require_known((image.camera for image in model.images), cameras, "an image of the camera", source)
    rigs = {rig.number: rig for rig in model.rigs}
    for rig in model.rigs:
        _require_known(rig.T_cam_rig, cameras, "a rig with the camera", source)
    for frame in model.frames:
        _require_known([frame.rig], rigs, "a frame of the rig", source)
        _require_known(frame.images, taken, "a frame with the camera and image", source)
        _require_known((one for one, _ in frame.images), rigs[frame.rig].T_cam_rig, "in its rig", source)


def _require_known(found: Iterable[object], known: Iterable[object], what: str, source: Path) -> None:
    """Raise where something refers to what is not there."""
    lost = [one for one in found if one not in known]
    if lost:
        raise InputError(f"{source}: there is {what} {lost[0]}, which is not listed. Copy the whole folder.")


def _names(taken: Mapping[int, Sequence[ModelImage]]) -> list[str]:
    """Return the cameras' names: of the images, of their folders, or the numbers, whatever is distinct."""
    if all(len(images) == 1 for images in taken.values()):
        names = [PurePosixPath(images[0].name).stem for images in taken.values()]
        if len(set(names)) == len(names):
            return names
    folders = [{PurePosixPath(image.name).parent.name for image in images} for images in taken.values()]
    if all(len(one) == 1 and "" not in one for one in folders):
        names = [next(iter(one)) for one in folders]
        if len(set(names)) == len(names):
            return names
    return [f"camera-{number}" for number in taken]
