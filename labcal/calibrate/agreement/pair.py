"""Tests of the hypothesis that the relative pose of two cameras is the same in all views."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64, Int64

from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.agreement.correlated_errors import SmoothErrors
from labcal.calibrate.agreement.relative_poses import RelativePoses
from labcal.calibrate.single_calibration import SingleCalibration
from labcal.distributions import f_tail

_RIDGE = 1e-12
"""In units of a shared parameter's own curvature: for what neither camera's dots determine."""
_LOWEST = 5.0
"""Measured: a lens with tangential distortion that a model without it is fitted to."""


@dataclass(frozen=True)
class PairAgreement:
    """Two cameras, and their relative poses in each shared view.

    Notes
    -----
    A view's difference is ``d = m + B e + n``: m is the same in all views of a group, e are the errors of
    the lenses, which all views share, n is the view's own error. Generalised least squares in m leaves a
    chi-square of 6 degrees of freedom for each view less one for each group. It is what the adjustment of
    the rig costs beyond the cameras' own adjustments, to first order (Wald's test; both have the same lenses,
    and own poses of the target in every picture). Errors that neighbouring dots share make it larger by the
    factor that :class:`SmoothErrors` estimates, so that the ratio of both follows an F distribution.
    """

    first: str
    second: str
    """Names of the cameras."""
    poses: RelativePoses
    smooth: SmoothErrors

    @classmethod
    def of(cls, first: SingleCalibration, second: SingleCalibration) -> "PairAgreement | None":
        """Return that of two cameras, or None where they share fewer than two views or a pose is open."""
        poses = RelativePoses.of(first, second)
        if poses is None or len(poses.views) < 2:  # noqa: PLR2004 -- one view agrees with itself
            return None
        smooth = [SmoothErrors.of(first.result), SmoothErrors.of(second.result)]
        return cls(first.name, second.name, poses, SmoothErrors.together(smooth))

    def chance(self, groups: Int64[np.ndarray, " n"]) -> float:
        """Return the probability that views of the same group differ so much by chance.

        Parameters
        ----------
        groups : ndarray, shape (n,)
            By view the number of its group, from 0.
        """
        freedom = POSE * (len(groups) - 1 - int(groups.max()))
        if freedom == 0:
            return 1.0
        ratio = self.misfit(groups) / freedom / self.inflation
        return f_tail(ratio, freedom, max(self.smooth.freedom, 1.0))

    @property
    def inflation(self) -> float:
        """Factor by which pose variances may exceed those of independent dot errors.

        Where smooth errors are larger than independent ones, something is not as modelled; of that poses take
        up more than what lies beside them, at most :data:`_LOWEST` times as much.
        """
        beside = self.smooth.inflation
        return beside * min(beside, _LOWEST)

    def misfit(self, groups: Int64[np.ndarray, " n"]) -> float:
        """Return the chi-square that is left where every group of views has a pose of its own."""
        count = 1 + int(groups.max())
        weight = np.zeros((count, POSE, POSE))
        np.add.at(weight, groups, self._weight)
        sums = np.zeros((count, POSE))
        np.add.at(sums, groups, self._weighted)
        reach = np.zeros((count, POSE, self._reach.shape[2]))
        np.add.at(reach, groups, self._reach)
        flat = reach.reshape(POSE * count, -1)
        normal = -(flat @ self._inner @ flat.T)
        for group in range(count):
            at = slice(POSE * group, POSE * (group + 1))
            normal[at, at] += weight[group]
        lenses = np.einsum("nis,ni->s", self.poses.by_shared, self._weighted)
        right = sums.ravel() - flat @ self._inner @ lenses
        square = float((self.poses.difference * self._weighted).sum() - lenses @ self._inner @ lenses)
        scale = 1.0 / np.sqrt(np.maximum(np.diagonal(normal), 1e-300))
        scaled = normal * np.outer(scale, scale)
        step, *_ = np.linalg.lstsq(scaled, scale * right, rcond=1e-13)
        return max(0.0, square - float(step @ (scale * right)))

    @cached_property
    def _weight(self) -> Float64[np.ndarray, "n 6 6"]:
        return np.linalg.inv(self.poses.own)

    @cached_property
    def _weighted(self) -> Float64[np.ndarray, "n 6"]:
        """Differences, weighted."""
        return np.asarray((self._weight @ self.poses.difference[..., None])[..., 0])

    @cached_property
    def _reach(self) -> Float64[np.ndarray, "n 6 shared"]:
        return np.asarray(self._weight @ self.poses.by_shared)

    @cached_property
    def _inner(self) -> Float64[np.ndarray, "shared shared"]:
        """Covariance of the lenses' errors when the views' differences have been seen."""
        added = np.einsum("nis,nit->st", self.poses.by_shared, self._reach)
        seen = self.poses.shared + added
        scale = 1.0 / np.sqrt(np.maximum(np.diagonal(seen), 1e-300))
        scaled = seen * np.outer(scale, scale) + _RIDGE * np.eye(len(seen))
        return np.asarray(np.linalg.inv(scaled) * np.outer(scale, scale))
