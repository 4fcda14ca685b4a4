"""Lenses as lists of OpenCV's coefficients, which most formats share; others are refused by name."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.cameras.interop.numbers_text import finite_numbers
from labcal.cameras.lens import FISHEYE as FISHEYE_LENS
from labcal.cameras.lens import LENGTH, LENSES, lens_by_name
from labcal.cameras.opencv_model import FISHEYE, PERSPECTIVE, OpenCVModel, to_order
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError

PINHOLE = "pinhole"
UNDISTORTED = "none"
"""The distortion model of a camera without distortion, in files of programs for robots."""
FISHEYE_COEFFICIENTS = 4


def perspective_lens(coefficients: Sequence[float]) -> tuple[str, tuple[float, ...]]:
    """Return the simplest lens that holds OpenCV's coefficients, and its `dist`.

    Parameters
    ----------
    coefficients : sequence of float
        k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y, as many as there are. Zeros at the end mean nothing,
        since a lens without them images alike.
    """
    k1, k2, p1, p2, *_ = padded = (*coefficients, *(0.0,) * LENGTH)
    used = max((at + 1 for at, value in enumerate(coefficients) if value != 0.0), default=0)
    if used == 0:
        return PINHOLE, (0.0,) * LENGTH
    if p1 == 0.0 and p2 == 0.0 and used <= LENSES["brown-k1k2"].coefficients:
        return "brown-k1k2", (k1, k2, 0.0, 0.0, 0.0)
    for name in ("brown5", "rational8", "thin-prism12", "tilted14"):
        length = LENSES[name].coefficients
        if used <= length:
            return name, (*padded, *(0.0,) * length)[:length]
    raise InputError(f"A lens with {used} coefficients is not known; OpenCV has at most 14.")


def fisheye_lens(coefficients: Sequence[float]) -> tuple[str, tuple[float, ...]]:
    """Return the fisheye with k1 to k4, and its `dist`, padded with zeros."""
    return FISHEYE_LENS, (*coefficients, *(0.0,) * LENGTH)[:LENGTH]


def named_lens(lens: str, coefficients: Sequence[float]) -> tuple[str, tuple[float, ...]]:
    """Return a lens by labcal's name for it, and its `dist`, padded with zeros."""
    return lens, (*coefficients, *(0.0,) * LENGTH)[: max(LENGTH, len(coefficients))]


def coefficients_of(model: object, values: object, count: int, what: str, source: Path) -> tuple[float, ...]:
    """Return the coefficients of a distortion model of a file; with the model ``none``, zeros are none.

    Parameters
    ----------
    model : object
        As the file states it.
    values : object
        What the file holds for coefficients.
    count : int
        How many the model has.
    what : str
        Their key, for messages.
    source : Path
        The file, for messages.

    Raises
    ------
    InputError
        They are not as many, or no finite numbers; or the model is ``none``, and one is not zero.
    """
    if model != UNDISTORTED or not isinstance(values, list):
        return finite_numbers(values, (count,), what, source)
    if any(finite_numbers(values, (len(values),), what, source)):
        raise InputError(
            f"{source} states the distortion model '{UNDISTORTED}', but {what} are not all 0. State the "
            "model that they are of, or set them to 0."
        )
    return ()


def opencv_model(name: str, record: CameraRecord, holder: str) -> OpenCVModel:
    """Return the model of OpenCV that a camera's lens is.

    Parameters
    ----------
    name : str
        The camera's, for messages.
    record : CameraRecord
    holder : str
        The format as messages name it.

    Raises
    ------
    InputError
        The lens is none of OpenCV's, or the camera has what only labcal can hold: a lens prescription, or a
        window in front of the lens.
    """
    refuse_what_only_labcal_holds(name, record, holder)
    model = lens_by_name(record.lens).opencv
    if model is None:
        raise InputError(
            f"{holder} cannot hold the lens '{record.lens}' of camera '{name}': {_why(record.lens)}. "
            f"Calibrate with one of the lens models {_written_lenses()}, or keep rig.json."
        )
    return model


def _why(lens: str) -> str:
    """Return what keeps a lens from files that have OpenCV's lenses."""
    if lens_by_name(lens).parallel:
        return "its rays are parallel"
    return "its coefficients are none of OpenCV's"


def refuse_what_only_labcal_holds(name: str, record: CameraRecord, holder: str) -> None:
    """Raise where a camera has a lens prescription, or a window in front of the lens.

    Raises
    ------
    InputError
        It has; `holder` is the format as messages name it.
    """
    for what, has_it in (("lens prescription", record.prescription), ("window", record.window)):
        if has_it is not None:
            raise InputError(
                f"{holder} cannot hold the {what} of camera '{name}'. Calibrate with one of the lens models "
                f"{_written_lenses()}, or keep rig.json."
            )


def fisheye_coefficients(record: CameraRecord) -> tuple[float, ...]:
    """Return k1 to k4 of a lens that is OpenCV's fisheye."""
    return (*_in_order(record, FISHEYE), *(0.0,) * FISHEYE_COEFFICIENTS)[:FISHEYE_COEFFICIENTS]


def held_coefficients(name: str, record: CameraRecord, most: int, holder: str) -> tuple[float, ...]:
    """Return the coefficients of OpenCV's perspective model, exactly `most` of them, for a format.

    Parameters
    ----------
    name : str
        The camera's, for messages.
    record : CameraRecord
    most : int
        How many coefficients the format holds, in OpenCV's order.
    holder : str
        The format as messages name it.

    Raises
    ------
    InputError
        The format cannot hold the camera; the message states what, and what to do instead.
    """
    if opencv_model(name, record, holder) is not PERSPECTIVE:
        raise InputError(
            f"{holder} has no lens like '{record.lens}' of camera '{name}'. Choose a format that has it "
            "(opencv, kalibr, ros, colmap), or calibrate with a perspective lens model."
        )
    held = _in_order(record, PERSPECTIVE)
    surplus = [f"{value:g}" for value in held[most:] if value != 0.0]
    if surplus:
        raise InputError(
            f"{holder} holds {most} coefficients of a lens, but '{record.lens}' of camera '{name}' has more "
            f"({', '.join(surplus)}). Calibrate with a simpler lens model, or choose another format."
        )
    return (*held, *(0.0,) * most)[:most]


def coefficient_count(record: CameraRecord) -> int:
    """Return up to which of OpenCV's coefficients the lens of a camera has any."""
    model = lens_by_name(record.lens).opencv
    return 0 if model is None else len(_in_order(record, model))


def _in_order(record: CameraRecord, model: OpenCVModel) -> tuple[float, ...]:
    return to_order(model, lens_by_name(record.lens).names, record.dist)


def _written_lenses() -> str:
    """Return the names of the lens models that OpenCV has, for a message."""
    return ", ".join(name for name, lens in LENSES.items() if lens.opencv is not None)


def camera_record(
    numbers: Sequence[float],
    lens: tuple[str, tuple[float, ...]],
    T_cam_world: Pose,
    size: tuple[int, int],
    source: Path,
) -> CameraRecord:
    """Return a camera that was read, checked.

    Parameters
    ----------
    numbers : sequence of float
        fx, fy, cx, cy in px; pixel (0, 0) is the centre of the top-left pixel.
    lens : (str, tuple of float)
        Its name and `dist`.
    T_cam_world : ndarray, shape (4, 4)
        Mm.
    size : (int, int)
        Width and height, px.
    source : Path
        The file, for messages.

    Raises
    ------
    InputError
        There is no such camera.
    """
    fx, fy, cx, cy = numbers
    K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    name, dist = lens
    try:
        return CameraRecord.of(Camera(K, name, np.array(dist), T_cam_world, size))
    except InputError as error:
        raise InputError(f"{source}: {error}") from error


def intrinsics_of(matrix: Sequence[float], source: Path) -> tuple[float, float, float, float]:
    """Return fx, fy, cx, cy of a camera matrix, row by row.

    Raises
    ------
    InputError
        It has skew, or is no camera matrix.
    """
    fx, skew, cx, zero, fy, cy, *last = matrix
    if cx == skew == cy == zero == 0.0 and last[2] == 1.0 and any(last[:2]):
        raise InputError(
            f"{source}: the camera matrix is transposed, [fx 0 0; 0 fy 0; cx cy 1], as MATLAB and programs "
            "after it write it. Their rotations are transposed, too: transpose all of them."
        )
    if skew != 0.0:
        raise InputError(
            f"{source}: the camera matrix has a skew of {skew:g}, which labcal's cameras do not have. "
            "Calibrate without skew."
        )
    if zero != 0.0 or list(last) != [0.0, 0.0, 1.0]:
        raise InputError(f"{source}: the camera matrix is not [fx 0 cx; 0 fy cy; 0 0 1].")
    return (fx, fy, cx, cy)
