"""Predictions as real numbers: what else a method of one's own may give is refused by name."""

from numbers import Real

import numpy as np
from jaxtyping import Float64

from labcal.errors import InputTypeError

_REAL = "fiu"
_NAMES = {
    "b": "truth values",
    "c": "complex numbers",
    "m": "durations",
    "M": "dates",
    "S": "bytes",
    "U": "texts",
    "V": "records",
}
"""Kinds of elements in NumPy's letters, for messages."""


def real_numbers(found: np.ndarray, method: str) -> Float64[np.ndarray, "*shape"]:
    """Return predictions as float64.

    NumPy would convert what is not real, too: complex numbers without their imaginary part, dates to seconds.

    Parameters
    ----------
    found : ndarray
        Of any type. Objects are taken if they are real numbers, or None, which becomes NaN.
    method : str
        For the message.

    Returns
    -------
    float64 array
        The array itself where it is float64 already.

    Raises
    ------
    InputTypeError
        It holds something that is no real number.
    """
    if found.dtype.kind == "O":
        strange = next((one for one in found.flat if not _is_real(one)), None)
        name = None if strange is None else f"an object of type {type(strange).__name__}"
    else:
        name = None if found.dtype.kind in _REAL else _NAMES.get(found.dtype.kind, str(found.dtype))
    if name is not None:
        raise InputTypeError(
            f"{method}: 'predict' gave {name}, but points are real numbers, in mm. Return an array of floats."
        )
    return found.astype(np.float64, copy=False)


def _is_real(value: object) -> bool:
    return value is None or (isinstance(value, Real) and not isinstance(value, bool | np.bool_))
