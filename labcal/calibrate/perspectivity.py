"""The test of whether rays meet: how far the dots tell a perspective from parallel rays."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.bounds import FOCAL_SIDES
from labcal.calibrate.adjustment.state import POSE
from labcal.cameras.camera import Camera
from labcal.cameras.free_parameters import FreeParameters
from labcal.cameras.lens import TELECENTRIC
from labcal.errors import InputError

_SURE = 3.0
"""Standard deviations."""
_NOTHING = 1e-12
"""Share of the largest singular value below which a direction is not observed."""


@dataclass(frozen=True)
class Sight:
    """Points that a camera with parallel rays saw at one pose of theirs."""

    q: Pixels
    """Measured, px."""
    p_cam: Vectors3
    """Their places by the adjustment of the camera, mm, in its frame."""


@dataclass(frozen=True)
class Perspectivity:
    """The inverse of the distance at which rays meet, by sight, and its standard deviation, 1/mm."""

    value: Float64[np.ndarray, " sights"]
    sigma: Float64[np.ndarray, " sights"]

    @classmethod
    def of(cls, camera: Camera, sights: Sequence[Sight]) -> "Perspectivity":
        """Return that of the dots, beside a camera with parallel rays that was adjusted to them.

        Parameters
        ----------
        camera : Camera
            Its rays are parallel.
        sights : sequence of Sight

        Notes
        -----
        Parallel rays image a point at q. Rays that meet at the distance D from the middle of a sight's points
        image it at ``c + (q - c) / (1 + z / D)``, with its depth z behind that middle: to first order
        ``-(q - c) z / D`` away. One linear step from the parallel camera gives 1/D, with lens and poses free
        beside it: a score test (Rao 1948). Neither D nor a focal length is searched for, since both would
        grow without end. By sight, since of a plane parallel rays do not tell the sign of z.
        """
        free = FreeParameters(camera)
        middle = 0.5 * (np.array(camera.size) - 1.0)
        rows = np.cumsum([0, *(2 * len(sight.q) for sight in sights)])
        J = np.zeros((rows[-1], free.count + POSE * len(sights)))
        H = np.zeros((rows[-1], len(sights)))
        residual = np.zeros(rows[-1])
        for number, sight in enumerate(sights):
            seen, at = free.imaged(sight.p_cam), slice(rows[number], rows[number + 1])
            from_middle = sight.p_cam - sight.p_cam.mean(axis=0)
            by_turn = np.cross(from_middle[:, None, :], seen.by_point)
            pose = free.count + POSE * number
            J[at, : free.count] = seen.by_camera.reshape(-1, free.count)
            J[at, pose : pose + POSE] = np.concatenate([by_turn, seen.by_point], axis=2).reshape(-1, POSE)
            H[at, number] = (-(seen.q - middle) * from_middle[:, 2:]).ravel()
            residual[at] = (sight.q - seen.q).ravel()
        basis = _range_of(J)
        H = H - basis @ (basis.T @ H)
        residual = residual - basis @ (basis.T @ residual)
        inverse = np.linalg.pinv(H.T @ H)
        value = inverse @ (H.T @ residual)
        left = residual - H @ value
        variance = float(left @ left) / max(1, len(left) - basis.shape[1] - len(sights))
        return cls(value, np.sqrt(variance * np.diagonal(inverse)))

    def is_none(self, camera: Camera) -> bool:
        """Tell whether rays meet, if at all, beyond the bounds of sense for focal lengths, for certain.

        Parameters
        ----------
        camera : Camera
            The one with parallel rays.
        """
        known = self.sigma > 0.0
        if not known.any():
            return False
        least = float(max(camera.intrinsics[:2])) / (FOCAL_SIDES[1] * max(camera.size))
        square = float(((self.value[known] / self.sigma[known]) ** 2).sum())
        # Of rays that meet just at the bound: a noncentral chi-square, by mean and standard deviation.
        count, noncentrality = int(known.sum()), float(((least / self.sigma[known]) ** 2).sum())
        mean, deviation = count + noncentrality, np.sqrt(2.0 * (count + 2.0 * noncentrality))
        return bool(square < mean - _SURE * deviation)


def _range_of(J: Float64[np.ndarray, "rows columns"]) -> Float64[np.ndarray, "rows rank"]:
    """Return an orthonormal basis of what parameters can move."""
    length = np.linalg.norm(J, axis=0)
    U, stretch, _ = np.linalg.svd(J[:, length > 0.0] / length[length > 0.0], full_matrices=False)
    return np.asarray(U[:, stretch > _NOTHING * stretch[0]])


def refuse_endless(who: str, camera: Camera) -> None:
    """Raise where the focal length of a camera is beyond the bounds of sense, since its rays are parallel.

    Parameters
    ----------
    who : str
        The method, or the camera, for messages.
    camera : Camera

    Raises
    ------
    InputError
        It is.
    """
    if not camera.model.parallel and max(camera.intrinsics[:2]) > FOCAL_SIDES[1] * max(camera.size):
        raise parallel_error(who)


def parallel_error(who: str) -> InputError:
    """Return the error of rays that are parallel where those of the lens are not."""
    return InputError(
        f"{who}: the rays are parallel as far as the dots tell, so that a focal length would grow without "
        f"end. Choose the lens '{TELECENTRIC}'."
    )
