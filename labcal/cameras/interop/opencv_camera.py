"""One camera of OpenCV's FileStorage: under which keys it stands, and which lens its coefficients are.

OpenCV's functions take matrices and leave it to their users to name them in a file; these are the names of
its own programs, old and new, and the most usual ones of others.
"""

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.exchange import ReadOptions
from labcal.cameras.interop.lens_parameters import (
    FISHEYE_COEFFICIENTS,
    camera_record,
    fisheye_lens,
    intrinsics_of,
    perspective_lens,
)
from labcal.cameras.interop.numbers_text import finite_number, picture_size
from labcal.cameras.interop.opencv_storage import Storage
from labcal.cameras.interop.placement import rounded_pose
from labcal.cameras.lens import FISHEYE
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector

COUNTS = (0, 4, 5, 8, 12, 14)
"""Of coefficients that OpenCV takes."""
MATRIX = (
    "camera_matrix", "cameraMatrix", "Camera_Matrix", "CameraMatrix", "camMatrix", "intrinsic_matrix",
    "intrinsicMatrix", "cam_matrix", "mtx", "K", "M",
)  # fmt: skip
DIST = (
    "distortion_coefficients", "distCoeffs", "dist_coeffs", "Distortion_Coefficients", "DistCoeffs",
    "dist_coeff", "distCoeff", "distortion_coeffs", "distortion_coefficient", "distortion", "dist", "D",
)  # fmt: skip
SIDES = (
    ("1", "2"), ("L", "R"), ("_left", "_right"), ("Left", "Right"), ("_l", "_r"), ("_L", "_R"),
    ("_1", "_2"), ("0", "1"), ("_0", "_1"), ("left_", "right_"), ("Left_", "Right_"), ("LEFT.", "RIGHT."),
    ("l_", "r_"), ("L_", "R_"), ("cam0_", "cam1_"), ("cam1_", "cam2_"),
)  # fmt: skip
"""Endings of these names, or beginnings, for the first and the second camera of a pair."""
_BEGINS = ("_", ".")
"""The last letter of what stands before a name."""
_WIDTH = ("image_width", "image_Width", "imageWidth", "img_width", "width", "Width")
_HEIGHT = ("image_height", "image_Height", "imageHeight", "img_height", "height", "Height")
_SIZE = ("image_size", "imageSize", "img_size", "ImageSize", "size")
_ROTATION = ("R", "rotation_matrix", "rotationMatrix", "Rot", "rot")
_TRANSLATION = ("T", "translation_vector", "translationVector", "Trans", "trans")
_KIND = ("distortion_model", "camera_model", "model_type", "lens_model")
_FISHEYE_WORDS = {"fisheye", "equidistant", "kannala_brandt", "kannala-brandt", "kb4"}
_PERSPECTIVE_WORDS = {"plumb_bob", "radtan", "brown", "rational_polynomial", "perspective", "pinhole"}
_AMBIGUOUS = 4
BROWN = "brown5"
"""The lens model by which a user states that coefficients are those of cv2.calibrateCamera."""


def side_keys(keys: tuple[str, ...], side: str) -> tuple[str, ...]:
    """Return the keys of one camera of a pair."""
    return tuple(f"{side}{key}" if side.endswith(_BEGINS) else f"{key}{side}" for key in keys)


def sides_of(storage: Storage) -> tuple[str, str] | None:
    """Return how a file names the two cameras of a pair; None where it holds none.

    Raises
    ------
    InputError
        There are three, as M1, M2 and M3, or M0, M1 and M2.
    """
    named = {sides: storage.mapped & set(side_keys(MATRIX, sides[0])) for sides in SIDES}
    chosen = next((sides for sides in SIDES if named[sides]), None)
    if chosen is not None:
        return chosen
    there = {sides: [storage.first(side_keys(MATRIX, side)) is not None for side in sides] for sides in SIDES}
    whole = [sides for sides in SIDES if all(there[sides])]
    third = [sides[1].replace("2", "3") for sides in whole if "2" in sides[1]]
    if len(whole) > 1 or any(storage.first(side_keys(MATRIX, side)) is not None for side in third):
        raise InputError(
            f"{storage.path} holds more than two cameras. Name those of a pair: `key='M1=KEY,D1=KEY,M2=KEY,"
            f"D2=KEY,R=KEY,T=KEY'`. Its keys are {', '.join(map(str, storage.content))[:300]}."
        )
    return next(iter(whole), next((sides for sides in SIDES if there[sides][0]), None))


def is_posed(storage: Storage) -> bool:
    """Tell whether a file has R and T."""
    return storage.first(_ROTATION) is not None and storage.first(_TRANSLATION) is not None


def read_pose(storage: Storage) -> tuple[Pose, tuple[str, ...]]:
    """Return the pose of R, a matrix or a rotation vector, and T; with a note if R was rounded."""
    turn, t = np.array(storage.matrix(_ROTATION, (9, 3))), np.array(storage.matrix(_TRANSLATION, (3,)))
    if turn.shape == t.shape:
        return from_rotation_vector(turn, t), ()
    return rounded_pose(turn.reshape(3, 3), t, storage.path)


def read_camera(storage: Storage, side: str, T_cam_world: Pose, given: ReadOptions) -> CameraRecord:
    """Return the camera whose keys end in `side`.

    Raises
    ------
    InputError
        The file has no such camera, it is damaged, or nothing determines its picture size or its lens.
    """
    matrix, dist = side_keys(MATRIX, side), side_keys(DIST, side)
    for keys in (matrix, dist):
        if storage.first(keys) is None:
            raise InputError(
                f"{storage.path} has no {keys[0]} (a matrix of OpenCV). Its keys are "
                f"{', '.join(map(str, storage.content))[:300]}; name those of a pair as M1 D1 M2 D2 R T, "
                "those of one camera as camera_matrix and distortion_coefficients: "
                f"`key='{keys[0]}=KEY'`."
            )
    numbers = intrinsics_of(storage.matrix(matrix, (9,)), storage.path)
    coefficients = storage.matrix(dist, COUNTS)
    lens = _lens(storage, coefficients, given)
    return camera_record(numbers, lens, T_cam_world, _size(storage, given), storage.path)


def _lens(
    storage: Storage, coefficients: tuple[float, ...], given: ReadOptions
) -> tuple[str, tuple[float, ...]]:
    """Return the lens: as the file states, else as given, else by the number of coefficients."""
    path = storage.path
    stated, wanted = _stated_fisheye(storage), given_fisheye(given)
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


def _stated_fisheye(storage: Storage) -> bool | None:
    """Return whether a file states that its lens is a fisheye; None if it does not."""
    flag = storage.first(("fisheye_model", "fisheye"))
    if flag is not None:
        return finite_number(flag, "fisheye_model", storage.path) != 0.0
    words = {str(storage.content.get(key, "")).lower() for key in _KIND}
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


def _size(storage: Storage, given: ReadOptions) -> tuple[int, int]:
    """Return the size of the pictures, which the file states or a person does."""
    width, height, listed = (storage.first(keys) for keys in (_WIDTH, _HEIGHT, _SIZE))
    if width is None and height is None and listed is None:
        if given.size is not None:
            return picture_size(given.size, storage.path)
        raise InputError(
            f"{storage.path} does not state how large the pictures are. Give it: `size='1280x960'`. Or add "
            "the keys image_width and image_height."
        )
    if isinstance(listed, dict):  # a matrix, as of a cv::Size or an array
        listed = listed.get("data")
    size = picture_size(listed if width is None and height is None else [width, height], storage.path)
    if given.size not in (None, size):
        raise InputError(
            f"{storage.path} states a picture size of {size[0]}x{size[1]}, which `size` contradicts. Leave "
            "that out."
        )
    return size
