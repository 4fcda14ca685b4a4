"""Power of a check: the smallest changes that the pictures could have found."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.validity.change import Change
from labcal.calibrate.validity.explanation import covariance_root, with_change
from labcal.calibrate.validity.tested import ALARM, WITH_AXES, Tested, tests_of
from labcal.distributions import needed_gain

POWER = 0.9
"""Probability with which a change of the stated size is found."""


@dataclass(frozen=True)
class Sensitivity:
    """The information of the pictures about one change, the calibration's own errors allowed for.

    Attributes
    ----------
    change : Change
    columns : float64 array, (rig, count)
        Derivatives of the rig's parameters by those of the change.
    information : float64 array, (count, count)
        Inverse covariance of its size; rad, mm, relative focal lengths, px.
    needed : float
        Squared size, in units of that covariance, that is found with the probability :data:`POWER`.
    needed_along_axis : float
        The same of a change along one parameter, which may have a test of its own.
    """

    change: Change
    columns: Float64[np.ndarray, "rig count"]
    information: Float64[np.ndarray, "count count"]
    needed: float
    needed_along_axis: float

    def smallest(self) -> Float64[np.ndarray, " count"]:
        """Return the smallest change along each parameter that is found; infinite if none is."""
        own = np.diagonal(self.information)
        return (
            np.sqrt(self.needed_along_axis / np.where(own > 0.0, own, np.nan))
            if (own > 0.0).all()
            else own + np.inf
        )

    def worst(self, square: Float64[np.ndarray, "rig rig"]) -> float:
        """Return the largest root of x' M x of the rig's parameters x by a change that is not found.

        Parameters
        ----------
        square : ndarray, shape (rig, rig)
            The matrix M.
        """
        scale = 1.0 / np.sqrt(np.maximum(np.diagonal(self.information), 1e-300))
        scaled = self.information * np.outer(scale, scale)
        spread, axes = np.linalg.eigh(scaled)
        if not spread[0] > 1e-12 * spread[-1]:
            return float("inf")
        root = self.columns * scale @ (axes / np.sqrt(spread))
        return float(np.sqrt(self.needed * max(0.0, np.linalg.eigvalsh(root.T @ square @ root)[-1])))


def sensitivities(found: Tested) -> list[Sensitivity]:
    """Return the sensitivity to each kind of change of each camera, about the rig as calibrated."""
    made, now = found.made, found.unchanged.evidence
    root, H = covariance_root(made.calibrated.covariance), now.information
    changes = made.views.changes(made.cameras)
    to_rig = made.views.rig_columns(now.state)
    level = ALARM / tests_of(changes)
    along_axis = needed_gain(level, 1, made.noise_freedom, POWER)
    result = []
    for change in changes:
        B = change.columns(now.state)
        sizes = change.sizes(now.state.cameras, made.calibrated.distance_mm)
        # The size's covariance by the views once errors of the calibration have followed, prior and all.
        L = with_change(root, B * sizes)
        at = slice(root.shape[1], None)
        both = np.linalg.inv(np.linalg.inv(np.eye(L.shape[1]) + L.T @ H @ L)[at, at])
        information = (both - np.eye(len(sizes))) / np.outer(sizes, sizes)
        needed = needed_gain(level, change.count, made.noise_freedom, POWER)
        along = along_axis if change.kind in WITH_AXES else needed
        result.append(
            Sensitivity(change, to_rig[:, : len(B)] @ B, 0.5 * (information + information.T), needed, along)
        )
    return result
