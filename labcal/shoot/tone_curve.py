"""Tone curves: delivered values as a function of light, and the inverse."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from jaxtyping import Float, Shaped

from labcal.errors import InputError, UnknownNameError
from labcal.paths import AnyPath, as_text
from labcal.run.decimal_words import decimal
from labcal.run.tables import damaged_line, read_table

HEADER = ("value", "light")
SRGB_KNEE = 0.0031308
REC709_KNEE = 0.018
_LEAST_POINTS = 3
_MOST_POINTS = 2**17
"""Of a measured curve: two for every value of 16 bits."""
_LEAST_STEP = 1e-9
"""Between points of a measured curve, in shares of full scale: far below a step of 16 bits."""


class ToneCurve(StrEnum):
    """A tone curve from linear light to delivered values."""

    LINEAR = "linear"
    SRGB = "srgb"
    """IEC 61966-2-1."""
    REC709 = "rec709"
    """ITU-R BT.709, that of video."""
    GAMMA22 = "gamma-2.2"
    """The power 1 / 2.2."""


@dataclass(frozen=True)
class MeasuredCurve:
    """A measured curve of points from (0, 0) to (1, 1), increasing in both columns; shares of full scale."""

    value: Float[np.ndarray, " n"]
    light: Float[np.ndarray, " n"]


AnyToneCurve = ToneCurve | MeasuredCurve


def tone(linear: Float[np.ndarray, "*shape"], curve: ToneCurve) -> Float[np.ndarray, "*shape"]:
    """Return linear values (0 to 1) after a tone curve, 0 to 1."""
    if curve is ToneCurve.LINEAR:
        return linear
    if curve is ToneCurve.GAMMA22:
        curved: np.ndarray = linear ** (1.0 / 2.2)
        return curved
    if curve is ToneCurve.REC709:
        return np.where(
            linear < REC709_KNEE, 4.5 * linear, 1.099 * np.maximum(linear, REC709_KNEE) ** 0.45 - 0.099
        )
    return np.where(
        linear <= SRGB_KNEE,
        12.92 * linear,
        1.055 * np.maximum(linear, SRGB_KNEE) ** (1.0 / 2.4) - 0.055,
    )


def light(value: Float[np.ndarray, "*shape"], curve: AnyToneCurve) -> Float[np.ndarray, "*shape"]:
    """Return the linear light (0 to 1) of delivered values (0 to 1): the inverse of :func:`tone`.

    Between the points of a measured curve runs a monotone cubic (Fritsch and Carlson 1980).
    """
    if isinstance(curve, MeasuredCurve):
        from scipy.interpolate import PchipInterpolator  # noqa: PLC0415 -- scenes name curves without it

        between: np.ndarray = PchipInterpolator(curve.value, curve.light)(value)
        return between
    if curve is ToneCurve.LINEAR:
        return value
    if curve is ToneCurve.GAMMA22:
        straight: np.ndarray = value**2.2
        return straight
    if curve is ToneCurve.REC709:
        return np.where(value < 4.5 * REC709_KNEE, value / 4.5, ((value + 0.099) / 1.099) ** (1.0 / 0.45))
    return np.where(value <= 12.92 * SRGB_KNEE, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def undone(picture: Shaped[np.ndarray, "*shape"], curve: AnyToneCurve) -> Shaped[np.ndarray, "*shape"]:
    """Return the light of a picture, from 0 to the largest value of its type, float32.

    Parameters
    ----------
    picture : ndarray of any shape
        uint8 or uint16. A picture of other values (EXR) is light already, and is returned as it is; so is
        every picture under a linear curve.
    curve : AnyToneCurve
    """
    if curve is ToneCurve.LINEAR or picture.dtype not in (np.uint8, np.uint16):
        return picture
    top = int(np.iinfo(picture.dtype).max)
    every_value = np.arange(top + 1) / top
    table: np.ndarray = (top * light(every_value, curve)).astype(np.float32)
    shone: np.ndarray = table[picture]
    return shone


def find_tone_curve(given: AnyToneCurve | AnyPath) -> AnyToneCurve:
    """Return the tone curve that is given, by itself, by name, or as a CSV file.

    Parameters
    ----------
    given : ToneCurve, MeasuredCurve, str or path
        The file has the columns `value` and `light`.

    Raises
    ------
    UnknownNameError
        It is neither a name nor a file.
    InputTypeError
        It is no tone curve at all.
    InputError
        The file is damaged, or its columns do not rise from (0, 0) to (1, 1).
    """
    if isinstance(given, MeasuredCurve):
        return given
    text = as_text(given)
    if text.lower() in tuple(ToneCurve):
        return ToneCurve(text.lower())
    path = Path(text)
    if path.suffix.lower() != ".csv":
        raise UnknownNameError("tone curve", text, tuple(ToneCurve))
    rows: list[tuple[float, float]] = []
    for number, line in enumerate(read_table(HEADER, "tone curve", path)):
        try:
            value, shone = (decimal(figure) for figure in line)
        except ValueError as error:
            raise damaged_line(path, number, line, "two numbers are expected") from error
        if len(rows) == _MOST_POINTS:
            raise InputError(f"The tone curve {path} has more than {_MOST_POINTS} points.")
        rows.append((value, shone))
    points = np.array(rows, dtype=np.float64).reshape(-1, 2)
    ends = len(points) >= _LEAST_POINTS and (points[0] == 0.0).all() and (points[-1] == 1.0).all()
    if not ends or not (np.diff(points, axis=0) >= _LEAST_STEP).all():
        raise InputError(
            f"The tone curve {path} should have three points or more, whose columns both rise from "
            "0,0 to 1,1 (shares of full scale)."
        )
    return MeasuredCurve(points[:, 0], points[:, 1])
