"""Content of MAT-files that is neither ``stereoParameters`` nor ``cameraParameters``, and what to do."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from labcal.cameras.interop.mat_file import Value
from labcal.cameras.interop.opencv_names import DIST, MATRIX, SIDES, named_so, side_keys
from labcal.errors import InputError

_OF_A_FISHEYE = ("MappingCoefficients", "StretchMatrix")
_OF_A_MATRIX = 9
_SIDES = ("", *(side for sides in SIDES for side in sides))


def require_held(variables: Mapping[str, Value], path: Path) -> None:
    """Raise where a file holds a lens that labcal does not have, or matrices without a struct.

    Parameters
    ----------
    variables : mapping
        Of the file, or fields of a struct in it.
    path : Path
        For messages.

    Raises
    ------
    InputError
        It does; the message says what to do instead.
    """
    if _has_fisheye(variables):
        raise InputError(
            f"{path} holds a fisheye of MATLAB (fisheyeParameters, {' and '.join(_OF_A_FISHEYE)} after "
            "Scaramuzza), a lens that labcal does not have, so that no other way of saving it helps. "
            "Calibrate the same pictures with labcal (`lens='fisheye-kb4'`) or with cv2.fisheye."
        )
    structs = [(name, one) for name, one in variables.items() if isinstance(one, Mapping)]
    for name, one in (("", variables), *structs):
        _require_no_matrices(name, one, path)


def _has_fisheye(variables: Mapping[str, Value]) -> bool:
    """Tell whether there are fields of a fisheye, or a struct has them."""
    inside = any(_has_fisheye(one) for one in variables.values() if isinstance(one, Mapping))
    return inside or any(field in variables for field in _OF_A_FISHEYE)


def _require_no_matrices(name: str, variables: Mapping[str, Value], path: Path) -> None:
    """Raise where variables, or fields of the struct of a name, are matrices as OpenCV has them."""
    arrays = {key: one for key, one in variables.items() if isinstance(one, np.ndarray)}
    matrices = [key for key in _named(MATRIX, list(arrays)) if arrays[key].size == _OF_A_MATRIX]
    if matrices and _named(DIST, list(arrays)):
        load = f"scipy.io.loadmat('{path.name}'"
        load += f", simplify_cells=True)['{name}']" if name else ")"
        raise InputError(
            f"{path} holds matrices without a struct of MATLAB's ({', '.join(arrays)[:200]}), and does not "
            "state whether their pixels count from 0, as OpenCV's do, or from 1, and whether rotations are "
            "transposed, as MATLAB's are. If all is as in OpenCV, save them for NumPy and convert that, in "
            f"Python: numpy.savez('rig.npz', **{load}). Otherwise save stereoParams or cameraParams as a "
            "struct (toStruct)."
        )


def _named(names: tuple[str, ...], keys: list[str]) -> list[str]:
    """Return the keys that are names of matrices of one camera or of either one of a pair."""
    return named_so([key for side in _SIDES for key in side_keys(names, side)], keys)
