"""The programs of mrcal, run like by a user: calibration from a ``corners.vnl``, and projection."""

import json
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from labcal.arrays import Pixels, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.correspond.detections import Detections
from labcal.correspond.interop.corners_vnl import corners_text
from labcal.errors import DeviceError
from labcal.run.bound_program import bound_to_this_process
from labcal.run.made import note_made
from labcal.run.outputs import write_file
from labcal.targets.catalogue import AnyTarget

LENSMODEL = "LENSMODEL_OPENCV8"
_CALIBRATE = "mrcal-calibrate-cameras"
_REPROJECT = "mrcal-reproject-points"
_MM_IN_M = 1000.0
_SECONDS = 600
_PINHOLE_FOCAL = 1000.0
_STARTS = (1.0, 0.45, 0.9, 0.6, 0.35, 1.5)
"""Factors on the focal length to begin with."""
_LOST_PX = 1.0
"""RMS from which on mrcal has not found the camera."""
_PROJECT = """
import json, sys
import mrcal
import numpy as np
model = mrcal.cameramodel(sys.argv[1])
p = np.array(json.load(sys.stdin))
v = mrcal.transform_point_rt(model.extrinsics_rt_fromref(), p)
json.dump(mrcal.project(v, *model.intrinsics()).tolist(), sys.stdout)
"""


def is_installed() -> bool:
    """Tell whether the programs of mrcal are installed."""
    return all(shutil.which(program) is not None for program in (_CALIBRATE, _REPROJECT))


def calibrated_by_mrcal(
    detections: Detections, target: AnyTarget, focal_px: float, folder: Path
) -> Camera | None:
    """Return the camera that mrcal finds, with :data:`LENSMODEL` and a flat board.

    Parameters
    ----------
    detections : Detections
        Of one camera.
    target : AnyTarget
    focal_px : float
        Where mrcal begins; where it ends nowhere near the dots, it begins again elsewhere.
    folder : Path
        For ``corners.vnl``, the output of the program, and the model; it must exist.

    Returns
    -------
    Camera or None
        None where no start led it to a camera.

    Raises
    ------
    DeviceError
        The program failed.
    """
    corners = corners_text(detections, target)
    write_file(folder / "corners.vnl", corners.text, force=True)
    (camera,) = detections.cameras
    width, height = detections.picture_size(camera)
    pitch = float(target.points()[1, 0] - target.points()[0, 0])
    words = [
        "--corners-cache", "corners.vnl", "--corners-cache-has-weights", "--lensmodel", LENSMODEL,
        "--imagersize", str(width), str(height), "--object-spacing", repr(pitch / _MM_IN_M),
        "--object-width-n", str(target.cols), "--object-height-n", str(target.rows),
        "--skip-calobject-warp-solve", "--outdir", ".",
    ]  # fmt: skip
    for factor in _STARTS:
        said = _run([_CALIBRATE, *words, "--focal", repr(factor * focal_px), "*.png"], folder)
        write_file(folder / "mrcal.txt", said, force=True)
        for model in folder.glob("camera-*.cameramodel"):
            note_made(model, model)
        rms = re.findall(r"^RMS reprojection error: (\S+) pixels", said, re.MULTILINE)
        if rms and float(rms[-1]) <= _LOST_PX:
            _, read = read_rig_files([folder / "camera-0.cameramodel"], "mrcal")
            return read.rig.camera(next(iter(read.rig.cameras)))
    return None


def reprojected(model: Path, v: Vectors3) -> Pixels:
    """Return images of directions by ``mrcal-reproject-points``, which prints six digits.

    Parameters
    ----------
    model : Path
        A ``.cameramodel``; the program takes its rotation, not its translation.
    v : ndarray, shape (n, 3)
        Directions in the reference's frame, in front of its x-y plane.
    """
    pinhole = model.with_name("pinhole.cameramodel")
    intrinsics = f"[{_PINHOLE_FOCAL}, {_PINHOLE_FOCAL}, 0.0, 0.0]"
    write_file(
        pinhole,
        f"{{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': {intrinsics}, "
        "'extrinsics': [0, 0, 0, 0, 0, 0], 'imagersize': [1000, 1000]}\n",
        force=True,
    )
    q = _PINHOLE_FOCAL * v[:, :2] / v[:, 2:]
    lines = "\n".join(f"{x!r} {y!r}" for x, y in q.tolist())
    said = _run([_REPROJECT, pinhole.name, model.name], model.parent, f"# x y\n{lines}\n")
    rows = [line.split() for line in said.splitlines() if not line.startswith("#")]
    return np.array(rows, dtype=np.float64)


def projected(model: Path, p: Vectors3) -> Pixels:
    """Return images of points of the frame of the reference, mm, by the Python module of mrcal."""
    said = module_run(_PROJECT, [model], json.dumps((p / _MM_IN_M).tolist()))
    return np.array(json.loads(said), dtype=np.float64)


def module_run(script: str, files: Sequence[Path], stdin: str = "") -> str:
    """Run a script with the interpreter of the programs of mrcal, and return its output.

    Raises
    ------
    DeviceError
        It failed.
    """
    first = Path(_path(_REPROJECT)).read_text(encoding="utf-8").splitlines()[0]
    interpreter = first.removeprefix("#!").split()
    return _run([*interpreter, "-c", script, *map(str, files)], files[0].parent, stdin)


def _path(program: str) -> str:
    found = shutil.which(program)
    if found is None:
        raise DeviceError(f"{program} is not installed. On Debian: apt-get install mrcal python3-mrcal.")
    return found


def _run(words: list[str], folder: Path, stdin: str = "") -> str:
    """Run a program and return its output."""
    try:
        done = subprocess.run(  # noqa: S603 -- a program of mrcal, with words made here
            bound_to_this_process([_path(words[0]), *words[1:]]),
            cwd=folder, input=stdin, capture_output=True, text=True, timeout=_SECONDS, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired as error:
        raise DeviceError(f"{words[0]} takes more than {_SECONDS} s.") from error
    if done.returncode != 0:
        raise DeviceError(f"{words[0]} failed: {done.stderr[-500:] or done.stdout[-500:]}")
    return done.stdout
