"""The linear model of a shoot: its noise, and what errors of its parameters cost in 3-D."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.agreement.correlated_errors import SmoothErrors
from labcal.calibrate.prepared_cameras import PreparedCameras
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import KnownCamera, noise_covariance
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.poses import inverse, transform
from labcal.guide.diagnosis.forms.hypotheses import base_terms, free_poses
from labcal.guide.diagnosis.forms.model import Fit, Term, fitted, moved_by
from labcal.guide.diagnosis.forms.view_forms import ViewForms
from labcal.guide.volume_cost import Volume

_FEWEST_POINTS = 4


@dataclass(frozen=True)
class ShootModel:
    """Cameras that are calibrated alone, tied to a rig by linear least squares.

    Attributes
    ----------
    forms : ViewForms
    views : tuple of str
        Names of the views.
    noise : float64 array, (2, 2)
        Covariance of a typical dot as the detector states it, px squared.
    """

    forms: ViewForms
    views: tuple[str, ...]
    noise: Float64[np.ndarray, "2 2"]

    @classmethod
    def of(cls, prepared: PreparedCameras) -> "ShootModel":
        """Return the model of cameras that are calibrated alone.

        Raises
        ------
        InputError
            A camera shares no view with the others.
        """
        entering = prepared.dots.entering
        forms = ViewForms.of(prepared.alone, len(entering.views))
        covariance = np.concatenate([one.result.observations.covariance for one in prepared.alone])
        return cls(forms, tuple(entering.views), np.median(covariance, axis=0))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the cameras."""
        return tuple(one.name for one in self.forms.cameras)

    @property
    def half_side_mm(self) -> float:
        """Half of the longer side of the dots' grid, to which columns of the board's shape are scaled."""
        places = self.forms.cameras[0].result.adjusted.state.dots[:, :2]
        return float(np.abs(places - places.mean(axis=0)).max())

    @cached_property
    def base(self) -> tuple[Term, ...]:
        """The terms of a shoot without mistakes."""
        return base_terms(self.forms)

    @cached_property
    def good(self) -> Fit:
        """The fit of a shoot without mistakes."""
        return self.fit(())

    def fit(self, extra: Sequence[Term]) -> Fit:
        """Return the fit with terms beside the base."""
        return fitted(self.forms, (*self.base, *extra))

    @cached_property
    def view_misfits(self) -> Float64[np.ndarray, " views"]:
        """Chi-square of each view in the fit of a shoot without mistakes, over its number of dots."""
        found = []
        for products, moved in zip(
            self.forms.products, moved_by(self.forms.views, self.base, self.good.values), strict=True
        ):
            step = np.append(moved, 1.0)
            found.append(float(step @ products @ step))
        return np.asarray(np.array(found) / np.maximum(self.forms.dots.sum(axis=0), 1.0))

    def freedom(self, fit: Fit) -> float:
        """Return the degrees of freedom that a fit leaves."""
        in_views = (self.forms.dots.sum(axis=0) > 0).sum()
        return max(1.0, 2.0 * float(self.forms.dots.sum()) - POSE * float(in_views) - fit.freedom)

    def own_noise(self, extra: Sequence[Term]) -> float:
        """Return the variance that is left where every camera has poses of its own, over the stated one."""
        alone = self.fit((*extra, *free_poses(self.forms)))
        return alone.chi2 / self.freedom(alone)

    @cached_property
    def smooth_inflation(self) -> float:
        """Factor by which errors that neighbouring dots share exceed independent ones, at least 1."""
        return SmoothErrors.together([SmoothErrors.of(one.result) for one in self.forms.cameras]).inflation

    @cached_property
    def rig(self) -> Rig:
        """The cameras as calibrated alone, at their places by most views."""
        cameras = {
            one.name: one.single.camera.__class__(
                one.single.camera.K, one.single.camera.lens, one.single.camera.dist, T, one.single.camera.size
            )
            for one, T in zip(self.forms.cameras, self.forms.T_cam_world, strict=True)
        }
        return Rig.of(cameras)

    @cached_property
    def volume(self) -> Volume | None:
        """The volume of the target's dots, at the dots; None of one camera."""
        places = [
            transform(inverse(T_cam_world) @ T, one.result.adjusted.state.dots)
            for one, T_cam_world in zip(self.forms.cameras, self.forms.T_cam_world, strict=True)
            for T in one.single.T_cam_target
        ]
        return Volume.at(self.rig, np.concatenate(places), self.noise)

    @cached_property
    def square(self) -> Float64[np.ndarray, "shared shared"] | None:
        """M of the mean squared 3-D error x' M x by errors x of the rig's parameters; rigid motions apart."""
        if self.volume is None:
            return None
        points = self.volume.points
        cameras = [self.rig.camera(name) for name in self.rig.cameras]
        by = triangulation_derivatives(cameras, points, self.volume.pixels)
        known = np.isfinite(by).all(axis=(1, 2))
        by, points = by[known], points[known]
        if len(points) < _FEWEST_POINTS:
            return None
        # The world of a target in the hand is nobody's: what a rigid motion of all points does is no error.
        turns = -cross_matrices(points - points.mean(axis=0))
        shifts = np.tile(np.eye(3), (len(points), 1, 1))
        rigid, _ = np.linalg.qr(np.concatenate([turns, shifts], axis=2).reshape(-1, POSE))
        flat = by.reshape(-1, by.shape[2])
        flat = flat - rigid @ (rigid.T @ flat)
        return np.asarray(flat.T @ flat / len(points))

    def budget_mm(self, noise: float) -> float | None:
        """Return the expected RMS 3-D error of this rig, were the shoot without mistakes.

        Parameters
        ----------
        noise : float
            Variance of the dots over the one that they were weighted by.
        """
        if self.volume is None or self.square is None:
            return None
        imagers = [KnownCamera(self.rig.camera(name)) for name in self.rig.cameras]
        of_pixels = noise_covariance(imagers, self.volume.points, self.volume.pixels, 0.0)
        by_noise = float(np.trace(of_pixels, axis1=1, axis2=2).mean())
        by_rig = noise * float(np.sum(self.square * self.good.covariance))
        return float(np.sqrt(by_noise + by_rig))

    def bias_mm(
        self,
        of: tuple[Term, ...],
        found: Fit,
        beside: Sequence[Term],
        noise: float,
        later: Float64[np.ndarray, " shared"],
    ) -> float | None:
        """Return the RMS 3-D error of a rig that is calibrated without some terms, less the part by chance.

        It is the bias by omitted variables: the rig's parameters take up ``(X' W X)^-1 X' W Z z`` of terms Z
        with values z.

        Parameters
        ----------
        of : tuple of Term
            Those that are left out, each the same in all its views.
        found : Fit
            With them, as its last terms.
        beside : sequence of Term
            Those that the rig is calibrated with beside the base: none by which views have errors of their
            own, which no calibration knows, and beside which the rig would have no pose.
        noise : float
            As of :meth:`budget_mm`.
        later : ndarray, shape (shared,)
            Change of the rig's parameters by the mistake in later views; zeros of one that is no change.
        """
        if self.square is None:
            return None
        count, width = len(self.square), sum(term.count for term in of)
        takes_up = np.stack([self._taken_up(of, one, beside)[:count] for one in np.eye(width)], axis=1)
        values, covariance = found.values[-width:], found.covariance[-width:, -width:]
        by_chance = noise * float(np.sum((takes_up.T @ self.square @ takes_up) * covariance))
        biases = []
        for change in (np.zeros(count), later):
            off = takes_up @ values - change
            biases.append(float(off @ self.square @ off) - max(0.0, by_chance))
        return float(np.sqrt(max(0.0, *biases)))

    def _taken_up(
        self, of: tuple[Term, ...], values: Float64[np.ndarray, " parameters"], beside: Sequence[Term]
    ) -> Float64[np.ndarray, " others"]:
        """Return what the base, and terms beside it, take up of dots that other terms alone have moved."""
        moved = moved_by(self.forms.views, of, values)
        products = self.forms.products.copy()
        products[:, :-1, -1] = -np.einsum("vij,vj->vi", products[:, :-1, :-1], moved)
        return fitted(replace(self.forms, products=products), (*self.base, *beside)).values

    def scattered_bias_mm(self, without: Fit, extra: Sequence[Term], noise: float) -> float | None:
        """Return the expected RMS 3-D error of the rig by errors that each view has for itself, mm.

        Parameters
        ----------
        without : Fit
            Of a model in which views have no errors of their own.
        extra : sequence of Term
            The terms of that model beside the base.
        noise : float
            As of :meth:`budget_mm`.

        Notes
        -----
        With the gradient s of each view at the fit and the covariance C of the rig, ``C (sum s s') C`` is the
        covariance of a rig from views that differ by more than noise (the sandwich estimator: White 1980,
        "A heteroskedasticity-consistent covariance matrix estimator"); what noise adds to it is subtracted.
        """
        if self.square is None:
            return None
        base = np.concatenate([term.columns for term in self.base], axis=1)
        step = self.good.covariance
        of_error = step @ self.square @ step
        total, views = 0.0, 0
        all_moved = moved_by(self.forms.views, (*self.base, *extra), without.values)
        for products, moved in zip(self.forms.products, all_moved, strict=True):
            own = base.T @ products[:-1, :-1] @ base
            slope = base.T @ (products[:-1, :-1] @ moved + products[:-1, -1])
            expected = noise * (own - own @ step @ own)
            total += float(slope @ of_error @ slope - np.sum(of_error * expected))
            views += 1
        return float(np.sqrt(max(0.0, total * views / max(1, views - 1))))

    def in_rig(
        self, columns: Float64[np.ndarray, "columns k"], values: Float64[np.ndarray, " k"]
    ) -> np.ndarray:
        """Return what values of a term of poses and lenses are as parameters of the rig, shape (shared,)."""
        moved = columns @ values
        parts = []
        for camera in range(len(self.forms.cameras)):
            parts.append(moved[self.forms.lens_of(camera)])
            if camera:
                parts.append(moved[self.forms.pose(camera)])
        return np.concatenate(parts)
