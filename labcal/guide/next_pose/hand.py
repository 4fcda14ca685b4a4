"""Errors of a hand that holds a target at a pose."""

import re
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose, Vectors3
from labcal.errors import InputError
from labcal.geometry.poses import pose
from labcal.rng import generator
from labcal.wording import clipped

_FORM = re.compile(r"(\d+(?:\.\d+)?)deg,(\d+(?:\.\d+)?)%")
_MOST_TURN_DEG, _MOST_SHARE = 90.0, 0.5
_TRIED = 24
"""Errors of the hand for which a pose is tried."""


@dataclass(frozen=True)
class HandError:
    """Sizes of the errors of a hand: both have random directions.

    Attributes
    ----------
    turn_deg : float
        By which the target is turned about an axis through its middle.
    distance_share : float
        By which its middle is off, as a share of the distance to the first camera.
    """

    turn_deg: float = 5.0
    distance_share: float = 0.05

    def taken(self, T_first_target: Pose, middle: Vectors3, random: np.random.Generator) -> Pose:
        """Return the pose that the hand takes when it is asked for one.

        Parameters
        ----------
        T_first_target : ndarray, shape (4, 4)
            The pose that is asked for, in the frame of the first camera, mm.
        middle : ndarray, shape (3,)
            The middle of the target in its own frame, mm.
        random : Generator
        """
        axis, way = (_direction(random) for _ in range(2))
        R, t = T_first_target[:3, :3], T_first_target[:3, 3]
        asked = R @ middle + t
        held = Rotation.from_rotvec(np.radians(self.turn_deg) * axis).as_matrix() @ R
        place = asked + self.distance_share * float(np.linalg.norm(asked)) * way
        return pose(held, place - held @ middle)

    def tried(self, T_first_target: Pose, middle: Vectors3) -> np.ndarray:
        """Return poses (n, 4, 4) that the hand may take; the first one is the one that is asked for."""
        random = generator(0, "errors of a hand that are tried")
        tried = [self.taken(T_first_target, middle, random) for _ in range(_TRIED)]
        return np.array([T_first_target, *tried])


USUAL = HandError()


def parsed_hand_error(text: str) -> HandError:
    """Return the errors that a text names, as in ``5deg,5%``.

    Raises
    ------
    InputError
        The text is not of that form.
    """
    found = _FORM.fullmatch(text.replace(" ", ""))
    error = None if found is None else HandError(float(found[1]), 0.01 * float(found[2]))
    if error is None or error.turn_deg > _MOST_TURN_DEG or error.distance_share > _MOST_SHARE:
        raise InputError(
            "`hand_error`, the errors of a simulated hand, is an angle of at most 90 degrees and a share of "
            f"at most half the distance, as in 5deg,5%, but '{clipped(text)}' was given."
        )
    return error


def _direction(random: np.random.Generator) -> Vectors3:
    way = random.standard_normal(3)
    return np.asarray(way / np.linalg.norm(way))
