"""Names of keys under which people's programs keep OpenCV's matrices, and which keys of a file are meant.

OpenCV's functions take matrices and leave it to their users to name them in a file; these are the names of
its own programs, old and new, and the most usual ones of others. Capitals, blanks, underscores, points and
hyphens do not distinguish names of three letters or more.
"""

import re
from collections.abc import Collection, Iterable, Sequence
from functools import lru_cache

MATRIX = (
    "camera_matrix", "cam_matrix", "camera_mat", "cam_mat", "intrinsic_matrix", "intrinsics_matrix",
    "intrinsic_mat", "intrinsics", "intrinsic", "camera_intrinsics", "camera_mtx", "cam_mtx", "mtx", "CM",
    "K", "M",
)  # fmt: skip
DIST = (
    "distortion_coefficients", "distortion_coefficient", "dist_coefficients", "distortion_coeffs",
    "distortion_coeff", "dist_coeffs", "dist_coeff", "distortion_coefs", "distortion_coef", "dist_coefs",
    "dist_coef", "distortion_vector", "distortion_parameters", "distortion_params", "dist_params",
    "camera_distortion", "distortions", "distortion", "dist", "D",
)  # fmt: skip
XI = ("xi",)
"""Of the unified lens of cv2.omnidir, beside its camera matrix and coefficients."""
WIDTH = ("image_width", "img_width", "frame_width", "picture_width", "width")
HEIGHT = ("image_height", "img_height", "frame_height", "picture_height", "height")
SIZE = (
    "image_size",
    "img_size",
    "frame_size",
    "picture_size",
    "resolution",
    "image_resolution",
    "camera_resolution",
    "size",
    "DIM",
)
SIDES = (
    ("1", "2"), ("L", "R"), ("left", "right"), ("l", "r"), ("0", "1"), ("left_", "right_"), ("l_", "r_"),
    ("LEFT.", "RIGHT."), ("cam0_", "cam1_"), ("cam1_", "cam2_"), ("camera0_", "camera1_"),
    ("camera1_", "camera2_"), ("cam_0_", "cam_1_"), ("cam_1_", "cam_2_"), ("camera_0_", "camera_1_"),
    ("camera_1_", "camera_2_"), ("cam_left_", "cam_right_"),
    ("camera_left_", "camera_right_"), ("cameraL_", "cameraR_"), ("_l", "_r"), ("_L", "_R"), ("_1", "_2"),
    ("_0", "_1"), ("_left", "_right"),
)  # fmt: skip
"""Endings of these names, or beginnings, for the first and the second camera of a pair."""
_BEGINS = ("_", ".")
"""The last letter of what stands before a name."""
_LEAST = 3
"""Letters of a name that is recognised by its letters and digits alone: k1 is a coefficient, K1 a matrix."""


@lru_cache(maxsize=10_000)
def plain(key: str) -> str:
    """Return a name's letters, as small ones, and digits."""
    return re.sub(r"[^a-z0-9]", "", key.lower())


def side_keys(keys: Sequence[str], side: str) -> tuple[str, ...]:
    """Return the keys of one camera of a pair; of a camera alone, whose `side` is empty, as they are."""
    if not side:
        return tuple(keys)
    if side.endswith(_BEGINS):
        return tuple(f"{side}{key}" for key in keys)
    # An ending of one small letter is told from the name by an underscore.
    return tuple(f"{key}{side}" for key in keys if not (len(key) == 1 and side in {"l", "r"}))


@lru_cache(maxsize=2_000)
def _plainly(keys: tuple[str, ...]) -> frozenset[str]:
    return frozenset(one for one in map(plain, keys) if len(one) >= _LEAST)


def named_so(keys: Sequence[str], there: Iterable[str]) -> list[str]:
    """Return which of the keys that are `there` are one of `keys`, those of exactly that name first."""
    content: Collection[str] = list(there)
    exact = [key for key in keys if key in content]
    plainly = _plainly(tuple(keys))
    return exact + [key for key in content if key not in exact and plain(key) in plainly]
