"""A small render in a process of its own, which tests whether Mitsuba works on this machine.

An LLVM library that does not fit ends the process without an error that Python could catch, so the question
cannot be put within the caller's process.
"""

import subprocess
import sys

import numpy as np

from labcal.errors import DeviceError
from labcal.render.llvm import ensure_llvm, install_advice
from labcal.run.bound_program import bound_to_this_process

_SECONDS = 300.0
_SIDE = 8


def try_render() -> str:
    """Render a few pixels in a subprocess, and return the version of Mitsuba and the LLVM library.

    Raises
    ------
    DeviceError
        It does not work; the message says what to install.
    """
    ensure_llvm()
    command = bound_to_this_process([sys.executable, "-m", "labcal.render.trial"])
    try:
        # The command is this module in this interpreter; nothing of it comes from outside.
        done = subprocess.run(  # noqa: S603
            command, capture_output=True, text=True, timeout=_SECONDS, check=False, stdin=subprocess.DEVNULL
        )
    except subprocess.TimeoutExpired as error:
        raise DeviceError(
            f"A trial picture of {_SIDE} x {_SIDE} pixels took more than {_SECONDS:g} s."
        ) from error
    if done.returncode != 0:
        said = done.stderr.strip().splitlines() or ["there was no message"]
        # A library that aborts tells the reason first, Python tells it last.
        reason = said[0] if done.returncode < 0 else said[-1]
        raise DeviceError(
            f"A trial picture failed (exit status {done.returncode}: {reason[:200]}). {_advice(reason)}"
        )
    return done.stdout.strip().splitlines()[-1]


def _advice(reason: str) -> str:
    """Return advice for a trial picture that failed."""
    if "libatomic" in reason:
        return "Install libatomic, which Dr.Jit needs (libatomic1 on Debian and Ubuntu)."
    if "No module named" in reason:
        return "Reinstall labcal together with mitsuba and drjit."
    return install_advice()


def _render_here() -> str:
    """Render a grey sphere under a white sky and check its grey."""
    library = ensure_llvm()
    import mitsuba as mi  # noqa: PLC0415 - after Dr.Jit's library is chosen

    mi.set_variant("llvm_ad_mono")
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 2},
            "sphere": {"type": "sphere", "bsdf": {"type": "diffuse", "reflectance": 0.5}},
            "sky": {"type": "constant", "radiance": 1.0},
            "sensor": {
                "type": "perspective",
                "fov": 30,
                "to_world": mi.ScalarTransform4f().look_at([0, 0, 6], [0, 0, 0], [0, 1, 0]),
                "film": {
                    "type": "hdrfilm",
                    "width": _SIDE,
                    "height": _SIDE,
                    "pixel_format": "luminance",
                    "rfilter": {"type": "box"},
                },
            },
        }
    )
    picture = np.asarray(mi.render(scene, spp=64), dtype=np.float64)[..., 0]
    sky, sphere = float(picture[0, 0]), float(picture[_SIDE // 2, _SIDE // 2])
    # A convex white-lit Lambertian body of albedo 0.5 looks 0.5; the limits are wide for 64 samples.
    if not (abs(sky - 1.0) < 0.01 and abs(sphere - 0.5) < 0.1):  # noqa: PLR2004 - explained above
        raise DeviceError(
            f"A trial picture shows a sky of {sky:g} and a sphere of {sphere:g}, not 1 and 0.5."
        )
    return f"Mitsuba {mi.__version__} with {library.name}"


if __name__ == "__main__":
    sys.stdout.write(_render_here() + "\n")
