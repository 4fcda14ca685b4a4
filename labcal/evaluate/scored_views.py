"""Scored views: those from which the cameras or the method were not estimated, if there are any."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Mask
from labcal.correspond.points import Points
from labcal.public_object import PublicObject
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


@dataclass(frozen=True)
class ScoredPart:
    """The part of errors that says which views they are of."""

    n_ok: int
    """Number of the points that count and are flagged ``ok``."""
    views_scored: tuple[str, ...]
    views_calibrated_on: int | None
    """Number of these that are training views, so that errors in them are no check; None if not known."""

    @classmethod
    def of(cls, points: Points, views: ScoredViews) -> "ScoredPart":
        """Return the part for the points that count."""
        return cls(int(points.ok.sum()), tuple(dict.fromkeys(points.view.tolist())), views.calibrated_on)


class OfScoredViews(PublicObject):
    """Errors that have a :class:`ScoredPart`, whose fields are theirs, and keys of their JSON document."""

    scored_views: ScoredPart

    @property
    def n_ok(self) -> int:
        """Number of the points that count and are flagged ``ok``."""
        return self.scored_views.n_ok

    @property
    def views_scored(self) -> tuple[str, ...]:
        """Names of the views of the points that count."""
        return self.scored_views.views_scored

    @property
    def views_calibrated_on(self) -> int | None:
        """Number of these that are training views, so that errors are no check; None if not known."""
        return self.scored_views.views_calibrated_on

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings, for people."""
        return scored_warnings(self.n_ok, self.views_calibrated_on)


def scored_description(scored: int, calibrated_on: int | None) -> str:
    """Return which views are scored, for people: how many, and how many of these were learned from."""
    views = counted(scored, "view")
    if calibrated_on is None:
        return f"{views}; not known whether the cameras were calibrated from them (`rig` states it)"
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
            "accuracy. Score other views: `hold_out=2` of 'calibrate' or 'fit' keeps two, and "
            "`parts=4` of 'evaluate' calibrates from a part of the views and measures the rest."
        )
    if n_ok == 0:
        warnings.append("none of the scored points is flagged 'ok'")
    return tuple(warnings)
