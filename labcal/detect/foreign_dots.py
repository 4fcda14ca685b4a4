"""Check of what a user's detector returns, before it enters tables and calibrations."""

import numpy as np

from labcal.bounds import LEAST_VARIANCE_PX2, MARGIN_SIDES
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.errors import InputError
from labcal.targets.grid import Polarity
from labcal.targets.target import Target

_ARRAYS = {
    "index": ((2,), np.integer),
    "has_id": ((), np.bool_),
    "position": ((2,), np.float64),
    "covariance": ((2, 2), np.float64),
    "misfit": ((), np.float64),
    "seen_at": ((2,), np.float64),
    "outline": ((2, 2), np.float64),
}
"""Shape of each dot's entry, and the kind of number."""


def require_detections(what: str, found: object, target: Target, size: tuple[int, int]) -> None:
    """Raise unless the result of a user's detector is what every stage after it takes for granted.

    Parameters
    ----------
    what : str
        The detector, for messages.
    found : object
        What it returned.
    target : Target
        That was looked for.
    size : (int, int)
        Width and height of the picture, px.

    Raises
    ------
    InputError
        It is no `PictureDots` of this picture, an array is of another shape or type, or a dot that is ``ok``
        has no place in the target, is there twice, or has no sound position and covariance.
    """
    if not isinstance(found, PictureDots):
        raise InputError(f"{what} should return PictureDots, not {type(found).__name__}.")
    faults = _faults_of_form(found, size) or _faults_of_dots(found, target)
    if faults:
        raise InputError(f"{what} returns PictureDots whose {faults[0]}.")


def _faults_of_form(found: PictureDots, size: tuple[int, int]) -> list[str]:
    """Return what is not of the form of detections of this picture."""
    faults = []
    if found.size != size:
        faults.append(f"size is {found.size!r:.40}, but the picture's is {size}")
    if not isinstance(found.polarity, Polarity):
        faults.append(f"polarity is {found.polarity!r:.40}, but should be a Polarity")
    if not (found.refusal is None or isinstance(found.refusal, Refusal)):
        faults.append(f"refusal is {found.refusal!r:.40}, but should be None or a Refusal")
    if not (isinstance(found.flag, tuple) and all(isinstance(one, DotFlag) for one in found.flag)):
        return [*faults, "flag should be a tuple of DotFlag"]
    if not isinstance(found.others, tuple):
        return [*faults, "others should be a tuple of arrays as index is one"]
    n = len(found.flag)
    named = [(name, getattr(found, name), *form) for name, form in _ARRAYS.items()]
    named += [("others", other, *_ARRAYS["index"]) for other in found.others]
    for name, array, shape, number in named:
        fits = isinstance(array, np.ndarray) and array.shape == (n, *shape)
        if not (fits and np.issubdtype(array.dtype, number)):
            faults.append(
                f"{name} should be an array of {number.__name__} and of shape {(n, *shape)}, as there are "
                f"{n} flags"
            )
    return faults


def _faults_of_dots(found: PictureDots, target: Target) -> list[str]:
    """Return what no measured dot can be."""
    ok, faults = found.ok, []
    if found.refusal is not None and ok.any():
        faults.append("refusal is given, though dots are ok")
    if not found.has_id[ok].all():
        faults.append("has_id is false of a dot that is ok")
    index = found.index[ok]
    known = {(int(col), int(row)) for col, row in target.indices()}
    if not all((int(col), int(row)) in known for col, row in index):
        faults.append("index of a dot that is ok is none of the target's places")
    if len(np.unique(found.index[found.has_id], axis=0)) < int(found.has_id.sum()):
        faults.append("index names a place twice")
    position, limit = found.position[ok], np.array(found.size, dtype=np.float64)
    if not ((position >= -MARGIN_SIDES * limit) & (position <= (1.0 + MARGIN_SIDES) * limit)).all():
        faults.append("position of a dot that is ok is not near the picture")
    if not _are_covariances(found.covariance[ok], float((limit**2).sum())):
        faults.append(
            "covariance of a dot that is ok is none: it should be symmetric and positive definite, px squared"
        )
    return faults


def _are_covariances(covariance: np.ndarray, most: float) -> bool:
    """Tell whether all matrices (n, 2, 2) are symmetric, positive definite, and of possible size."""
    xx, xy, yx, yy = covariance.reshape(-1, 4).T
    least, largest = np.minimum(xx, yy), np.maximum(xx, yy)
    return bool(((xy == yx) & (least >= LEAST_VARIANCE_PX2) & (largest <= most) & (xy * xy < xx * yy)).all())
