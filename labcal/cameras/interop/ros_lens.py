"""Distortion models of ROS, and the one that the coefficients of a camera_info are of."""

from collections.abc import Sequence
from pathlib import Path

from labcal.cameras.interop.exchange import ReadOptions
from labcal.cameras.interop.lens_parameters import FISHEYE_COEFFICIENTS, fisheye_lens, perspective_lens
from labcal.cameras.interop.opencv_lens import BROWN, given_fisheye
from labcal.cameras.lens import FISHEYE
from labcal.errors import InputError

COUNTS = (0, 4, 5, 8, 12, 14)
"""OpenCV undistorts with whatever stands in the file, whichever of both perspective models is beside it."""
_NONE, _PERSPECTIVE, _FISHEYE = "none", "plumb_bob", "equidistant"
NO_MODEL = ("", _NONE, None)
LENSES = {
    _PERSPECTIVE: (perspective_lens, COUNTS),
    "rational_polynomial": (perspective_lens, COUNTS),
    _FISHEYE: (fisheye_lens, (FISHEYE_COEFFICIENTS,)),
    "fisheye": (fisheye_lens, (FISHEYE_COEFFICIENTS,)),
}


def model_of(stated: object, coefficients: Sequence[float], given: ReadOptions, path: Path) -> str:
    """Return the distortion model of a camera: as its file states, as is given, or by its coefficients.

    Parameters
    ----------
    stated : object
        The model that the file states; one of `NO_MODEL` for none.
    coefficients : sequence of float
        Of a file that states no model.
    given : ReadOptions
    path : Path
        The file, for messages.

    Returns
    -------
    str
        A key of `LENSES`.

    Raises
    ------
    InputError
        Nothing determines the model, it has no counterpart, or a lens is given although the file states it.
    """
    undecided = stated in NO_MODEL and stated != _NONE and len(coefficients) == FISHEYE_COEFFICIENTS
    if given.lens is not None and undecided:
        return _FISHEYE if given_fisheye(given) else _PERSPECTIVE
    if given.lens is not None:
        raise InputError(
            "`lens` does not apply to files of the format 'ros' that state it themselves, or have not four "
            f"coefficients, as {path}. Leave it out."
        )
    if stated not in NO_MODEL:
        if isinstance(stated, str) and stated in LENSES:
            return stated
        raise InputError(
            f"{path}: the distortion model {stated!r:.40} has no counterpart here; {', '.join(LENSES)} have."
        )
    if not any(coefficients):
        return _PERSPECTIVE  # of a rectified or simulated camera
    if stated == _NONE:
        raise InputError(
            f"{path} states the distortion model '{_NONE}', but has coefficients that are not 0. State the "
            f"model that they are of: {', '.join(LENSES)}."
        )
    if undecided:
        raise InputError(
            f"{path} has four coefficients and no distortion_model. Add it, {_PERSPECTIVE} for k1 k2 p1 p2 "
            f"of Brown's model or {_FISHEYE} for k1 to k4 of the fisheye's; or give the lens: "
            f"`lens='{BROWN}'` or `lens='{FISHEYE}'`."
        )
    return _PERSPECTIVE  # of a file from before ROS Diamondback
