"""Scored views: those from which the cameras or the method were not estimated, if there are any."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Mask
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role
from labcal.wording import counted


@dataclass(frozen=True)
class ScoredViews:
    """The scored views of points.

    Attributes
    ----------
    views : tuple of str
        The scored ones.
    calibrated_on : int or None
        Number of these from which the cameras or the method were estimated; None if that is not known.
    others : int
        Number of views that are not scored, since the cameras were estimated from them.
    """

    views: tuple[str, ...]
    calibrated_on: int | None
    others: int

    @classmethod
    def of(cls, view: np.ndarray, learned: Collection[str] | None) -> "ScoredViews":
        """Return the scored views of points.

        Parameters
        ----------
        view : ndarray of str, shape (n,)
            Of every point.
        learned : collection of str or None
            Names of the views that were learned from; None where that is not known.
        """
        views = tuple(dict.fromkeys(view.tolist()))
        if learned is None:
            return cls(views, None, 0)
        new = tuple(name for name in views if name not in learned)
        return cls(new, 0, len(views) - len(new)) if new else cls(views, len(views), 0)

    @classmethod
    def by_role(cls, view: np.ndarray, shoot: Shoot) -> "ScoredViews":
        """Return the test views of a shoot among those of points; all if there are none.

        A shoot does not state from which views cameras were calibrated: a table of its dots contains all
        views.
        """
        tested = {entry.name for entry in shoot.views(Role.TEST)}
        trained = {entry.name for entry in shoot.views(Role.TRAIN)}
        of_test = bool(tested & set(view.tolist()))
        return replace(cls.of(view, trained if of_test else None), calibrated_on=None)

    def holds(self, view: np.ndarray) -> Mask:
        """Return a mask of points in scored views."""
        return np.isin(view, self.views)


def scored_description(scored: int, calibrated_on: int | None) -> str:
    """Return a description of the scored views, and of how many were calibrated from."""
    views = counted(scored, "view")
    if calibrated_on is None:
        return (
            f"{views}; not known whether the cameras were calibrated from them (--rig RIG-or-MODEL states it)"
        )
    if calibrated_on:
        return f"{views}, all of them calibrated from: circular, no check of the accuracy of the points"
    return f"{views} held out from the calibration"


def scored_warnings(n_ok: int, calibrated_on: int | None) -> tuple[str, ...]:
    """Return warnings that belong to the errors."""
    warnings = []
    if calibrated_on:
        warnings.append(
            "these figures are circular: by their names, all scored views are views that the "
            "cameras were calibrated from. They show the repeatability of the calibration, not its "
            "accuracy. Score other views: '--hold-out 2' of 'labcal calibrate' or 'fit' keeps two."
        )
    if n_ok == 0:
        warnings.append("none of the scored points is flagged 'ok'")
    return tuple(warnings)
