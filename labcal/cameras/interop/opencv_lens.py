"""The lens that the coefficients in a file of OpenCV are of, by what the file states and a user gives."""

from labcal.cameras.interop.exchange import ReadOptions
from labcal.cameras.interop.lens_parameters import (
    FISHEYE_COEFFICIENTS,
    fisheye_lens,
    named_lens,
    perspective_lens,
)
from labcal.cameras.interop.numbers_text import finite_number
from labcal.cameras.interop.opencv_names import XI, side_keys
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.lens import FISHEYE, OMNIDIRECTIONAL
from labcal.errors import InputError

_KIND = ("distortion_model", "distortion_type", "camera_model", "camera_type", "model_type", "lens_model",
         "lens_type", "model")  # fmt: skip
_FISHEYE_WORDS = {"fisheye", "equidistant", "kannala_brandt", "kannala-brandt", "kb4"}
_PERSPECTIVE_WORDS = {"plumb_bob", "radtan", "brown", "rational_polynomial", "perspective", "pinhole"}
_OTHER_WORDS = {
    "omni", "omnidir", "omnidirectional", "mei", "unified", "ucm", "eucm", "ds", "double_sphere",
    "double-sphere", "fov", "atan", "ocam", "scaramuzza", "division", "thin_prism_fisheye",
}  # fmt: skip
"""Lenses that no coefficients of OpenCV state."""
_AMBIGUOUS = 4
BROWN = "brown5"
"""The lens model by which a user states that coefficients are those of cv2.calibrateCamera."""


def lens_of(
    storage: Storage, side: str, coefficients: tuple[float, ...], given: ReadOptions
) -> tuple[str, tuple[float, ...]]:
    """Return the lens: as the file states, else as given, else by the number of coefficients.

    Parameters
    ----------
    storage : Storage
    side : str
        What the camera's keys end in, or begin with.
    coefficients : tuple of float
        As many as OpenCV takes.
    given : ReadOptions

    Raises
    ------
    InputError
        Nothing determines the lens, or two statements contradict each other.
    """
    path = storage.path
    xi = side_keys(XI, side)
    if storage.first(xi) is not None or storage.first(XI) is not None:
        return _unified(storage, xi if storage.first(xi) is not None else XI, coefficients, given)
    stated, wanted = _stated_fisheye(storage, side), given_fisheye(given)
    if stated is not None and wanted is not None and stated != wanted:
        raise InputError(
            f"{path} states that its lens is {'a' if stated else 'no'} fisheye, but `lens='{given.lens}'` "
            "states otherwise. Leave that out."
        )
    fisheye = wanted if stated is None else stated
    if fisheye is None and len(coefficients) == _AMBIGUOUS:
        raise InputError(
            f"{path} has four coefficients, which are k1 k2 p1 p2 of Brown's model (cv2.calibrateCamera) or "
            "k1 to k4 of the fisheye's (cv2.fisheye.calibrate), and does not state which. Give it: "
            f"`lens='brown5'` or `lens='{FISHEYE}'`."
        )
    if not fisheye:
        return perspective_lens(coefficients)
    if len(coefficients) != FISHEYE_COEFFICIENTS:
        raise InputError(f"{path}: a fisheye has 4 coefficients, but there are {len(coefficients)}.")
    return fisheye_lens(coefficients)


def _unified(
    storage: Storage, keys: tuple[str, ...], coefficients: tuple[float, ...], given: ReadOptions
) -> tuple[str, tuple[float, ...]]:
    """Return the unified lens of cv2.omnidir: xi, and k1 k2 p1 p2 behind it."""
    if given.lens not in (None, OMNIDIRECTIONAL):
        raise InputError(
            f"{storage.path} has xi, as a lens of cv2.omnidir ({OMNIDIRECTIONAL}) has, but "
            f"`lens='{given.lens}'` states otherwise. Leave that out."
        )
    if len(coefficients) not in (0, _AMBIGUOUS):
        raise InputError(
            f"{storage.path} has xi, as a lens of cv2.omnidir has, and {len(coefficients)} coefficients, but "
            "that lens has 4."
        )
    (xi,) = storage.matrix(keys, (1,))
    return named_lens(OMNIDIRECTIONAL, (xi, *coefficients))


def _stated_fisheye(storage: Storage, side: str) -> bool | None:
    """Return whether a file states that its lens is a fisheye; None if it does not."""
    flag = storage.first((*side_keys(("fisheye_model", "fisheye"), side), "fisheye_model", "fisheye"))
    if isinstance(flag, bool):
        return flag
    if flag is not None:
        return finite_number(flag, "fisheye_model", storage.path) != 0.0
    found = storage.there((*side_keys(_KIND, side), *_KIND))
    words = {str(storage.content[key]).lower() for key in found}
    if words & _OTHER_WORDS:
        raise InputError(
            f"{storage.path} states the lens '{min(words & _OTHER_WORDS)}', whose coefficients are none of "
            "cv2.calibrateCamera and cv2.fisheye. Give the file of the program that calibrated it."
        )
    if words & _FISHEYE_WORDS:
        return True
    return False if words & _PERSPECTIVE_WORDS else None


def given_fisheye(given: ReadOptions) -> bool | None:
    """Return whether the lens that was named is the fisheye; None where none was."""
    if given.lens not in (None, BROWN, FISHEYE):
        raise InputError(
            f"`lens='{given.lens}'` does not determine whose coefficients these are. Give {BROWN}, for those "
            f"of cv2.calibrateCamera, or {FISHEYE}."
        )
    return None if given.lens is None else given.lens == FISHEYE
