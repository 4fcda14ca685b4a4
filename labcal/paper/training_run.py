"""One case of the reproduction: a solver is trained on one reading of one row from one seed, and tested."""

import time
from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.estimators.estimator import PointEstimator
from labcal.estimators.registry import make_estimator
from labcal.evaluate.statistics import error_statistics
from labcal.optim.stopping import StopReason
from labcal.paper.problem import Problem
from labcal.paper.rows import PaperRow, Solver
from labcal.paper.simulated import NoiseReading, simulate


@dataclass(frozen=True)
class TrainingRun:
    """The definition of one training run."""

    row: PaperRow
    method: str
    noise: NoiseReading
    variant: str
    """Name of one of several problems from the same pictures; empty if there is one."""
    problem: Problem | None
    """The data of a row from pictures; None where they are simulated from the seed."""
    seed: int
    max_epochs: int

    @property
    def reading(self) -> str:
        """Description of the reading."""
        noise = "" if self.noise is NoiseReading.NONE else f"noise {self.noise}"
        return ", ".join(part for part in (self.method, noise, self.variant) if part)

    @property
    def key(self) -> str:
        """The name of the result file."""
        name = "-".join((self.row.exp, self.method, self.noise.name.lower(), self.variant, str(self.seed)))
        return "".join(letter if letter.isalnum() else "-" for letter in name)


class TrainingOutcome(BaseModel):
    """The result on test points."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    mean_signed_mm: float
    """Mean error over all points and all three coordinates."""
    mean_coordinate_mm: float
    """Mean of the true coordinates."""
    mae_mm: float
    rmse_mm: float
    p95_mm: float
    max_mm: float
    further_rmse: tuple[float, ...]
    """RMS error of the outputs after X, Y and Z, mm."""
    epochs: int | None
    goal_reached: bool | None
    seconds: float


def run_training(case: TrainingRun) -> TrainingOutcome:
    """Train and test one case."""
    problem = case.problem or simulate(case.row, case.noise, case.seed)
    estimator = _estimator(case)
    began = time.perf_counter()
    estimator.fit(problem.X, problem.Y)
    seconds = time.perf_counter() - began
    predicted = estimator.predict(problem.X_test)
    figures = error_statistics(
        np.ascontiguousarray(predicted[:, :3]), np.ascontiguousarray(problem.Y_test[:, :3])
    )
    further = predicted[:, 3:] - problem.Y_test[:, 3:]
    is_network = case.row.solver is Solver.NETWORK
    return TrainingOutcome(
        mean_signed_mm=float(np.mean(figures.mean_signed_mm)),
        mean_coordinate_mm=float(problem.Y_test[:, :3].mean()),
        mae_mm=figures.mae_mm,
        rmse_mm=figures.rmse_mm,
        p95_mm=figures.p95_mm,
        max_mm=figures.max_mm,
        further_rmse=tuple(np.sqrt((further**2).mean(axis=0)).tolist()),
        epochs=estimator.n_iter_ if is_network else None,
        goal_reached=estimator.stop_reason_ == StopReason.GOAL if is_network else None,
        seconds=seconds,
    )


def _estimator(case: TrainingRun) -> PointEstimator:
    """Return the solver of the row, not yet fitted."""
    estimator = make_estimator(case.method)
    if case.row.solver is Solver.NETWORK:
        estimator.set_params(
            hidden=case.row.hidden,
            goal=case.row.goal,
            max_epochs=case.max_epochs,
            random_state=case.seed,
        )
    return estimator
