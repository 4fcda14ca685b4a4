"""One run of an arm at one seed: trained, tested, and its figures."""

from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.arrays import Vectors3
from labcal.cameras.triangulation import triangulate
from labcal.errors import InputError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.registry import make_estimator
from labcal.evaluate.statistics import error_statistics
from labcal.paper.claims.arm_data import ArmProblem, arm_problem
from labcal.paper.claims.plan import ORACLE, Arm, ArmData

_NETWORK = "mlp"


@dataclass(frozen=True)
class ArmRun:
    """The definition of a run.

    Attributes
    ----------
    claim, name : str
        The claim and its arm.
    arm : Arm
    seed : int
    pictured : ArmProblem, optional
        The data of an arm from pictures.
    """

    claim: str
    name: str
    arm: Arm
    seed: int
    pictured: ArmProblem | None = None

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.claim}-{self.name}-{self.seed}"


class ArmFigures(BaseModel):
    """The result on test points."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    rmse_mm: float
    """RMS length of the 3-D error."""
    further_rmse: float | None
    """RMS error of the outputs after X, Y and Z, mm; None where there are none."""
    epochs: int | None
    """Accepted steps; None where nothing is trained by steps."""


def arm_figures(run: ArmRun) -> ArmFigures:
    """Train and test an arm."""
    data = run.pictured or arm_problem(run.arm, run.seed)
    tested = data.problem
    if run.arm.method == ORACLE:
        predicted, epochs = _exact_cameras(data, run.arm), None
    else:
        estimator = _estimator(run, data).fit(tested.X, tested.Y)
        predicted = estimator.predict(tested.X_test)
        epochs = estimator.n_iter_ if run.arm.method == _NETWORK else None
    further = predicted[:, 3:] - tested.Y_test[:, 3:]
    return ArmFigures(
        rmse_mm=error_statistics(predicted[:, :3], tested.Y_test[:, :3]).rmse_mm,
        further_rmse=float(np.sqrt((further**2).mean())) if further.size else None,
        epochs=epochs,
    )


def _estimator(run: ArmRun, data: ArmProblem) -> PointEstimator:
    """Return the method of an arm, not yet fitted."""
    estimator = make_estimator(run.arm.method)
    known = estimator.get_params()
    if run.arm.method == _NETWORK:
        estimator.set_params(
            hidden=run.arm.hidden, goal=run.arm.goal, max_epochs=run.arm.max_epochs, random_state=run.seed
        )
    if "image_sizes" in known:
        estimator.set_params(image_sizes=data.image_sizes)
    return estimator


def _exact_cameras(data: ArmProblem, arm: Arm) -> Vectors3:
    """Return the most likely points for exact cameras; on a plane its height is known, too.

    Known z shifts x and y by their covariance with z (the conditional mean of a normal distribution).

    Raises
    ------
    InputError
        The exact cameras are not known, or there is no noise.
    """
    if not data.cameras or not (data.sigma_px > 0).all():
        raise InputError(f"An oracle needs known cameras and noise, which data '{arm.data}' do not have.")
    n, pair = len(data.problem.X_test), len(data.cameras)
    q = data.problem.X_test.reshape(n, pair, 2)
    covariance = np.tile(np.stack([np.diag(s**2) for s in data.sigma_px.reshape(pair, 2)]), (n, 1, 1, 1))
    found = triangulate(data.cameras, q, covariance)
    if arm.data is not ArmData.PLANE:
        return found.point
    C, beyond = found.covariance, found.point[:, 2] - data.problem.Y_test[:, 2]
    known: Vectors3 = found.point - C[:, :, 2] / C[:, 2, 2, None] * beyond[:, None]
    return known
