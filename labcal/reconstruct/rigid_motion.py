"""The rigid motion of a body between two moments, with its uncertainty."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import AnyArray, Pose
from labcal.errors import InputError
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.poses import rigid_alignment, rotation_vector, transform
from labcal.public_object import PublicObject
from labcal.reconstruct.chosen_points import AnyReconstruction, ChosenPoints, Shares


@dataclass(frozen=True, eq=False, repr=False)
class RigidMotion(PublicObject):
    """A rotation and a displacement in the world of the rig; all points weigh the same.

    Attributes
    ----------
    T_after_before : float64 array, (4, 4)
        It takes the points before onto those after, mm.
    rotation_rad : float64 array, (3,)
        Rotation vector.
    displacement_mm : float64 array, (3,)
        Of the mean of the points.
    rms_mm : float
        Root mean square distance of the moved points from those after.
    shares : Shares
        Covariance of the displacement (mm), then of a turn after the rotation (rad).

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples, pipeline
    >>> found = pipeline.reconstruct(examples.rig(), examples.detections(), examples.TARGET)
    >>> view = found.points.view
    >>> moved = labcal.rigid_motion(found, view == "hand-0", view == "hand-1")
    >>> bool((moved.sigma_displacement_mm < 0.05).all()), moved.sigma_rotation_rad.shape
    (True, (3,))
    """

    T_after_before: Pose
    rotation_rad: Float64[np.ndarray, "3"]
    displacement_mm: Float64[np.ndarray, "3"]
    rms_mm: float
    shares: Shares

    @property
    def sigma_displacement_mm(self) -> Float64[np.ndarray, "3"]:
        """Standard deviations of the displacement."""
        return np.asarray(np.sqrt(np.diagonal(self.shares.total)[:3]))

    @property
    def sigma_rotation_rad(self) -> Float64[np.ndarray, "3"]:
        """Standard deviations of the rotation, about the axes of the world."""
        return np.asarray(np.sqrt(np.diagonal(self.shares.total)[3:]))

    def _summary(self) -> Mapping[str, object]:
        return {
            "displacement": f"{np.linalg.norm(self.displacement_mm):.6g} mm",
            "rotation": f"{np.linalg.norm(self.rotation_rad):.6g} rad",
            "rms": f"{self.rms_mm:.3g} mm",
            "sigma_displacement": f"{self.sigma_displacement_mm.max():.3g} mm",
            "sigma_rotation": f"{self.sigma_rotation_rad.max():.3g} rad",
            "budget": self.shares.budget.value,
        }


def rigid_motion(found: AnyReconstruction, before: AnyArray, after: AnyArray) -> RigidMotion:
    """Return the motion of a rigid body that points of a rig were measured on twice.

    Errors of the calibration act on both moments: of a small motion they all but cancel.

    Parameters
    ----------
    found : Reconstruction or NamedReconstruction
    before, after : array_like of int or of bool, or sequence of str or (str, str)
        Lines of the same points in ``found.points`` at both moments, in the same order; of named points also
        view and name of each.

    Returns
    -------
    RigidMotion
        Mm and rad; with the covariance of displacement and rotation.

    Raises
    ------
    InputError, InputTypeError
        Fewer than three points, or all on a line; not as many before as after, or a line in both; there is no
        such line, or one has no solution; or the points are not those of a rig.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples, pipeline
    >>> found = pipeline.reconstruct(examples.rig(), examples.detections(), examples.TARGET)
    >>> view = found.points.view
    >>> moved = labcal.rigid_motion(found, view == "hand-0", view == "hand-1")
    >>> bool(moved.rms_mm < 0.3)
    True
    """
    chosen, moved = ChosenPoints.of(found, before, "before"), ChosenPoints.of(found, after, "after")
    first, second = chosen.point, moved.point
    count = len(first)
    if len(second) != count:
        raise InputError("`before` and `after` must list the same points, but one of them lists more.")
    points = chosen.and_others(moved, "before, after")
    T = rigid_alignment(second, first)
    R, arm = T[:3, :3], second - second.mean(axis=0)
    # Normal equations of a small turn w, which moves a point by w x arm.
    turned = cross_matrices(arm)
    by_after = np.linalg.solve(-(turned @ turned).sum(axis=0), turned.transpose(1, 0, 2).reshape(3, -1))
    by_after = by_after.reshape(3, count, 3)
    mean = np.broadcast_to(np.eye(3)[:, None] / count, (3, count, 3))
    slopes = np.concatenate(
        [np.concatenate([-mean, mean], axis=1), np.concatenate([-by_after @ R, by_after], axis=1)]
    )
    return RigidMotion(
        T_after_before=T,
        rotation_rad=rotation_vector(T),
        displacement_mm=second.mean(axis=0) - first.mean(axis=0),
        rms_mm=float(np.sqrt(((transform(T, first) - second) ** 2).sum(axis=1).mean())),
        shares=points.shares(slopes),
    )
