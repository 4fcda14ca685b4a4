"""Names for the array shapes that cross module borders, and the arrays of what users give.

Inside, shapes are annotations that are checked while testing (jaxtyping, beartype). A public function takes
anything that NumPy does, and turns it into an array by a function of this file. Arrays are float64; missing
values are NaN. Leading dimensions run view, camera, dot.
"""

from types import EllipsisType
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float64, Int
from numpy.typing import ArrayLike

from labcal.errors import InputError, InputTypeError

Pixels = Float64[np.ndarray, "*batch 2"]
"""Pixel positions q, (0, 0) at the centre of the top-left pixel."""

Outlines = Float64[np.ndarray, "*batch samples 2"]
"""Closed curves in a picture, one an element, as pixel positions along them."""

Vectors3 = Float64[np.ndarray, "*batch 3"]
"""Points p, in millimetres, or unit directions v."""

Mask = Bool[np.ndarray, "*batch"]
"""One flag an element."""

Pose = Float64[np.ndarray, "4 4"]
"""A rigid transform ``T_ab``: coordinates in b to coordinates in a, millimetres."""

Matrix3 = Float64[np.ndarray, "3 3"]
"""A rotation or a camera matrix."""

DotIndices = Int[np.ndarray, "n 2"]
"""(col, row) of dots."""

Lengths = Float64[np.ndarray, "*batch"]
"""One length an element, in millimetres."""

PixelCovariances = Float64[np.ndarray, "*batch 2 2"]
"""Covariances of pixel positions, in px squared."""

PointCovariances = Float64[np.ndarray, "*batch 3 3"]
"""Covariances of points, in mm squared."""

PointJacobians = Float64[np.ndarray, "*batch 2 3"]
"""Derivatives of a pixel position by a point, in px/mm."""

if TYPE_CHECKING:
    AnyArray = ArrayLike
else:
    AnyArray = object
"""Anything that NumPy makes an array of. The checker of the tests would refuse whole numbers in sequences."""

Shape = tuple[int | str | EllipsisType, ...]
"""A shape that is expected: lengths, names of lengths that are free, and ``...`` for any leading ones."""


def float_array(given: AnyArray, shape: Shape, name: str) -> np.ndarray:
    """Return what was given as a float64 array of a shape; masked elements become NaN.

    Parameters
    ----------
    given : array_like
        Numbers: nested sequences, an array of any numeric type, a table of pandas.
    shape : tuple
        What is expected, such as ``(..., 2)`` or ``("n", 3)``; lengths of one name are equal.
    name : str
        Of the argument, for messages.

    Returns
    -------
    ndarray
        The array itself where it is float64 already, else a copy.

    Raises
    ------
    InputTypeError
        It holds something that is no real number.
    InputError
        It is ragged, or has another shape.

    Examples
    --------
    >>> float_array([[1, 2], [3, 4]], ("n", 2), "q")
    array([[1., 2.],
           [3., 4.]])
    """
    if isinstance(given, np.ma.MaskedArray) and given.dtype.kind in "fiubO":
        given = np.ma.filled(np.ma.asarray(given, dtype=np.float64), np.nan)
    array = _checked(given, shape, name, "fiub", "real numbers")
    return array if array.dtype == np.float64 else array.astype(np.float64)


def whole_array(given: AnyArray, shape: Shape, name: str) -> np.ndarray:
    """Return what was given as an int64 array of a shape; see :func:`float_array`."""
    array = _checked(given, shape, name, "fiu", "whole numbers")
    if array.dtype == np.int64:
        return array
    with np.errstate(invalid="ignore"):  # of NaN, which no whole number is equal to
        whole = array.astype(np.int64)
    if not np.array_equal(whole, array):
        raise InputError(f"{name} must hold whole numbers, but holds others.")
    return whole


def truth_array(given: AnyArray, shape: Shape, name: str) -> np.ndarray:
    """Return what was given as an array of bool of a shape; see :func:`float_array`."""
    return _checked(given, shape, name, "b", "truth values")


def lines_array(given: AnyArray, n: int, name: str) -> np.ndarray:
    """Return lines that are chosen out of `n`: a truth value for each, or the numbers of some.

    Raises
    ------
    InputError, InputTypeError
        There are more or fewer truth values than lines, a number is of no line, or neither was given.
    """
    if np.asarray(given).dtype == np.bool_:
        return truth_array(given, (n,), name)
    numbers = whole_array(given, ("lines",), name)
    if numbers.size and not (-n <= numbers.min() and numbers.max() < n):
        raise InputError(f"{name} must hold numbers of lines from {-n} to {n - 1}, but holds others.")
    return numbers


def text_array(given: AnyArray, shape: Shape, name: str) -> np.ndarray:
    """Return what was given as an array of str of a shape; see :func:`float_array`."""
    if isinstance(given, np.ndarray) and given.dtype.kind == "U":
        return _checked(given, shape, name, "U", "texts")
    array = _checked(given, shape, name, "UTO", "texts")
    if not all(isinstance(text, str) for text in array.ravel().tolist()):
        raise InputTypeError(f"{name} must hold texts, but holds something else.")
    return array.astype(np.str_)


def kept(array: np.ndarray) -> np.ndarray:
    """Return a copy of an array that cannot be written to, as an object keeps it.

    What is changed in place later, in the array that was given or through the object, would change an object
    that is said to be frozen, and not what it has computed already.

    Examples
    --------
    >>> kept(np.zeros(2)).flags.writeable
    False
    """
    copy = np.array(array)
    copy.setflags(write=False)
    return copy


def _checked(given: AnyArray, shape: Shape, name: str, kinds: str, what: str) -> np.ndarray:
    """Return an array of a shape whose elements are of some kinds; an empty one may be of any."""
    if isinstance(given, np.ma.MaskedArray) and np.ma.getmaskarray(given).any():
        raise InputError(f"{name} must hold {what} throughout, but some elements are masked. Fill them in.")
    try:
        array = np.asarray(given)
    except (TypeError, ValueError, RuntimeError) as error:  # of other libraries, for example PyTorch
        why = "is ragged" if isinstance(error, ValueError) else "is none"
        raise InputError(
            f"{name} must be an array of {what} of shape {_written(shape)}, but {why}: {error}."
        ) from error
    if array.size == 0 and array.dtype.kind not in kinds:
        array = array.astype({"b": np.bool_, "U": np.str_}.get(kinds[0], np.float64))
    if array.dtype.kind not in kinds:
        raise InputTypeError(
            f"{name} must be an array of {what} of shape {_written(shape)}, but what was given is of type "
            f"{type(given).__name__} and holds {array.dtype}."
        )
    if not _fits(array.shape, shape):
        raise InputError(
            f"{name} must have the shape {_written(shape)}, but has the shape {_written(array.shape)}."
        )
    return array


def _fits(found: tuple[int, ...], expected: Shape) -> bool:
    """Tell whether a shape is the expected one."""
    if expected and expected[0] is Ellipsis:
        expected = expected[1:]
        found = found[max(0, len(found) - len(expected)) :]
    lengths: dict[str, int] = {}
    return len(found) == len(expected) and all(
        length == (lengths.setdefault(wanted, length) if isinstance(wanted, str) else wanted)
        for length, wanted in zip(found, expected, strict=True)
    )


def _written(shape: Shape) -> str:
    """Return a shape as NumPy writes it, free lengths by their names."""
    lengths = ", ".join("..." if length is Ellipsis else str(length) for length in shape)
    return f"({lengths},)" if len(shape) == 1 else f"({lengths})"
