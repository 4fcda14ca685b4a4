"""Probability of the triangulation residuals of points by noise and the errors of the calibration."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.calibrate.residual_parts import ResidualParts
from labcal.calibrate.triangulation_residuals import OUTLYING
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.correspond.matching import Matches
from labcal.distributions import chi2_upper

CHANCE = 1e-4
"""Probability below which chance is no explanation."""
_MOSTLY = 0.5
"""Share of outlying points from which on they are the rule."""
_MOST = 3000
"""Points that are tested: more add nothing that the calibration's own errors would not cover."""


@dataclass(frozen=True)
class SeenPoints:
    """Points that the same cameras see.

    Attributes
    ----------
    chosen : tuple of int
        Numbers of these cameras.
    matches : Matches
        Their pixels, with the covariances of noise alone.
    outlying : bool array, (n,)
        Single points whose residual is beyond chance by itself.
    """

    chosen: tuple[int, ...]
    matches: Matches
    outlying: Bool[np.ndarray, " n"]

    def by_itself(
        self,
        cameras: Sequence[Camera],
        parameters: Float64[np.ndarray, "parameters parameters"],
        scatter_px: float,
    ) -> "SeenPoints":
        """Return the points of which only those count as outlying that the calibration does not explain.

        Parameters
        ----------
        cameras, parameters, scatter_px
            As of :class:`ResidualLevel`.
        """
        outlying = self.outlying.copy()
        for row in np.flatnonzero(outlying):
            one = SeenPoints(self.chosen, self.matches.where(np.array([row])), np.array([False]))
            level = ResidualLevel(cameras, parameters, scatter_px, [one])
            outlying[row] = level.beyond_chance(np.array([0]), OUTLYING)
        return replace(self, outlying=outlying)


@dataclass(frozen=True)
class ResidualLevel:
    """The test of whether residuals of several points are by noise and calibration.

    Attributes
    ----------
    cameras : sequence of Camera
        The first one is the world.
    parameters : float64 array, (parameters, parameters)
        Their joint covariance, in the order of ``rig.json``; zeros where it is not known.
    scatter_px : float
        Variance component of the calibration along each axis, as a standard deviation.
    groups : sequence of SeenPoints
        All points, by the cameras that see them.
    """

    cameras: Sequence[Camera]
    parameters: Float64[np.ndarray, "parameters parameters"]
    scatter_px: float
    groups: Sequence[SeenPoints]

    def beyond_chance(self, rows: Int64[np.ndarray, " rows"], chance: float = CHANCE) -> bool:
        """Tell whether noise and calibration do not explain residuals as large as those of some points.

        Outlying points do not count unless they are the most.

        Parameters
        ----------
        rows : int64 array, (rows,)
            Numbers of the points, group after group.
        chance : float
            The level of the test.
        """
        outlying = np.concatenate([group.outlying for group in self.groups])[rows]
        if not outlying.mean() > _MOSTLY:
            rows = rows[~outlying]
        rows = rows[:: -(-len(rows) // _MOST) or 1]
        parts, first, lost = [], 0, 0
        for group in self.groups:
            last = first + len(group.matches)
            own = group.matches.where(rows[(rows >= first) & (rows < last)] - first)
            first = last
            point = triangulate([self.cameras[at] for at in group.chosen], own.q, own.covariance).point
            there = np.isfinite(point).all(axis=1)
            lost += int((~there).sum())
            if there.any():
                seen = own.where(there)
                found = ResidualParts.of(self.cameras, group.chosen, seen, point[there], self.scatter_px)
                parts.append(found)
        return 2 * lost > len(rows) or p_value(parts, self.parameters) < chance


def p_value(
    parts: Sequence[ResidualParts], parameters: Float64[np.ndarray, "parameters parameters"]
) -> float:
    """Return how likely noise and calibration leave residuals as large as these, or larger; 1 of none.

    Parameters
    ----------
    parts : sequence of ResidualParts
        Of all points, by the cameras that see them.
    parameters : ndarray
        Joint covariance of the cameras, in the order of ``rig.json``.

    Notes
    -----
    With the residuals' parts z, their noise S (a block for each point) and their derivatives G by the
    cameras, which have the covariance C, z' (S + G C G')^-1 z is chi-square. The inverse is that of Woodbury:
    errors of the cameras move all points together, so that the points are not judged one by one.
    """
    spread, directions = np.linalg.eigh(parameters)
    root = directions * np.sqrt(spread.clip(0.0))
    square, freedom = 0.0, 0
    met = np.zeros(len(root))
    normal = np.eye(len(root))
    for part in parts:
        lower = np.linalg.cholesky(part.noise)
        z = np.linalg.solve(lower, part.seen[..., None])[..., 0]
        moved = np.linalg.solve(lower, part.by_cameras).reshape(z.size, -1) @ root
        square += float((z**2).sum())
        freedom += z.size
        met += moved.T @ z.ravel()
        normal += moved.T @ moved
    if not freedom:
        return 1.0
    return chi2_upper(max(0.0, square - float(met @ np.linalg.solve(normal, met))), freedom)
