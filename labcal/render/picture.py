"""The rendering of one picture into its file: the unit of parallel work."""

import json
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.cameras.record import CameraRecord
from labcal.render.delivery import Destination, deliver
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.sensor_response import Exposure, Shot
from labcal.render.variant import COLOUR, MONO, renderer
from labcal.scene.model import Scene
from labcal.scene.photometry import Photometry


@dataclass(frozen=True)
class Job:
    """One picture, and everything that determines it."""

    scene: Scene
    """The scene as it really stands."""
    case: Case
    exposure: Exposure
    path: Path


def render_picture(job: Job) -> float:
    """Render one picture into its file, and return the duration in seconds.

    Raises
    ------
    DeviceError
        Dr.Jit has no LLVM library to compile with.
    OutputError
        The file cannot be written.
    """
    began = time.perf_counter()
    deliver(*exposed(job.scene, job.case, job.exposure), Destination(job.path, _texts(job)))
    return time.perf_counter() - began


def exposed(
    scene: Scene, case: Case, exposure: Exposure
) -> tuple[np.ndarray, Photometry, Exposure, Shot | None]:
    """Return the light of a picture, and what :func:`~labcal.render.delivery.sensor_picture` takes with it.

    Raises
    ------
    DeviceError
        Dr.Jit has no LLVM library to compile with.
    """
    photometry = case.take.photometry(scene.photometry)
    with renderer(COLOUR if photometry.bayer else MONO) as mi:
        light = render_light(Laboratories(mi, scene, case.seed), case)
    shot = Shot(case.seed, case.view, case.camera) if scene.noise else None
    return light, photometry, exposure, shot


def _texts(job: Job) -> dict[str, str]:
    """Return the texts in the header of an EXR file, in JSON: camera (as in ``truth.json``) and picture."""
    picture = {
        "view": job.case.view,
        "camera": job.case.camera,
        "exposure_ms": job.scene.photometry.exposure_ms,
        "full_scale_radiance": 1.0 / job.exposure.gain,
    }
    return {
        "labcal:camera": CameraRecord.of(job.case.take.device).model_dump_json(),
        "labcal:picture": json.dumps(picture),
    }
