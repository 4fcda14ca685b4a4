"""Words on a file that is of no format that is read: what it seems to be, or which keys it has."""

from labcal.cameras.interop.exchange import SourceText
from labcal.cameras.interop.foreign_files import foreign_words
from labcal.cameras.interop.opencv_storage import read_storage
from labcal.cameras.interop.registry import READ
from labcal.errors import InputError

_OF_COLMAP = {"cameras.bin", "images.bin", "rigs.bin", "frames.bin", "points3D.bin"}
_NUMBERS = ("fx", "fy", "cx", "cy")
_MOST_LETTERS = 2**18
"""Of a text whose keys are looked for."""


def words_on_strange(source: SourceText) -> str:
    """Return a message on a file that no format takes for its own.

    Parameters
    ----------
    source : SourceText
    """
    seems = foreign_words(source.text)
    if seems is not None:
        return f"{source.path} is of no format that is read here. {seems}"
    if source.path.name in _OF_COLMAP:
        return (
            f"{source.path} is called as a file of COLMAP's binary model, but is damaged, truncated or a "
            "part of a model whose cameras.bin is. Copy the whole folder again."
        )
    what = "" if source.is_text else "is no text file, and "
    message = f"{source.path} {what}is of no format that is read here ({', '.join(READ)})."
    try:
        small = source.is_text and len(source.text) <= _MOST_LETTERS
        keys = read_storage(source).listed if small else ""
    except InputError:
        keys = ""
    if set(_NUMBERS) <= set(keys.split(", ")):
        return (
            f"{message} It has {', '.join(_NUMBERS)}: write them as a matrix, camera_matrix: [fx, 0, cx, 0, "
            "fy, cy, 0, 0, 1], with distortion_coefficients: [k1, k2, p1, p2, k3]."
        )
    if keys:
        return (
            f"{message} If it holds matrices of OpenCV, name their keys: "
            f"`key='camera_matrix=KEY,distortion_coefficients=KEY'`, or M1 D1 M2 D2 R T of a pair. There are "
            f"{keys}."
        )
    return f"{message} If it should be, name it: `from_format='FORMAT'`."
