"""One picture from a scene to its file: the unit of work that is spread over processes."""

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.errors import OutputError
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratory import Laboratory
from labcal.render.response import Exposure, develop, expose
from labcal.render.variant import COLOUR, MONO, renderer
from labcal.rng import generator
from labcal.run.outputs import write_file
from labcal.scene.model import Scene
from labcal.scene.photometry import PictureFormat
from labcal.shoot.pictures import write_picture


@dataclass(frozen=True)
class Job:
    """One picture, and everything it depends on."""

    scene: Scene
    case: Case
    exposure: Exposure
    path: Path


def render_picture(job: Job) -> float:
    """Render one picture into its file and return the seconds that took.

    Raises
    ------
    DeviceError
        Dr.Jit has no LLVM library to compile with.
    OutputError
        The file cannot be written.
    """
    began = time.perf_counter()
    scene, case, photometry = job.scene, job.case, job.scene.photometry
    camera = scene.cameras[case.camera].camera()
    with renderer(COLOUR if photometry.bayer else MONO) as mi:
        light = render_light(Laboratory(mi, scene, camera.size, case.seed), camera, case)
    share = expose(light, photometry, job.exposure)
    if photometry.format is PictureFormat.EXR:
        _write_exr(job.path, share)
    else:
        random = generator(case.seed, case.view, case.camera, "sensor noise") if scene.noise else None
        picture = develop(share, photometry, job.exposure, random)
        write_picture(job.path, picture, jpeg_quality=photometry.jpeg_quality)
    return time.perf_counter() - began


def _write_exr(path: Path, picture: np.ndarray) -> None:
    """Write a float32 picture, linear, in channels RGB or Y."""
    import OpenEXR  # noqa: PLC0415 -- a compiled library that few pictures need

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    channels = {"Y" if picture.ndim == 2 else "RGB": np.ascontiguousarray(picture)}  # noqa: PLR2004 -- grey
    try:
        with tempfile.TemporaryDirectory() as home:
            whole = Path(home) / "picture.exr"
            OpenEXR.File(header, channels).write(str(whole))
            write_file(path, whole.read_bytes(), force=False)
    except OutputError:
        raise
    except (OSError, RuntimeError) as error:
        raise OutputError(f"{path} cannot be written: {error}.") from error
