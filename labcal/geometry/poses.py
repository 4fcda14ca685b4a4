"""Rigid transforms ``T_ab``: coordinates in b to coordinates in a, so ``T_ac = T_ab @ T_bc``."""

from collections.abc import Sequence

import numpy as np

from labcal.arrays import Matrix3, Pose, Vectors3
from labcal.errors import InputError

_UPRIGHT = 1e-12
"""Cosine of an angle that is as good as 90 degrees."""


def pose(R_ab: Matrix3, t_ab: np.ndarray) -> Pose:
    """Return ``T_ab`` from its rotation and the origin of b in a (mm)."""
    T_ab = np.eye(4)
    T_ab[:3, :3] = R_ab
    T_ab[:3, 3] = t_ab
    return T_ab


def inverse(T_ab: Pose) -> Pose:
    """Return ``T_ba``."""
    R_ba = T_ab[:3, :3].T
    return pose(R_ba, -R_ba @ T_ab[:3, 3])


def transform(T_ab: Pose, p_b: Vectors3) -> Vectors3:
    """Return points given in b as coordinates in a, shape kept, mm."""
    p_a: np.ndarray = p_b @ T_ab[:3, :3].T + T_ab[:3, 3]
    return p_a


def from_rotation_vector(rotation_vector: np.ndarray, t_ab: np.ndarray) -> Pose:
    """Return ``T_ab`` from a rotation vector (axis times angle in radians, as OpenCV's) and t (mm)."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 -- takes a quarter of a second

    return pose(Rotation.from_rotvec(rotation_vector).as_matrix(), t_ab)


def rotation_vector(T_ab: Pose) -> np.ndarray:
    """Return the rotation vector of ``T_ab`` (axis times angle in radians), shape (3,)."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 -- as above

    return np.asarray(Rotation.from_matrix(T_ab[:3, :3]).as_rotvec())


def from_quaternion(wxyz: np.ndarray) -> Matrix3:
    """Return the rotation of a quaternion, its real part first, of any length but 0."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 -- as above

    return np.asarray(Rotation.from_quat(wxyz[[1, 2, 3, 0]]).as_matrix())


def quaternion(R_ab: Matrix3) -> np.ndarray:
    """Return the unit quaternion of a rotation, its real part first, shape (4,); of its two signs either."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 -- as above

    return np.asarray(Rotation.from_matrix(R_ab).as_quat()[[3, 0, 1, 2]])


def from_fixed_angles_deg(xyz: Sequence[float]) -> Matrix3:
    """Return the rotation by three angles in degrees, about the fixed axes x, y and z in this order."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 -- as above

    return np.asarray(Rotation.from_euler("xyz", xyz, degrees=True).as_matrix())


def fixed_angles_deg(R_ab: Matrix3) -> tuple[float, float, float]:
    """Return the three angles of :func:`from_fixed_angles_deg`; where y is turned by 90 degrees, z is 0."""
    across = float(np.hypot(R_ab[0, 0], R_ab[1, 0]))
    y = np.arctan2(-R_ab[2, 0], across)
    if across < _UPRIGHT:
        x, z = np.arctan2(-R_ab[1, 2], R_ab[1, 1]), 0.0
    else:
        x, z = np.arctan2(R_ab[2, 1], R_ab[2, 2]), np.arctan2(R_ab[1, 0], R_ab[0, 0])
    return float(np.degrees(x)), float(np.degrees(y)), float(np.degrees(z))


def nearest_rotation(M: Matrix3) -> tuple[Matrix3, np.ndarray]:
    """Return the rotation nearest to a matrix (least squares), and the singular values of the matrix.

    Schoenemann 1966, "A generalized solution of the orthogonal Procrustes problem", Psychometrika 31.
    """
    U, stretch, Vt = np.linalg.svd(M)
    return U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt, stretch


def look_at(eye: np.ndarray, focus: np.ndarray, up: np.ndarray) -> Pose:
    """Return ``T_cam_world`` of a camera at `eye` that looks at `focus`.

    Parameters
    ----------
    eye, focus : ndarray, shape (3,)
        World coordinates in mm.
    up : ndarray, shape (3,)
        World direction that shall point to the top of the picture.

    Raises
    ------
    InputError
        `eye` and `focus` coincide, or `up` is along the view.
    """
    forward = focus - eye
    right = np.cross(forward, up)
    if np.linalg.norm(forward) == 0.0 or np.linalg.norm(right) <= 1e-9 * np.linalg.norm(forward):
        raise InputError(
            "A camera needs a point to look at away from itself, and an 'up' not along its view."
        )
    z = forward / np.linalg.norm(forward)
    x = right / np.linalg.norm(right)
    R_cam_world = np.stack([x, np.cross(z, x), z])
    return pose(R_cam_world, -R_cam_world @ eye)


def facing(centre: np.ndarray, focus: np.ndarray) -> Pose:
    """Return ``T_ab`` of a body b at `centre` (in a, mm) whose z axis points at `focus`.

    Raises
    ------
    InputError
        `centre` and `focus` coincide.
    """
    along = focus - centre
    up = np.array([1.0, 0.0, 0.0] if abs(along[0]) < 0.9 * np.linalg.norm(along) else [0.0, 1.0, 0.0])
    return inverse(look_at(centre, focus, up))


def require_rigid(T_ab: Pose, what: str) -> None:
    """Raise unless the matrix is a rotation and a translation.

    Raises
    ------
    InputError
        `T_ab` has a last row other than 0 0 0 1, or its 3x3 part is no rotation.
    """
    R = T_ab[:3, :3]
    # No element of a rotation is larger than 1, so that squares cannot overflow.
    sound = np.isfinite(T_ab).all() and np.abs(R).max() <= 1.0 + 1e-6
    is_rotation = sound and np.allclose(R @ R.T, np.eye(3), atol=1e-6) and np.linalg.det(R) > 0
    if not (np.array_equal(T_ab[3], [0.0, 0.0, 0.0, 1.0]) and is_rotation):
        raise InputError(
            f"{what} must be a rigid 4x4 transform (rotation and translation in mm), last row 0 0 0 1."
        )


def rigid_alignment(p_a: Vectors3, p_b: Vectors3) -> Pose:
    """Return ``T_ab`` that brings `p_b` onto `p_a` with the least sum of squares (Kabsch 1976).

    Parameters
    ----------
    p_a, p_b : ndarray, shape (n, 3)
        The same points in both frames, at least three not on a line, mm.

    Raises
    ------
    InputError
        Fewer than three points, or all on one line.
    """
    if len(p_a) < 3:  # noqa: PLR2004 -- three points fix a pose
        raise InputError(f"An alignment needs at least 3 points, but {len(p_a)} were given.")
    centre_a, centre_b = p_a.mean(axis=0), p_b.mean(axis=0)
    U, spread, Vt = np.linalg.svd((p_a - centre_a).T @ (p_b - centre_b))
    if spread[1] <= 1e-12 * spread[0]:
        raise InputError("An alignment needs points that do not all lie on one line.")
    handedness = np.array([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))])
    R_ab = (U * handedness) @ Vt
    return pose(R_ab, centre_a - R_ab @ centre_b)
