"""Cameras that a target is designed for: of a description, a rig file, a plan of a rig or a scene."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from pydantic import ValidationError

from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENSES, undistorted_dist
from labcal.cameras.rig_file import read_rig
from labcal.errors import InputError, UnknownNameError
from labcal.guide.rehearsal.catalogue import load_rig_plan, rig_plan_names
from labcal.guide.rehearsal.planned_camera import PlannedCamera
from labcal.paths import AnyPath, as_path, as_text
from labcal.run.descriptions import explain_validation
from labcal.scene.catalogue import load_scene, scene_names
from labcal.scene.photometry import Photometry

_FLAT_PICTURES = ("pinhole", "brown-k1k2", "brown5", "rational8", "thin-prism12", "tilted14")
_MOST_FLAT_DEG = 150.0
"""Field of view of lenses whose pictures are those of a plane; the widest on sale have some 130 degrees."""


@dataclass(frozen=True)
class KnownCameras:
    """Cameras, and what is known with them.

    Parameters
    ----------
    cameras : mapping of str to Camera
    photometry : Photometry or None
        None of a rig file, which does not tell.
    distances_mm : (float, float) or None
        The near and the far end of the working volume; None where there is none.
    room_mm : (float, float) or None
        Its width and height.
    """

    cameras: Mapping[str, Camera]
    photometry: Photometry | None = None
    distances_mm: tuple[float, float] | None = None
    room_mm: tuple[float, float] | None = None


def described_camera(description: Mapping[str, object]) -> Camera:
    """Return a camera of size and lens, as the keys of a plan of a rig describe it.

    Raises
    ------
    InputError
        A key is missing, or a value is not allowed.
    """
    try:
        planned = PlannedCamera.model_validate(dict(description))
    except ValidationError as error:
        raise InputError(f"The camera cannot be used: {explain_validation(error, PlannedCamera)}.") from error
    camera = planned_lens_camera(planned)
    width, height = planned.size
    ends = np.array([[0.0, 0.5 * (height - 1)], [width - 1.0, 0.5 * (height - 1)]])
    rays = camera.rays(ends)
    seen = float(np.degrees(np.arccos(np.clip(rays.direction[:, 2], -1.0, 1.0)).sum()))
    if planned.lens in _FLAT_PICTURES and not (rays.ok.all() and seen <= _MOST_FLAT_DEG):
        raise InputError(
            f"A lens of the model '{planned.lens}' cannot have a field of view of {seen:.4g} degrees along "
            f"the width: pictures on a plane grow beyond bounds towards 180, and {_MOST_FLAT_DEG:g} is the "
            "most here. Check it or the focal length, or give `lens='fisheye-kb4'` for a fisheye."
        )
    return camera


def sensor_of(preset: str) -> Photometry:
    """Return the sensor of a preset's name.

    Raises
    ------
    InputError
        There is none of that name.
    """
    try:
        return Photometry.model_validate(preset)
    except ValidationError as error:
        raise InputError(f"The sensor cannot be used: {explain_validation(error, Photometry)}.") from error


def planned_lens_camera(planned: PlannedCamera) -> Camera:
    """Return a planned camera at the origin, looking along z.

    Raises
    ------
    InputError
        It is impossible.
    """
    focal, (width, height) = planned.focal_length_px(), planned.size
    u, v = planned.principal_px or (0.5 * (width - 1), 0.5 * (height - 1))
    dist = np.array(undistorted_dist(LENSES[planned.lens]), dtype=np.float64)
    dist[: len(planned.dist)] = planned.dist
    K = np.array([[focal, 0.0, u], [0.0, focal, v], [0.0, 0.0, 1.0]])
    return Camera(K, planned.lens, dist, np.eye(4), planned.size)


def known_cameras(source: AnyPath) -> KnownCameras:
    """Return the cameras of a rig file, a plan of a rig, or a scene.

    Parameters
    ----------
    source : str or os.PathLike
        The path of a ``rig.json``, or the name or path of a plan or a scene.

    Raises
    ------
    UnknownNameError
        There is nothing of that name.
    InputError
        It cannot be read.
    """
    name = as_text(source)
    if name.endswith(".json"):
        rig = read_rig(as_path(source))
        return KnownCameras({camera: rig.camera(camera) for camera in rig.cameras})
    if name in rig_plan_names():
        return _of_plan(name)
    if name in scene_names():
        return _of_scene(name)
    if not as_path(source).is_file():
        known = [*rig_plan_names(), *scene_names()]
        raise UnknownNameError("rig.json, plan of a rig or scene", name, known)
    text = as_path(source).read_text(encoding="utf-8", errors="replace")
    return _of_plan(name) if "\nvolume:" in f"\n{text}" else _of_scene(name)


def _of_plan(name: str) -> KnownCameras:
    plan = load_rig_plan(name)
    volume = plan.volume
    return KnownCameras(
        {camera: planned_lens_camera(planned) for camera, planned in plan.cameras.items()},
        plan.photometry,
        (volume.near_mm, volume.far_mm),
        (volume.width_mm, volume.height_mm),
    )


def _of_scene(name: str) -> KnownCameras:
    scene = load_scene(name)
    return KnownCameras(scene.true_cameras(), scene.photometry)
