"""The covariance that a calibration will have, from the views that are planned: nothing is measured yet."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask
from labcal.calibrate.adjustment.blocks import Blocks, assemble
from labcal.calibrate.adjustment.dot_freedom import DatumConstraint, dot_freedom, plane_modes
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.prior_term import LensPrior
from labcal.calibrate.adjustment.problem import AdjustmentProblem, ViewsEliminated
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.calibrate.budget.print_share import reduced_information
from labcal.calibrate.freed_dots import MIN_PICTURES
from labcal.calibrate.lens_prior import PriorWidth
from labcal.cameras.derivatives import imaged
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.optim.robust import SQUARES

_HELD = 0.5
"""Between the eigenvalues of directions that are held, 1, and of those that are free, 0."""


@dataclass(frozen=True)
class ExpectedCovariance:
    """The expected covariance of lenses and poses of a rig, by its sources.

    Parameters are in the order of :func:`~labcal.cameras.rig_covariance.parameter_names`.

    Attributes
    ----------
    noise, print_share : float64 array, (parameters, parameters)
        By the noise of the dots' pixels, and by the errors of the print.
    lens : bool array, (parameters,)
        Mask of the parameters of lenses; the others are of poses.
    """

    noise: Float64[np.ndarray, "parameters parameters"]
    print_share: Float64[np.ndarray, "parameters parameters"]
    lens: Mask

    @property
    def total(self) -> Float64[np.ndarray, "parameters parameters"]:
        """The covariance by all sources."""
        return np.asarray(self.noise + self.print_share)

    @classmethod
    def of_declared(
        cls, state: RigState, observations: Observations, print_sigma_mm: float
    ) -> "ExpectedCovariance":
        """Return what an adjustment will leave that takes the dots for where they are declared.

        Parameters
        ----------
        state : RigState
            True cameras, planned poses of the target, declared dots; the first camera is the world.
        observations : Observations
            Dots that the planned pictures will show, with the covariances that they will have.
        print_sigma_mm : float
            Standard deviation of dots on the print along each direction of its plane.

        Raises
        ------
        InputError
            The planned views do not determine the cameras.

        Notes
        -----
        At the minimum the errors of the parameters are linear in those of the pixels (Triggs et al. 2000,
        section 6.1). Derivatives are those of the adjustment itself, at the true parameters, with the same
        weak prior of lens coefficients. The adjustment weighs dots by their noise and a variance component,
        which is what the print's errors do to residuals; with these weights the noise has the covariance
        C M C, where C is the inverse of the normal equations and M the covariance of their gradient.
        """
        measured = np.unique(observations.dot)
        basis = np.zeros((len(state.dots), 3, 2 * len(measured)))
        for axis in range(2):
            basis[measured, axis, 2 * np.arange(len(measured)) + axis] = 1.0
        extra = print_sigma_mm**2 * _square_by_print(state, observations)
        weighted = observations.scattered(extra)
        end = _linearised(state, weighted, basis.reshape(state.dots.size, -1))
        information, _ = reduced_information(end)
        free = end.layout.pose[-1].stop
        still = _linearised(state, weighted, np.zeros((state.dots.size, 0)))
        C = _covariance(still)
        effect = C @ information[:free, free:]
        noise = C @ _information_of_noise(state, observations, extra, still.blocks) @ C
        return cls(noise, print_sigma_mm**2 * effect @ effect.T, _of_lenses(end.layout))

    @classmethod
    def of_freed(
        cls, state: RigState, observations: Observations, print_sigma_mm: float
    ) -> "ExpectedCovariance":
        """Return what an adjustment will leave that estimates the dots' places, too.

        Of the print's errors only those of its mean scale are left, which no view tells. Parameters and
        errors as of :meth:`of_declared`.
        """
        movable = np.bincount(observations.dot, minlength=len(state.dots)) >= MIN_PICTURES
        entering = observations.where(movable[observations.dot])
        basis = dot_freedom(state.dots, movable, DatumConstraint.nothing(len(movable)))
        modes = plane_modes(state.dots, movable)
        spread, axes = np.linalg.eigh(modes.T @ modes - modes.T @ basis @ (basis.T @ modes))
        held = modes @ axes[:, spread > _HELD]
        end = _linearised(state, entering, np.concatenate([basis, held], axis=1))
        information, _ = reduced_information(end)
        known = end.layout.pose[-1].stop + basis.shape[1]
        covariance = _covariance(_linearised(state, entering, basis))
        free = end.layout.pose[-1].stop
        effect = covariance[:free] @ information[:known, known:]
        return cls(covariance[:free, :free], print_sigma_mm**2 * effect @ effect.T, _of_lenses(end.layout))


def _linearised(
    state: RigState, observations: Observations, dots: Float64[np.ndarray, "coordinates free"]
) -> ViewsEliminated:
    """Return the normal equations where dots may move along the columns of a basis."""
    prior = LensPrior.of(state, observations, Lenses.FREE, PriorWidth.WIDE)
    return AdjustmentProblem(observations, Freedom(Lenses.FREE, dots), prior=prior).linearize(state)


def _square_by_print(state: RigState, observations: Observations) -> float:
    """Return the mean square of a pixel's coordinate by dots that are off by 1 mm, px2/mm2."""
    total = 0.0
    for picture in observations.pictures:
        camera, T = state.cameras[picture.camera], state.T_world_target[picture.view]
        p = transform(T, state.dots[observations.dot[picture.rows]])
        total += float(((imaged(camera, p).by_point @ T[:3, :2]) ** 2).sum())
    return total / (2 * len(observations))


def _information_of_noise(
    state: RigState, observations: Observations, extra: float, weighted: Blocks
) -> Float64[np.ndarray, "shared shared"]:
    """Return the covariance of the gradient by shared parameters, poses eliminated, by noise alone.

    `extra` is the variance that the weights hold besides, px squared; `weighted` the blocks with it.
    """
    used = observations.covariance + extra * np.eye(2)
    effective = used @ np.linalg.solve(observations.covariance, used)
    pixels = replace(observations, covariance=0.5 * (effective + effective.transpose(0, 2, 1)))
    layout = Layout(state, Freedom(Lenses.FREE, np.zeros((state.dots.size, 0))))
    own = assemble(layout, pixels, SQUARES)
    reach = weighted.cross @ np.linalg.inv(weighted.view)
    mixed = np.einsum("vsk,vtk->st", reach, own.cross)
    poses = np.einsum("vsk,vkl,vtl->st", reach, own.view, reach)
    return np.asarray(own.shared - mixed - mixed.T + poses)


def _covariance(end: ViewsEliminated) -> Float64[np.ndarray, "shared shared"]:
    covariance = end.shared_covariance()
    if not np.isfinite(covariance).all():
        raise InputError(
            "The planned views do not determine the cameras. Plan more views, or views that tilt the target "
            "in several directions."
        )
    return covariance


def _of_lenses(layout: Layout) -> Mask:
    """Return a mask of the parameters of lenses among those of all cameras."""
    mask = np.zeros(layout.pose[-1].stop, dtype=bool)
    for own in layout.lens:
        mask[own] = True
    return mask
